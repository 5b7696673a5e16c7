"""SmrRegister.py: scripted module of 3D Slicer: runs `smr register` on nodes, loads its results and says its verdict.

Slicer's part alone: choosing nodes, writing and loading them. What needs no Slicer is SmrRegisterLib/smr_run.py.

SPDX-License-Identifier: MIT
"""
import os

import ctk
import qt
import slicer
from slicer.ScriptedLoadableModule import (ScriptedLoadableModule, ScriptedLoadableModuleLogic,
                                           ScriptedLoadableModuleWidget)

from SmrRegisterLib import smr_run

COLORS = {"good": "#2e7d32", "look": "#b26a00", "failed": "#b71c1c"}


class SmrRegister(ScriptedLoadableModule):
    def __init__(self, parent):
        ScriptedLoadableModule.__init__(self, parent)
        parent.title = "Shape matching (smr), with verdict"
        parent.categories = ["Registration"]
        parent.dependencies = []
        parent.contributors = []
        parent.helpText = "Deforms a model onto a surface or into an image, and says whether the result can be trusted."
        parent.acknowledgementText = "Gilles and Pai, Fast Musculoskeletal Registration Based on Shape Matching, MICCAI 2008."


class SmrRegisterWidget(ScriptedLoadableModuleWidget):
    def setup(self):
        ScriptedLoadableModuleWidget.setup(self)
        self.cancelled = False
        form = qt.QFormLayout()
        self.layout.addLayout(form)
        surface, image, points = "vtkMRMLModelNode", "vtkMRMLScalarVolumeNode", "vtkMRMLMarkupsFiducialNode"
        self.nodes = {}
        for key, label, kinds, needed in (("model", "Model", [surface], True), ("target", "Target", [surface, image], True),
                                          ("reference", "Image of the model", [image], False),
                                          ("model_points", "Landmarks of the model", [points], False),
                                          ("target_points", "Landmarks of the target", [points], False)):
            self.nodes[key] = self.selector(kinds, needed)
            form.addRow(label, self.nodes[key])
        self.align = qt.QComboBox()
        self.align.addItems(list(smr_run.ALIGN))
        form.addRow("Start pose", self.align)
        self.options = qt.QLineEdit()
        self.options.toolTip = "More options of smr register, as on a command line"
        form.addRow("Options", self.options)
        self.folder = ctk.ctkDirectoryButton()
        self.folder.directory = slicer.app.temporaryPath
        form.addRow("Folder of results", self.folder)
        self.colors = qt.QCheckBox("Colour by the expected error")
        form.addRow("", self.colors)
        self.start = qt.QPushButton("Register")
        self.start.connect("clicked()", self.on_start)
        self.stop = qt.QPushButton("Cancel")
        self.stop.enabled = False
        self.stop.connect("clicked()", self.on_stop)
        self.verdict = qt.QLabel()
        self.verdict.wordWrap = True
        for widget in (self.start, self.stop, self.verdict):
            self.layout.addWidget(widget)
        self.layout.addStretch(1)

    @staticmethod
    def selector(kinds, needed):
        box = slicer.qMRMLNodeComboBox()
        box.nodeTypes = kinds
        box.addEnabled = box.removeEnabled = False
        box.noneEnabled = not needed
        box.setMRMLScene(slicer.mrmlScene)
        return box

    def wait(self):
        slicer.app.processEvents()
        return not self.cancelled

    def on_stop(self):
        self.cancelled = True

    def on_start(self):
        self.cancelled = False
        self.start.enabled, self.stop.enabled = False, True
        self.say("Registering ...", "black")
        try:
            nodes = {key: box.currentNode() for key, box in self.nodes.items()}
            verdict = SmrRegisterLogic().register(nodes, self.align.currentText, self.options.text, self.folder.directory,
                                                  self.wait, self.colors.checked)
            self.say(verdict.sentence(), COLORS[verdict.level])
        except (smr_run.SmrError, OSError, RuntimeError, ValueError) as error:
            self.say(str(error), COLORS["failed"])
        finally:
            self.start.enabled, self.stop.enabled = True, False

    def say(self, text, color):
        self.verdict.text = text
        self.verdict.setStyleSheet(f"color: {color}; font-weight: bold")


class SmrRegisterLogic(ScriptedLoadableModuleLogic):
    def register(self, nodes, align, options, folder, wait=lambda: True, colors=False):
        """Registers and loads the results into the scene. nodes: by the names of smr_run.Inputs, None where none is chosen."""
        work = smr_run.new_folder(folder)
        paths = {key: self.write(node, work) for key, node in nodes.items() if node is not None}
        inputs = smr_run.Inputs(**{"model": "", **paths}, align=align, options=smr_run.split_options(options))
        out = os.path.join(work, "results")
        verdict = smr_run.run(inputs, out, wait, slicer.util.startupEnvironment())
        for item in smr_run.items(out):
            self.load(item, colors)
        return verdict

    @staticmethod
    def write(node, work):
        """Writes the node as it lies in the world, moved by the transforms above it. Returns the path."""
        kind = "model" if node.IsA("vtkMRMLModelNode") else "volume" if node.IsA("vtkMRMLVolumeNode") else "points"
        path = smr_run.file_name(node.GetName(), kind, work)
        if not slicer.util.exportNode(node, path, {}, True):
            raise smr_run.SmrError(f"{node.GetName()}: Slicer does not write {path}")
        return path

    @staticmethod
    def load(item, colors):
        if item.kind == "transform":
            node = slicer.util.loadTransform(item.path)
        elif item.kind == "points":
            node = slicer.util.loadMarkups(item.path)
        else:
            node = slicer.util.loadModel(item.path)
            display = node.GetDisplayNode()
            display.SetColor(*item.color)
            display.SetOpacity(item.opacity)
            display.SetVisibility2D(True)
            if item.scalars:
                display.SetActiveScalarName(item.scalars)
                display.SetAndObserveColorNodeID(item.color_node)
                display.SetScalarRangeFlag(slicer.vtkMRMLDisplayNode.UseManualScalarRange)
                display.SetScalarRange(*item.scalar_range)
                display.SetScalarVisibility(colors)
        node.SetName(item.name)
