"""scene_render.py: draws a scene of 3D Slicer off-screen with VTK, as Slicer's four views do, and checks what it shows.
SPDX-License-Identifier: MIT

usage: scene_render.py SCENE PICTURE.png      needs VTK and numpy, a display (xvfb-run), volumes along the axes
Views: all models; axial, coronal and sagittal slices through the first volume with the models' intersections. In the
coronal one the left half shows the second volume as its transform carries it, where the scene has one. Prints "ok" or
"not ok" for: each model that is shown has its colour in the picture, alone and in a slice that cuts it, and the
transform makes the second volume more like the first. Ends with 1 when something is wrong.
"""
import os
import sys
import urllib.parse
import xml.etree.ElementTree as tree

import numpy
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPlane
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkFiltersCore import vtkCutter, vtkPolyDataNormals
from vtkmodules.vtkFiltersHybrid import vtkGridTransform
from vtkmodules.vtkImagingCore import vtkImageReslice
from vtkmodules.vtkIOGeometry import vtkOBJReader, vtkSTLReader
from vtkmodules.vtkIOImage import vtkMetaImageReader, vtkPNGWriter
from vtkmodules.vtkIOLegacy import vtkPolyDataReader
from vtkmodules.vtkIOPLY import vtkPLYReader
from vtkmodules.vtkRenderingCore import (vtkActor, vtkImageSlice, vtkImageSliceMapper, vtkPolyDataMapper, vtkRenderer,
                                         vtkRenderWindow, vtkWindowToImageFilter)
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 (what draws)

SIDE = 700
failed = 0


def check(good, text):
    global failed
    failed += not good
    print("ok" if good else "not ok", text)


def read_scene(path):
    """Models, volumes and the field of a scene: [(name, file, color, opacity, shown)], [(name, file, moved)], file."""
    root = tree.parse(path).getroot()
    by_id = {node.get("id"): node for node in root}

    def file_of(node):
        name = by_id[node.get("storageNodeRef")].get("fileName")
        return os.path.join(os.path.dirname(path), urllib.parse.unquote(name, errors="surrogateescape"))

    models, volumes, field = [], [], None
    for node in root:
        if node.tag == "Model":
            display = by_id[node.get("displayNodeRef").split()[0]]
            color = tuple(float(c) for c in display.get("color").split())
            models.append((node.get("name"), file_of(node), color, float(display.get("opacity")),
                           display.get("visibility") == "true"))
        elif node.tag == "Volume":
            volumes.append((node.get("name"), file_of(node), node.get("transformNodeRef") is not None))
        elif node.tag == "GridTransform":
            field = file_of(node)
    return models, volumes, field


def surface(path):
    reader = {".ply": vtkPLYReader, ".vtk": vtkPolyDataReader, ".stl": vtkSTLReader, ".obj": vtkOBJReader}[path[-4:]]()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def image(path):
    reader = vtkMetaImageReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def transform_of(path):
    """The inverse field, as Slicer uses it: from the patient's space to the model's."""
    with open(path, "rb") as file:
        head, body = file.read().split(b"\n\n", 1)
    key = dict(line.split(": ", 1) for line in head.decode().splitlines() if ": " in line)
    steps = [[float(x) for x in v.strip("()").split(",")] for v in key["space directions"].split()[1:]]
    grid = vtkImageData()
    grid.SetDimensions([int(n) for n in key["sizes"].split()[1:]])
    grid.SetSpacing([steps[k][k] for k in range(3)])
    grid.SetOrigin([float(x) for x in key["space origin"].strip("()").split(",")])
    grid.GetPointData().SetScalars(numpy_to_vtk(numpy.frombuffer(body, "<f4").reshape(-1, 3).copy(), deep=1))
    transform = vtkGridTransform()
    transform.SetDisplacementGridData(grid)
    transform.SetInterpolationModeToLinear()
    return transform


