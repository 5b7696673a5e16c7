# ply_reader: surfaces for the figures. The standard library only.
# SPDX-License-Identifier: MIT
import struct

SIZES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d",
         "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "float32": "f",
         "float64": "d"}


def read_ply(path):
    """Vertices and triangles of an ASCII or binary little-endian PLY whose vertices start with x y z."""
    with open(path, "rb") as file:
        data = file.read()
    end = data.index(b"end_header") + len(b"end_header\n")
    head = data[:end].decode("ascii").split("\n")
    counts = {w[1]: int(w[2]) for w in (line.split() for line in head) if w[:1] == ["element"]}
    nv, nf = counts["vertex"], counts["face"]
    if "format ascii 1.0" in head:
        lines = data[end:].decode("ascii").split("\n")
        vertices = [tuple(float(v) for v in lines[i].split()[:3]) for i in range(nv)]
        faces = [tuple(int(v) for v in lines[nv + i].split()[1:4]) for i in range(nf)]
        return vertices, faces
    element, row, index_type = None, "<", None
    for words in (line.split() for line in head):
        if words[:1] == ["element"]:
            element = words[1]
        elif words[:2] == ["property", "list"]:
            index_type = "<" + SIZES[words[2]] + "3" + SIZES[words[3]]
        elif words[:1] == ["property"] and element == "vertex":
            row += SIZES[words[1]]
    step, at = struct.calcsize(row), end
    vertices = [struct.unpack_from(row, data, at + i * step)[:3] for i in range(nv)]
    at += nv * step
    step = struct.calcsize(index_type)
    return vertices, [struct.unpack_from(index_type, data, at + i * step)[1:] for i in range(nf)]
