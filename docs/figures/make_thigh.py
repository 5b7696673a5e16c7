#!/usr/bin/env python3
# make_thigh: draws docs/figures/thigh.svg from what `make demo` left behind. Needs the standard library only.
# SPDX-License-Identifier: MIT
# usage: python3 docs/figures/make_thigh.py [BUILD]      (default: build; run `make demo` first)
#
# A slice of the patient's image with the outlines of the 24 structures: where the landmarks put them, and where the
# registration did.
import base64
import os
import struct
import subprocess
import sys
import zlib

from ply_reader import read_ply

BUILD = sys.argv[1] if len(sys.argv) > 1 else "build"
DEMO = os.path.join(BUILD, "demo")
HERE = os.path.dirname(os.path.abspath(__file__))
SLICES = (0.44,)  # of the height
BONES = ("femur", "hip_bone", "patella")


def read_mha(path):
    with open(path, "rb") as file:
        data = file.read()
    end = data.index(b"ElementDataFile = LOCAL\n") + len(b"ElementDataFile = LOCAL\n")
    head = dict(line.split(" = ", 1) for line in data[:end].decode("ascii").strip().split("\n"))
    size = [int(v) for v in head["DimSize"].split()]
    origin = [float(v) for v in head["Offset"].split()]
    spacing = [float(v) for v in head["ElementSpacing"].split()]
    return data[end:], size, origin, spacing


def png(voxels, width, height):
    """An 8-bit grey PNG, as base64."""
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    rows = b"".join(b"\0" + voxels[y * width:(y + 1) * width] for y in range(height))
    data = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
    data += chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")
    return base64.b64encode(data).decode("ascii")


def outline(vertices, faces, z):
    """The pieces of the surface's cut with the plane at z: pairs of points."""
    pieces = []
    for face in faces:
        points = []
        for a, b in ((0, 1), (1, 2), (2, 0)):
            p, q = vertices[face[a]], vertices[face[b]]
            if (p[2] < z) != (q[2] < z):
                t = (z - p[2]) / (q[2] - p[2])
                points.append((p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])))
        if len(points) == 2:
            pieces.append(points)
    return pieces


def path_of(directory, z, origin, bones):
    d = []
    for name in sorted(os.listdir(directory)):
        if name.endswith(".ply") and (name[:-4] in BONES) == bones:
            vertices, faces = read_ply(os.path.join(directory, name))
            for (a, b) in outline(vertices, faces, z):
                d.append("M%.1f %.1fL%.1f %.1f" % (a[0] - origin[0], a[1] - origin[1], b[0] - origin[0], b[1] - origin[1]))
    return "".join(d)


def start_of():
    """The structures where the landmarks put them: a registration without forces."""
    out = os.path.join(DEMO, "start")
    files = [os.path.join(DEMO, "model", f) for f in sorted(os.listdir(os.path.join(DEMO, "model")))]
    subprocess.run([os.path.join(BUILD, "smr"), "register", "--quiet", "--model"] + files + [
        "--reference", os.path.join(DEMO, "mri_reference.mha"), "--target", os.path.join(DEMO, "mri_patient.mha"),
        "--landmarks", os.path.join(DEMO, "landmarks_reference.mrk.json"), os.path.join(DEMO, "landmarks_patient.mrk.json"),
        "--search", "0,0", "--gradient", "0,0", "--iterations", "1", "--iterations-last", "1", "-o", out], check=True)
    return out


def main():
    voxels, size, origin, spacing = read_mha(os.path.join(DEMO, "mri_patient.mha"))
    start, result = start_of(), os.path.join(DEMO, "result")
    w, h, gap = size[0], size[1], 8
    parts = []
    for row, share in enumerate(SLICES):
        k = int(share * size[2])
        z = origin[2] + k * spacing[2]
        picture = png(voxels[k * w * h:(k + 1) * w * h], w, h)
        for column, directory in enumerate((start, result)):
            lines = "".join('<path d="%s" fill="none" stroke="%s" stroke-width="1"/>' %
                            (path_of(directory, z, origin, bones), colour)
                            for bones, colour in ((False, "#ffb000"), (True, "#40c8ff")))
            parts.append('<g transform="translate(%d %d)"><use href="#slice%d"/>%s</g>' %
                         (column * (w + gap), 18 + row * (h + gap), row, lines))
        parts.insert(0, '<defs><image id="slice%d" width="%d" height="%d" href="data:image/png;base64,%s"/></defs>' %
                     (row, w, h, picture))
    for column, text in enumerate(("15 landmarks", "registered")):
        parts.append('<text x="%d" y="13" font-family="sans-serif" font-size="12" fill="#666">%s</text>' %
                     (column * (w + gap) + 4, text))
    total = (2 * w + gap, 18 + len(SLICES) * (h + gap))
    svg = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 %d %d" width="%d">%s</svg>\n' % (*total, 2 * total[0], "".join(parts))
    with open(os.path.join(HERE, "thigh.svg"), "w", encoding="ascii") as file:
        file.write(svg)


main()
