#!/usr/bin/env python3
# make_figures: draws docs/figures/demo.svg from what `make demo-bone` left behind. Needs the standard library only.
# SPDX-License-Identifier: MIT
# usage: python3 docs/figures/make_figures.py [BUILD]      (default: build; run `make demo-bone` first)
#
# Two views of the model on the target, before and after, seen from the front with the knee on the left. A triangle's
# colour is the mean distance of its corners from their true places, which the demo's generator knows.
import math
import os
import sys

from ply_reader import read_ply

SCALE = 1.9          # picture units per mm
GRID = 4             # steps in which a picture unit is written down


def project(p):
    """Seen from the front (-y): right is up the bone, up is towards the head of the femur; the third is depth."""
    return p[2] * SCALE, -p[0] * SCALE, p[1] * SCALE


def corners(vertices, face):
    return [project(vertices[i]) for i in face]


def facing(t):
    """Twice the area on the picture; positive when the outer side is seen."""
    return (t[1][0] - t[0][0]) * (t[2][1] - t[0][1]) - (t[1][1] - t[0][1]) * (t[2][0] - t[0][0])


def path_of(triangles):
    parts = []
    for t in triangles:
        x, y = [round(c[0] * GRID) for c in t], [round(c[1] * GRID) for c in t]
        parts.append("M%d %dl%d %d %d %dz" % (x[0], y[0], x[1] - x[0], y[1] - y[0], x[2] - x[1], y[2] - y[1]))
    return "".join(parts).replace(" -", "-")


def visible(vertices, faces, cell=3.0):
    """Faces that look towards us and are nearest where their centre is drawn."""
    depth, front = {}, []
    for k, face in enumerate(faces):
        t = corners(vertices, face)
        if facing(t) * SIGN <= 0:
            continue
        centre = [sum(c[a] for c in t) / 3 for a in range(3)]
        front.append((k, centre))
        for c in t + [centre]:
            key = (int(c[0] // cell), int(c[1] // cell))
            depth[key] = min(depth.get(key, 1e9), c[2])
    keep = []
    for k, c in front:
        key = (int(c[0] // cell), int(c[1] // cell))
        if c[2] <= depth[key] + 14.0:
            keep.append((c[2], k))
    return [k for _, k in sorted(keep, reverse=True)]


RAMP = [(0.0, (38, 110, 158)), (0.15, (58, 160, 160)), (0.45, (226, 190, 92)), (0.75, (222, 120, 70)), (1.0, (176, 42, 60))]
LARGEST_MM = 25.0


def colour(mm, shade=1.0):
    s = min(mm / LARGEST_MM, 1.0)
    for (a, low), (b, high) in zip(RAMP, RAMP[1:]):
        if s <= b:
            w = (s - a) / (b - a)
            rgb = [low[i] + (high[i] - low[i]) * w for i in range(3)]
            break
    return "#" + "".join("%02x" % max(0, min(255, round(v * shade))) for v in rgb)


def shading(t):
    u = [t[1][a] - t[0][a] for a in range(3)]
    v = [t[2][a] - t[0][a] for a in range(3)]
    n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    length = math.sqrt(sum(c * c for c in n)) or 1.0
    n = [-c / length * SIGN for c in n]     # outwards: away from us is positive depth
    light = (-0.3, -0.62, -0.72)
    return 0.72 + 0.36 * max(0.0, sum(a * b for a, b in zip(n, light)))


def painted(vertices, faces, error):
    """Visible triangles, one path for each colour; groups that lie farther away come first."""
    groups = {}
    for k in visible(vertices, faces):
        t = corners(vertices, faces[k])
        mm = sum(error[i] for i in faces[k]) / 3
        fill = colour(round(mm), round(shading(t) * 12) / 12)
        groups.setdefault(fill, []).append(t)
    order = sorted(groups, key=lambda fill: -sum(t[0][2] for t in groups[fill]) / len(groups[fill]))
    return "\n".join('<path fill="%s" stroke="%s" d="%s"/>' % (fill, fill, path_of(groups[fill])) for fill in order)


def bar(x, y, width):
    cells, n = [], 40
    for i in range(n):
        cells.append('<rect x="%.1f" y="%d" width="%.1f" height="10" fill="%s"/>' %
                     (x + width * i / n, y, width / n + 0.5, colour(LARGEST_MM * (i + 0.5) / n)))
    for mm in (0, 5, 10, 15, 20, 25):
        cells.append('<text x="%.1f" y="%d" text-anchor="middle">%d</text>' % (x + width * mm / LARGEST_MM, y + 26, mm))
    return "\n".join(cells)


def summary(error):
    return "mean %.1f mm, largest %.1f mm" % (sum(error) / len(error), max(error))


build = sys.argv[1] if len(sys.argv) > 1 else "build"
demo = os.path.join(build, "demo-bone")
source, faces = read_ply(os.path.join(demo, "source.ply"))
target, target_faces = read_ply(os.path.join(demo, "target.ply"))
truth, _ = read_ply(os.path.join(demo, "truth.ply"))
result, _ = read_ply(os.path.join(demo, "result", "source.ply"))
before = [math.dist(a, b) for a, b in zip(source, truth)]
after = [math.dist(a, b) for a, b in zip(result, truth)]

# Which turning sense means "seen from outside": the one whose faces lie nearer to us.
nearer = sum(facing(corners(source, f)) * sum(source[i][1] for i in f) for f in faces)
middle = sum(v[1] for v in source) / len(source) * 3
nearer -= sum(facing(corners(source, f)) for f in faces) * middle
SIGN = 1.0 if nearer < 0 else -1.0

points = [project(p) for p in source + target]
left, right = min(p[0] for p in points), max(p[0] for p in points)
top, bottom = min(p[1] for p in points), max(p[1] for p in points)
margin, title, legend = 16, 30, 50
panel = bottom - top + title + 12
width, height = right - left + 2 * margin, 2 * panel + legend
shadow = path_of([t for t in (corners(target, f) for f in target_faces) if facing(t) * SIGN > 0])

svg = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 %d %d" width="%d" height="%d" '
       'font-family="sans-serif" font-size="15" fill="#7d8590">' % (width, height, width, height),
       '<title>The demo pair before and after registration</title>',
       '<defs><path id="t" fill="#9aa3ad" stroke="#9aa3ad" stroke-width="2" d="%s"/></defs>' % shadow]
for row, (name, vertices, error) in enumerate((("Before", source, before), ("After", result, after))):
    y = row * panel
    svg.append('<text x="%d" y="%d"><tspan font-weight="bold">%s:</tspan> %s from the true place</text>' %
               (margin, y + 20, name, summary(error)))
    svg.append('<g transform="translate(%.1f %.1f) scale(%g)" stroke-width="2" stroke-linejoin="round">' %
               (margin - left, y + title - top, 1 / GRID))
    svg.append('<use href="#t"/>')
    svg.append(painted(vertices, faces, error))
    svg.append('</g>')
y = int(2 * panel)
svg.append('<rect x="%d" y="%d" width="26" height="10" fill="#9aa3ad"/><text x="%d" y="%d">target</text>' %
           (margin, y + 10, margin + 34, y + 20))
svg.append('<text x="%d" y="%d" text-anchor="end">model, distance from the true place, mm</text>' % (width - 330, y + 20))
svg.append(bar(width - 315, y + 10, 290))
svg.append('</svg>')
out = os.path.join(os.path.dirname(os.path.abspath(__file__)), "demo.svg")
with open(out, "w", encoding="ascii") as file:
    file.write("\n".join(svg) + "\n")
print("written:", os.path.relpath(out), os.path.getsize(out), "bytes")