def resliced(moving, like, transform):
    """A volume on another one's grid; without a transform where it lies."""
    reslice = vtkImageReslice()
    reslice.SetInputData(moving)
    reslice.SetInformationInput(like)
    if transform is not None:
        reslice.SetResliceTransform(transform)
    reslice.SetInterpolationModeToLinear()
    reslice.SetBackgroundLevel(0)
    reslice.Update()
    return reslice.GetOutput()


def voxels(data):
    return vtk_to_numpy(data.GetPointData().GetScalars()).astype(float)


def likeness(a, b, where):
    return numpy.corrcoef(voxels(a)[where], voxels(b)[where])[0, 1]


def inside_bounds(data, surfaces):
    """Voxels within the box of all surfaces."""
    bounds = numpy.array([s.GetBounds() for s in surfaces])
    x, y, z = [data.GetOrigin()[k] + data.GetSpacing()[k] * numpy.arange(data.GetDimensions()[k]) for k in range(3)]
    keep = [(v >= bounds[:, 2 * k].min()) & (v <= bounds[:, 2 * k + 1].max()) for k, v in enumerate((x, y, z))]
    return (keep[2][:, None, None] & keep[1][None, :, None] & keep[0][None, None, :]).ravel()


def actor_of(data, color, opacity, lit):
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)
    mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(color)
    actor.GetProperty().SetOpacity(opacity)
    actor.GetProperty().SetLighting(lit)
    actor.GetProperty().SetLineWidth(2)
    return actor


def look(renderer, centre, half, back, up):
    """An orthographic camera on the side `back`. In LPS: from the front, the patient's right is on the left."""
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(centre)
    camera.SetPosition([c + 2000 * b for c, b in zip(centre, back)])
    camera.SetViewUp(up)
    camera.SetParallelScale(half)
    renderer.ResetCameraClippingRange()


def view_3d(models):
    renderer = vtkRenderer()
    renderer.SetBackground(0.75, 0.77, 0.87)
    for _, data, color, opacity in models:
        normals = vtkPolyDataNormals()
        normals.SetInputData(data)
        normals.SplittingOff()
        normals.Update()
        renderer.AddActor(actor_of(normals.GetOutput(), color, opacity, True))
    return renderer


def cut(data, axis, at):
    plane = vtkPlane()
    plane.SetOrigin(at)
    plane.SetNormal([float(k == axis) for k in range(3)])
    cutter = vtkCutter()
    cutter.SetInputData(data)
    cutter.SetCutFunction(plane)
    cutter.Update()
    return cutter.GetOutput()


def view_slice(pictures, models, axis, at, toward):
    renderer = vtkRenderer()
    for data, window in pictures:
        mapper = vtkImageSliceMapper()
        mapper.SetInputData(data)
        mapper.SetOrientation(axis)
        mapper.SetSliceNumber(round((at[axis] - data.GetOrigin()[axis]) / data.GetSpacing()[axis]))
        one = vtkImageSlice()
        one.SetMapper(mapper)
        one.GetProperty().SetColorWindow(window[1] - window[0])
        one.GetProperty().SetColorLevel(0.5 * (window[0] + window[1]))
        renderer.AddViewProp(one)
    for _, data, color, _ in models:
        line = actor_of(cut(data, axis, at), color, 1, False)
        line.SetPosition([5.0 * t for t in toward])  # before the picture
        renderer.AddActor(line)
    return renderer


windows = {}  # one of each size: displays have few connections


def draw(renderers, size):
    window = windows.get(size)
    if window is None:
        window = windows[size] = vtkRenderWindow()
        window.SetOffScreenRendering(1)
        window.SetSize(*size)
        window.SetMultiSamples(0)
    for renderer in renderers:
        window.AddRenderer(renderer)
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    out = vtkImageData()
    out.DeepCopy(grab.GetOutput())
    for renderer in renderers:
        window.RemoveRenderer(renderer)
    return out


