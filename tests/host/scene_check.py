"""scene_check.py: opens a scene of 3D Slicer and each file that it names, without Slicer.
SPDX-License-Identifier: MIT

usage: scene_check.py xml SCENE                     well-formed, identifiers unique, references lead to nodes, files there
       scene_check.py list SCENE                    "ELEMENT NAME FILE" of each node with a file
       scene_check.py same MM A B...                surfaces as VTK reads them: B... have the corners of A within MM
       scene_check.py arrays FILE.vtk FILE.ply      point data of the one, properties of the other (--vertex-errors)
       scene_check.py field FIELD.nrrd [FROM TO MM]...   the inverse of the field moves points label,x,y,z as carry does
Only the last three need VTK. Ends with 1 and says why where something is wrong.
"""
import csv
import os
import sys
import urllib.parse
import xml.etree.ElementTree as tree


def fail(text):
    print(text)
    sys.exit(1)


def file_of(scene, node):
    return os.path.join(os.path.dirname(scene), urllib.parse.unquote(node.get("fileName"), errors="surrogateescape"))


def check_xml(scene):
    root = tree.parse(scene).getroot()
    if root.tag != "MRML" or not root.get("version", "").startswith("Slicer 5"):
        fail("no MRML of a version that believes coordinateSystem")
    ids = [node.get("id") for node in root]
    if None in ids or len(set(ids)) != len(ids):
        fail("identifiers are not unique")
    for node in root:
        for key, value in node.items():
            if key.endswith("NodeRef") and value not in ids:
                fail(f"{node.get('id')}: {key} leads to no node: {value}")
        if node.get("fileName") is not None and os.path.isabs(node.get("fileName")):
            fail(f"{node.get('id')}: an absolute name: {node.get('fileName')}")
        if node.get("fileName") is not None and not os.path.isfile(file_of(scene, node)):
            fail(f"{node.get('id')}: no such file: {node.get('fileName')!r}")
        if node.tag == "ModelStorage" and node.get("coordinateSystem") != "LPS":
            fail(f"{node.get('id')}: not LPS")
        if node.tag == "ModelDisplay" and node.get("visibility2D") != "true":
            fail(f"{node.get('id')}: not shown in slices")


def nodes(scene):
    root = tree.parse(scene).getroot()
    by_id = {node.get("id"): node for node in root}
    for node in root:
        if node.get("storageNodeRef") is not None:
            moved = " moved" if node.get("transformNodeRef") is not None else ""
            yield node.tag + moved, node.get("name"), file_of(scene, by_id[node.get("storageNodeRef")])


def surface(path):
    from vtkmodules.vtkIOGeometry import vtkOBJReader, vtkSTLReader
    from vtkmodules.vtkIOLegacy import vtkPolyDataReader
    from vtkmodules.vtkIOPLY import vtkPLYReader
    reader = {".ply": vtkPLYReader, ".vtk": vtkPolyDataReader, ".stl": vtkSTLReader, ".obj": vtkOBJReader}[path[-4:]]()
    reader.SetFileName(path)
    if path.endswith(".vtk"):
        reader.ReadAllScalarsOn()
        reader.ReadAllVectorsOn()
    reader.Update()
    data = reader.GetOutput()
    if data.GetNumberOfPoints() == 0:
        fail(f"{path}: VTK reads no points")
    return data


def corners(data):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    points = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
    return points[vtk_to_numpy(data.GetPolys().GetConnectivityArray())]


def check_same(a, b, most):
    import numpy
    x, y = corners(surface(a)), corners(surface(b))
    if x.shape != y.shape or len(x) == 0:
        fail(f"{len(x)} and {len(y)} corners of triangles")
    worst = numpy.abs(x - y).max()
    print("worst", worst)
    if not worst <= most:
        fail(f"{a} and {b} are {worst} mm apart")


def ply_values(path):
    import numpy
    with open(path, "rb") as file:
        head, body = file.read().split(b"end_header\n", 1)
    words = [line.split() for line in head.decode().splitlines()]
    n = int(next(w[2] for w in words if w[:2] == ["element", "vertex"]))
    kinds = {"float": "<f4", "uchar": "u1"}
    return numpy.frombuffer(body, [(w[2], kinds[w[1]]) for w in words if w[0] == "property" and w[1] in kinds], n)


def check_arrays(vtk, ply):
    import numpy
    from vtkmodules.util.numpy_support import vtk_to_numpy
    data, values = surface(vtk).GetPointData(), ply_values(ply)
    for name in ("seen", "expected_error"):
        if data.GetArray(name) is None or not numpy.array_equal(vtk_to_numpy(data.GetArray(name)), values[name]):
            fail(f"{name} differs")
    if data.GetArray("displacement") is None or data.GetArray("displacement").GetNumberOfComponents() != 3:
        fail("no displacement")
    print("displacement", numpy.abs(vtk_to_numpy(data.GetArray("displacement"))).max())


def grid_of(path):
    """A field in NRRD as an image of VTK: along the axes, vectors in LPS."""
    import numpy
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData
    with open(path, "rb") as file:
        head, body = file.read().split(b"\n\n", 1)
    key = dict(line.split(": ", 1) for line in head.decode().splitlines() if ": " in line)
    if key["space"] != "left-posterior-superior" or key["kinds"] != "vector domain domain domain":
        fail("not vectors in LPS")
    size = [int(n) for n in key["sizes"].split()[1:]]
    steps = [[float(x) for x in v.strip("()").split(",")] for v in key["space directions"].split()[1:]]
    grid = vtkImageData()
    grid.SetDimensions(size)
    grid.SetSpacing([steps[k][k] for k in range(3)])
    grid.SetOrigin([float(x) for x in key["space origin"].strip("()").split(",")])
    values = numpy.frombuffer(body, "<f4").reshape(-1, 3)
    if len(values) != size[0] * size[1] * size[2]:
        fail("another number of vectors than its sizes say")
    grid.GetPointData().SetScalars(numpy_to_vtk(values.copy(), deep=1))
    return grid


def points(path):
    with open(path, encoding="utf-8", newline="") as file:
        return [[float(row[k]) for k in "xyz"] for row in csv.DictReader(file)]


def check_field(field, sets):
    from vtkmodules.vtkFiltersHybrid import vtkGridTransform
    transform = vtkGridTransform()
    transform.SetDisplacementGridData(grid_of(field))
    transform.SetInterpolationModeToLinear()
    transform.SetInverseTolerance(1e-4)
    transform.SetInverseIterations(2000)
    inverse = transform.GetInverse()
    for start, end, most in sets:
        miss = [sum((a - b) ** 2 for a, b in zip(inverse.TransformPoint(p), q)) ** 0.5
                for p, q in zip(points(start), points(end))]
        print("mean", sum(miss) / len(miss), "worst", max(miss))
        if not max(miss) <= float(most):
            fail(f"{start} to {end}: {max(miss)} mm")


def main():
    what, arguments = sys.argv[1], sys.argv[2:]
    if what == "xml":
        check_xml(arguments[0])
    elif what == "list":
        for line in nodes(arguments[0]):
            print(*line)
    elif what == "same":
        for other in arguments[2:]:
            check_same(arguments[1], other, float(arguments[0]))
    elif what == "arrays":
        check_arrays(*arguments)
    else:
        check_field(arguments[0], list(zip(arguments[1::3], arguments[2::3], arguments[3::3])))


main()
