# read_alike.py: positions and values that smr's readers give, against those of nibabel and VTK.
# SPDX-License-Identifier: MIT
# usage: read_alike.py nibabel|vtk VOLUME_TOOL MESH_TOOL SCRATCH      (the helpers of tests/host; scratch exists)
# Prints "ok NAME" or "not ok NAME" for each file; positions may differ by 1e-4 mm. Ends with 77 where a module is missing.
import itertools
import os
import subprocess
import sys

which, volume_tool, mesh_tool, scratch = sys.argv[1:5]
try:
    import numpy as np

    if which == "nibabel":
        import nibabel
    else:
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy
except ImportError:
    sys.exit(77)

TOLERANCE = 1e-4
CORNERS = [(0, 0, 0), (4, 1, 0), (1, 3, 2)]  # with their values these tell all axes apart


def said(*words):
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout


def tell(name, good, detail=""):
    print(("ok " if good else "not ok ") + name + ("" if good else "\n#   " + detail))


def ours(path, index):
    words = [str(i) for i in index]
    place = [float(w) for w in said(volume_tool, "where", path, *words).split()]
    return np.array(place), float(said(volume_tool, "voxel", path, *words))


def compare_volume(name, path, peer):
    worst = 0.0
    detail = ""
    for index in CORNERS:
        try:
            place, value = ours(path, index)
        except subprocess.CalledProcessError as error:
            return tell(name, False, error.stderr)
        their_place, their_value = peer(index)
        off = max(np.abs(place - their_place).max(), abs(value - their_value))
        if off >= worst:
            worst, detail = off, f"{index}: {place} {value}, there {their_place} {their_value}"
    tell(name, worst <= TOLERANCE, detail)


def nifti(path):
    image = nibabel.load(path)
    scale = {"meter": 1e3, "micron": 1e-3}.get(image.header.get_xyzt_units()[0], 1.0)
    data = image.get_fdata()

    def peer(index):
        ras = image.affine @ np.array([*index, 1.0])
        return ras[:3] * np.array([-1, -1, 1]) * scale, data[index]

    return peer


def check_nibabel():
    types = ["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float", "double"]
    for form, kind, order in itertools.product(["s", "q"], types, ["0", "1"]):
        path = os.path.join(scratch, "made.nii")
        said(volume_tool, "nifti", form, kind, "big" if order == "1" else "little", path)
        compare_volume(f"NIfTI {form}form {kind} {'big' if order == '1' else 'little'} endian", path, nifti(path))
    turn = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    data = np.arange(60, dtype=np.int16).reshape(5, 4, 3)
    for flip, forms, unit, packed in itertools.product([1, -1], ["s", "q", "both"], ["mm", "meter", "micron"], ["", ".gz"]):
        scale = {"mm": 1.0, "meter": 1e-3, "micron": 1e3}[unit]
        affine = np.eye(4)
        affine[:3, :3] = turn @ np.diag([flip * 1.5, 2.0, 4.0]) * scale
        affine[:3, 3] = np.array([11.0, -22.0, 33.0]) * scale
        image = nibabel.Nifti1Image(data, affine)
        image.set_sform(affine, code=1 if forms != "q" else 0)
        image.set_qform(affine, code=1 if forms != "s" else 0)
        image.header.set_xyzt_units(unit)
        image.header["scl_slope"], image.header["scl_inter"] = 2.5, -7.0
        path = os.path.join(scratch, "written.nii" + packed)
        nibabel.save(image, path)
        name = f"NIfTI of nibabel, {forms}, {unit}, {'mirrored' if flip < 0 else 'turned'}{packed}"
        compare_volume(name, path, nifti(path))


def metaimage(path):
    reader = vtk.vtkMetaImageReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    origin, spacing = np.array(image.GetOrigin()), np.array(image.GetSpacing())
    x, y, z = image.GetDimensions()
    data = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(z, y, x)
    return lambda index: (origin + spacing * np.array(index), float(data[index[2], index[1], index[0]]))


def check_volumes_by_vtk():
    lines = {
        "spacing": "ElementSpacing = 1.5 2 4",
        "size": "ElementSize = 1.5 2 4",
        "both": "ElementSize = 3 3 3\nElementSpacing = 1.5 2 4",
    }
    for (name, line), order in itertools.product(lines.items(), ["False", "True"]):
        path = os.path.join(scratch, "made.mha")
        values = np.arange(60, dtype=">i2" if order == "True" else "<i2")
        with open(path, "wb") as file:
            file.write(
                f"ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = {order}\n"
                f"Offset = 10 -20 30\n{line}\nDimSize = 5 4 3\nElementType = MET_SHORT\nElementDataFile = LOCAL\n".encode()
            )
            file.write(values.tobytes())
        compare_volume(f"MetaImage with {name}, most significant first {order}", path, metaimage(path))


SPHERE = (23, 17)
READERS = {"ply": "vtkPLYReader", "stl": "vtkSTLReader", "obj": "vtkOBJReader", "vtk": "vtkPolyDataReader"}
WRITERS = {"ply": "vtkPLYWriter", "stl": "vtkSTLWriter", "obj": "vtkOBJWriter", "vtk": "vtkPolyDataWriter"}


def corners_of(polydata):
    """Corners of all triangles, sorted: formats number vertices differently."""
    points = vtk_to_numpy(polydata.GetPoints().GetData()).astype(float)
    triangles = vtk_to_numpy(polydata.GetPolys().GetData()).reshape(-1, 4)[:, 1:]
    corners = points[triangles].reshape(-1, 9)
    return corners[np.lexsort(corners.T[::-1].round(3))]


def read(kind, path):
    reader = getattr(vtk, READERS[kind])()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def check_meshes_by_vtk():
    source = vtk.vtkSphereSource()
    source.SetThetaResolution(SPHERE[0])
    source.SetPhiResolution(SPHERE[1])
    source.SetCenter(12.5, -340.25, 77.125)
    source.SetRadius(43.7)
    source.Update()
    for kind, binary in itertools.product(WRITERS, [True, False]):
        if kind == "obj" and binary:
            continue
        path = os.path.join(scratch, "vtk." + kind)
        writer = getattr(vtk, WRITERS[kind])()
        writer.SetFileName(path)
        writer.SetInputData(source.GetOutput())
        if kind != "obj":
            writer.SetFileTypeToBinary() if binary else writer.SetFileTypeToASCII()
        if kind == "vtk":
            writer.SetFileVersion(42)
        writer.Write()
        wanted = corners_of(read(kind, path))  # text has six digits
        name = f"{kind} of VTK, {'binary' if binary else 'text'}"
        for out, words in {"vtk": ["vtk"], "ply": ["ply"], "stl": ["stl"], "obj": ["obj"]}.items():
            to = os.path.join(scratch, "ours." + out)
            run = subprocess.run([mesh_tool, "convert", path, *words, to], capture_output=True, text=True)
            found = corners_of(read(out, to)) if run.returncode == 0 else None
            good = found is not None and found.shape == wanted.shape and np.abs(found - wanted).max() <= TOLERANCE
            detail = run.stderr or f"{None if found is None else found.shape} {wanted.shape}"
            tell(f"{name}, written as {out}", good, detail)


if which == "nibabel":
    check_nibabel()
else:
    check_volumes_by_vtk()
    check_meshes_by_vtk()