def has_color(picture, color):
    rgb = vtk_to_numpy(picture.GetPointData().GetScalars())[:, :3].astype(int)
    return int((numpy.abs(rgb - numpy.round(255 * numpy.array(color)).astype(int)).max(axis=1) <= 2).sum())


def left_half(data):
    """What lies on the picture's left of the middle, seen from the front."""
    out = vtkImageData()
    out.DeepCopy(data)
    size = data.GetDimensions()
    scalars = vtk_to_numpy(out.GetPointData().GetScalars()).reshape(size[::-1])
    return out, scalars, size[0] // 2


def main():
    scene, target = sys.argv[1:]
    listed, volumes, field = read_scene(scene)
    models = [(name, surface(file), color, opacity) for name, file, color, opacity, shown in listed if shown]
    check(len(models) > 0 and all(m[1].GetNumberOfPolys() > 0 for m in models), f"{len(models)} models are shown")
    box = numpy.array([m[1].GetBounds() for m in models])
    low, high = box[:, ::2].min(axis=0), box[:, 1::2].max(axis=0)
    centre, half = list(0.5 * (low + high)), 0.55 * float((high - low).max())
    pictures = []
    if volumes:
        first = image(volumes[0][1])
        window = numpy.percentile(voxels(first), [2, 99])
        pictures = [(first, window)]
    if len(volumes) > 1 and volumes[1][2]:
        second = image(volumes[1][1])
        carried = resliced(second, first, transform_of(field))
        where = inside_bounds(first, [m[1] for m in models])
        before, after = likeness(first, resliced(second, first, None), where), likeness(first, carried, where)
        check(after > before + 0.05, f"the transform makes '{volumes[1][0]}' like '{volumes[0][0]}': {before:.3f} to {after:.3f}")
        mixed, scalars, middle = left_half(first)
        scalars[:, :, :middle] = vtk_to_numpy(carried.GetPointData().GetScalars()).reshape(scalars.shape)[:, :, :middle]
        coronal = [(mixed, window)]
    else:
        coronal = pictures
    # From below (the patient's feet), from the front, from the patient's left, as radiologists look.
    sides = [(2, (0, 0, -1), (0, -1, 0), pictures), (1, (0, -1, 0), (0, 0, 1), coronal), (0, (1, 0, 0), (0, 0, 1), pictures)]
    views = [(view_3d(models), (0, -1, 0), (0, 0, 1))]
    views += [(view_slice(p, models, axis, centre, back), back, up) for axis, back, up, p in sides]
    for k, (renderer, back, up) in enumerate(views):
        x, y = 0.5 * (k % 2), 0.5 * (1 - k // 2)
        renderer.SetViewport(x, y, x + 0.5, y + 0.5)
        look(renderer, centre, half if k != 1 else 0.6 * float((high - low)[:2].max()), back, up)
    whole = draw([v[0] for v in views], (2 * SIDE, 2 * SIDE))
    writer = vtkPNGWriter()
    writer.SetFileName(target)
    writer.SetInputData(whole)
    writer.Write()
    for name, data, color, _ in models:
        alone, middle = vtkRenderer(), data.GetCenter()
        alone.AddActor(actor_of(data, color, 1, False))
        look(alone, middle, 0.55 * data.GetLength(), (0, -1, 0), (0, 0, 1))
        line = view_slice(pictures, [(name, data, color, 1)], 2, middle, (0, 0, -1))
        look(line, middle, 0.55 * data.GetLength(), (0, 0, -1), (0, -1, 0))
        there, across = has_color(draw([alone], (200, 200)), color), has_color(draw([line], (200, 200)), color)
        check(there > 200 and (across > 20 or cut(data, 2, middle).GetNumberOfCells() == 0),
              f"{name} is seen in its colour: {there} pixels, {across} in a slice")
    print(f"{target}: {len(models)} models, {len(volumes)} volumes, {failed} wrong")
    return 1 if failed else 0


sys.exit(main())
