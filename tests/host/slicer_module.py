"""slicer_module.py: the scripted module of port/slicer without Slicer.
SPDX-License-Identifier: MIT

usage: SMR=... slicer_module.py logic MODEL TARGET DIR     smr_run.py: runs, refusals, verdict, what is loaded
       SMR=... slicer_module.py window MODEL TARGET DIR    SmrRegister.py: imported, set up and started with stand-ins for Slicer
Prints "ok NAME" or "not ok NAME".
"""
import os
import shutil
import sys
import types
from unittest import mock

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "port", "slicer"))
from SmrRegisterLib import smr_run  # noqa: E402


def tell(name, good):
    print(("ok " if good else "not ok ") + name, flush=True)


def refused(name, words, call):
    try:
        call()
        tell(name + ": accepted", False)
    except smr_run.SmrError as error:
        tell(f"{name} ({error})", words in str(error))


def logic(model, target, folder):
    inputs = smr_run.Inputs(model=model, target=target)
    out = os.path.join(folder, "out & <1>")
    verdict = smr_run.run(inputs, out)
    tell("a good result", verdict.level == "good" and verdict.probability > 0.8 and verdict.reasons == [])
    tell(f"its sentence: {verdict.sentence()}", verdict.sentence().startswith("Good (probability 0.") and " mm)" in verdict.sentence())
    found = smr_run.items(out)
    tell("results alone are loaded", [item.kind for item in found] == ["transform", "model"])
    tell("from their files", all(os.path.isfile(item.path) for item in found))
    tell("with colours", found[1].scalars == "expected_error" and found[1].scalar_range == (0, 3) and len(found[1].color) == 3)
    waits = []
    refused("a run that is ended", "cancelled", lambda: smr_run.run(inputs, os.path.join(folder, "ended"), lambda: waits.append(1)))
    tell("leaves no report", waits == [1] and not os.path.exists(os.path.join(folder, "ended", "report.json")))
    ended = smr_run.run(smr_run.Inputs(model, target, options=["--ticks", "2"]), os.path.join(folder, "two"))
    tell("a run that --ticks ends has its reason", ended.level != "good" and "--ticks" in ended.sentence())
    refused("a missing file", "none.ply", lambda: smr_run.run(smr_run.Inputs(model, "none.ply"), out))
    refused("an unknown option", "--nothing", lambda: smr_run.run(smr_run.Inputs(model, target, options=["--nothing"]), out))
    refused("no target", "choose", lambda: smr_run.arguments(smr_run.Inputs(model), out))
    refused("a volume without the model's", "needs the volume", lambda: smr_run.arguments(smr_run.Inputs(model, "t.nrrd"), out))
    refused("landmarks of one", "of neither", lambda: smr_run.arguments(smr_run.Inputs(model, target, model_points="p"), out))
    refused("no such start", "start pose", lambda: smr_run.arguments(smr_run.Inputs(model, target, align="x"), out))
    words = smr_run.arguments(smr_run.Inputs(model, "t.nrrd", "r.nrrd", "a.mrk.json", "b.mrk.json", "rigid"), out)
    tell("images and landmarks are passed", "--reference r.nrrd --landmarks a.mrk.json b.mrk.json --align rigid" in " ".join(words))
    with mock.patch.dict(os.environ, {"SMR": "", "PATH": ""}):
        refused("no program", "was not found", smr_run.program)
    first = smr_run.file_name("Left/femur é", "model", folder)
    open(first, "w").close()
    tell("names of files", os.path.basename(first) == "Left_femur.ply" and smr_run.file_name("Left femur", "model", folder) != first)


class Node:
    def __init__(self, path):
        self.path = path

    def GetName(self):
        return "bone"

    def IsA(self, kind):
        return kind == "vtkMRMLModelNode"


def window(model, target, folder):
    slicer, qt = mock.MagicMock(), mock.MagicMock()
    parts = types.ModuleType("slicer.ScriptedLoadableModule")
    for name in ("ScriptedLoadableModule", "ScriptedLoadableModuleLogic", "ScriptedLoadableModuleWidget"):
        setattr(parts, name, type(name, (), {"__init__": lambda self, parent=None: None, "setup": lambda self: None}))
    slicer.util.exportNode = lambda node, path, properties, world: shutil.copyfile(node.path, path) is not None and world
    slicer.util.startupEnvironment = lambda: dict(os.environ)
    with mock.patch.dict(sys.modules, {"slicer": slicer, "qt": qt, "ctk": mock.MagicMock(), "slicer.ScriptedLoadableModule": parts}):
        import SmrRegister
        parent = mock.MagicMock()
        SmrRegister.SmrRegister(parent)
        tell("the module has its place", parent.categories == ["Registration"])
        widget = SmrRegister.SmrRegisterWidget()
        widget.layout = mock.MagicMock()
        widget.setup()
        tell("it asks for all inputs", list(widget.nodes) == ["model", "target", "reference", "model_points", "target_points"])
        for key in widget.nodes:
            widget.nodes[key] = mock.MagicMock()
            widget.nodes[key].currentNode.return_value = {"model": Node(model), "target": Node(target)}.get(key)
        widget.align, widget.options, widget.folder, widget.verdict = (mock.MagicMock() for _ in range(4))
        widget.align.currentText, widget.options.text, widget.folder.directory = "none", "", folder
        widget.on_start()
        tell(f"it says the verdict: {widget.verdict.text}", widget.verdict.text.startswith("Good"))
        tell("and loads result and transform", slicer.util.loadModel.call_count == slicer.util.loadTransform.call_count == 1)
        display = slicer.util.loadModel.return_value.GetDisplayNode.return_value
        tell("with colours", display.SetActiveScalarName.call_args == mock.call("expected_error"))
        widget.options.text = "--nothing"
        widget.on_start()
        tell("what smr refuses is said", "--nothing" in widget.verdict.text and slicer.util.loadModel.call_count == 1)


{"logic": logic, "window": window}[sys.argv[1]](*sys.argv[2:])
