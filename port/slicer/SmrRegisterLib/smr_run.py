"""smr_run.py: what the scripted module of 3D Slicer does without Slicer: command line, run, verdict, list of results.

The module writes its nodes as files into a folder, calls run() on them, says verdict.sentence() and loads items().
Python 3.9 and its standard library.

SPDX-License-Identifier: MIT
"""
import json
import os
import re
import shlex
import shutil
import subprocess
import tempfile
import time
import urllib.parse
import xml.etree.ElementTree as tree
from dataclasses import dataclass, field
from typing import Callable, Dict, List, Optional, Tuple

ALIGN = ("none", "rigid", "similarity", "parts")  # values of --align
SUFFIXES = {"model": ".ply", "volume": ".nrrd", "points": ".mrk.json"}  # of the files that the module writes


class SmrError(Exception):
    """smr did not run, or refused its input; the text is for the user."""


@dataclass
class Inputs:
    """Files for one run, as the module wrote them: LPS millimetres."""
    model: str                       # the surface to deform
    target: str = ""                 # a surface, or a volume, to register to
    reference: str = ""              # the volume that the model was drawn in; needed with a volume as target
    model_points: str = ""           # landmarks of the model, and their counterparts of the same labels
    target_points: str = ""
    align: str = "none"              # start pose, one of ALIGN
    options: List[str] = field(default_factory=list)  # more options of `smr register`


@dataclass
class Verdict:
    """What report.json says of the result."""
    level: str                       # "good", "look" or "failed"
    probability: float               # that the result is good
    expected_error_mm: Optional[float]
    reasons: List[str]               # sentences, empty for good

    def sentence(self) -> str:
        text = {"good": "Good", "look": "Look at the result", "failed": "Failed"}[self.level]
        text += f" (probability {self.probability:.2f}"
        if self.expected_error_mm is not None:
            text += f", expected error {self.expected_error_mm:.2f} mm"
        return ": ".join([text + ")"] + ["; ".join(self.reasons)] * bool(self.reasons))


@dataclass
class Item:
    """A node to load: kind "model", "transform" or "points"."""
    kind: str
    name: str
    path: str
    color: Tuple[float, ...] = (0.9, 0.8, 0.6)
    opacity: float = 1.0
    scalars: str = ""                # array of the vertices that can be shown by colours, in mm
    scalar_range: Tuple[float, ...] = (0.0, 3.0)
    color_node: str = ""             # identifier of Slicer's colour table


def program() -> str:
    """Path of smr: the variable SMR, the installation that this file lies in, or the PATH."""
    here = os.path.dirname(os.path.realpath(__file__))
    for path in (os.environ.get("SMR", ""), os.path.join(here, "..", "..", "..", "..", "bin", "smr"), shutil.which("smr") or ""):
        if path and os.access(path, os.X_OK):
            return os.path.normpath(path)
    raise SmrError("smr was not found: install it with `make install`, or set the variable SMR to its path")


def new_folder(parent: str) -> str:
    """A folder of this run, in the one that the user chose."""
    os.makedirs(parent, exist_ok=True)
    return tempfile.mkdtemp(prefix="smr-", dir=parent)


def split_options(text: str) -> List[str]:
    """Options as a shell splits them. Raises ValueError for an open quote."""
    return shlex.split(text)


def file_name(name: str, kind: str, folder: str) -> str:
    """A path in the folder for a node of this name and kind; structures of results are named by it."""
    word = re.sub(r"[^A-Za-z0-9_-]+", "_", name).strip("_")[:60] or kind
    path = os.path.join(folder, word + SUFFIXES[kind])
    return path if not os.path.exists(path) else os.path.join(tempfile.mkdtemp(dir=folder), word + SUFFIXES[kind])


def arguments(inputs: Inputs, out: str) -> List[str]:
    """The command line without the program. Raises SmrError for inputs that do not go together."""
    volume = inputs.target.endswith(SUFFIXES["volume"])
    if not inputs.model or not inputs.target:
        raise SmrError("choose a model and a target")
    if volume and not inputs.reference:
        raise SmrError("a volume as target needs the volume that the model was drawn in")
    if bool(inputs.model_points) != bool(inputs.target_points):
        raise SmrError("choose landmarks of both the model and the target, or of neither")
    if inputs.align not in ALIGN:
        raise SmrError(f"no such start pose: {inputs.align}")
    words = ["register", "--model", inputs.model, "--target", inputs.target]
    words += ["--reference", inputs.reference] if volume else []
    words += ["--landmarks", inputs.model_points, inputs.target_points] if inputs.model_points else []
    words += ["--align", inputs.align] if inputs.align != "none" else []
    return words + list(inputs.options) + ["--format", "vtk", "--vertex-errors", "--slicer", os.path.join(out, "scene.mrml"), "-o", out]


def read_verdict(out: str) -> Verdict:
    with open(os.path.join(out, "report.json"), encoding="utf-8") as file:
        report = json.load(file)
    return Verdict(report["verdict"], report["probability"], report["expected_error_mm"], report["reasons"])


def run(inputs: Inputs, out: str, wait: Callable[[], bool] = lambda: True, environment: Optional[Dict[str, str]] = None) -> Verdict:
    """Runs `smr register` into the folder `out`. wait() is called every tenth of a second and ends the run by False.
    Raises SmrError with smr's own line where it refuses its input, or where wait() ended it."""
    words = [program()] + arguments(inputs, out)
    with tempfile.TemporaryFile() as said:
        process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=said, env=environment)
        try:
            while process.poll() is None:
                if not wait():
                    raise SmrError("cancelled")
                time.sleep(0.1)
        finally:
            if process.poll() is None:
                process.terminate()
                process.wait()
        said.seek(0)
        lines = said.read().decode("utf-8", "replace").splitlines()
    if process.returncode not in (0, 1, 3, 4):  # good, failed, look, ended by --ticks: each has a result
        raise SmrError(lines[-1] if lines else f"smr ended with status {process.returncode}")
    return read_verdict(out)


def numbers(text: str) -> Tuple[float, ...]:
    return tuple(float(word) for word in text.split())


def items(out: str) -> List[Item]:
    """What scene.mrml shows of the results: surfaces, the transform, landmarks. What was an input is loaded already."""
    root = tree.parse(os.path.join(out, "scene.mrml")).getroot()
    by_id = {node.get("id"): node for node in root}
    kinds = {"Model": "model", "GridTransform": "transform", "MarkupsFiducial": "points"}
    found = []
    for node in root:
        storage = by_id.get(node.get("storageNodeRef"))
        if node.tag not in kinds or storage is None:
            continue
        path = os.path.normpath(os.path.join(out, urllib.parse.unquote(storage.get("fileName"))))
        if os.path.dirname(path) != os.path.normpath(out):
            continue
        item = Item(kinds[node.tag], node.get("name"), path)
        look = by_id.get(node.get("displayNodeRef"))
        if look is not None and node.tag == "Model":
            item.color, item.opacity = numbers(look.get("color")), float(look.get("opacity"))
            item.scalars, item.color_node = look.get("activeScalarName", ""), look.get("colorNodeID", "")
            item.scalar_range = numbers(look.get("scalarRange", "0 3"))
        found.append(item)
    return found
