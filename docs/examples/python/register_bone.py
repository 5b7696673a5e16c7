"""register_bone.py: a computed bone registered onto another one, step by step, and a figure of it.

usage: register_bone.py [--svg] OUT     writes OUT.png by matplotlib, or OUT.svg where that is not there (--svg: anyway)
Cells start with "# %%", as Jupyter, Spyder and VS Code have them. SPDX-License-Identifier: MIT
"""
# %% [markdown]
# The library is one file, smr.py, over libsmr.so (`make shared`). Put its folder on the path, or copy it.

# %%
import os
import sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "port", "python"))
import smr  # noqa: E402

# %% [markdown]
# ## Two surfaces
# Positions are [n][3] in millimetres, triangles [m][3]. Yours come from files: trimesh, PyVista and meshio give both.


# %%
def bone(rings, around):
    """A closed surface, 240 mm long with a head on one side, and its triangles."""
    z = np.repeat(np.cos(np.pi * np.arange(1, rings + 1) / (rings + 1)), around)
    angle = np.tile(2 * np.pi * np.arange(around) / around, rings)
    radius = np.sqrt(1 - z**4) * (0.6 + 0.5 * z**2 + 0.25 * z**3) * (1 + 0.4 * np.clip(z, 0, 1) ** 4 * np.sin(angle))
    xyz = np.stack([24 * radius * np.cos(angle), 20 * radius * np.sin(angle), 120 * z], 1)
    xyz = np.concatenate([[[0, 0, 120]], xyz, [[0, 0, -120]]])
    ring = lambda i, j: 1 + i * around + j % around  # noqa: E731
    triangles = [[0, ring(0, j), ring(0, j + 1)] for j in range(around)]
    for i in range(rings - 1):
        for j in range(around):
            triangles += [[ring(i, j), ring(i + 1, j), ring(i + 1, j + 1)],
                          [ring(i, j), ring(i + 1, j + 1), ring(i, j + 1)]]
    triangles += [[ring(rings - 1, j), len(xyz) - 1, ring(rings - 1, j + 1)] for j in range(around)]
    return xyz, np.array(triangles)


def patient(xyz):
    """Another person's: bowed, thicker at the head, turned by 35 degrees, elsewhere."""
    bent = xyz * [1.1, 1.1, 1.05] + np.stack([8 * (xyz[:, 2] / 120) ** 2, 4 * np.sin(xyz[:, 2] / 60), 0 * xyz[:, 2]], 1)
    c, s = np.cos(np.radians(35)), np.sin(np.radians(35))
    return bent @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]]) + [60, -25, 40]


model_xyz, model_triangles = bone(48, 24)
target_xyz, target_triangles = bone(61, 29)  # another mesh: no vertex of one is a vertex of the other
target_xyz = patient(target_xyz)
truth = patient(model_xyz)  # what nobody knows of a real patient

# %% [markdown]
# ## Registration
# `prepare` makes a model of surfaces, once; it can be saved. `align` finds the start pose.

# %%
model = smr.Model.prepare({"bone": (model_xyz, model_triangles)})
result = smr.register(model, (target_xyz, target_triangles), align="similarity")

# %% [markdown]
# ## Can it be trusted?
# "good", "look" (with reasons) or "failed"; and how far each vertex is expected from its true place.

# %%
off = np.linalg.norm(result.positions[0] - truth, axis=1)
expected = result.expected_error[0]
print(f"verdict: {result.verdict.word}", *result.verdict.why, sep="\n  ")
print(f"{result.report.iteration} iterations, {result.report.residual_mean_mm:.3f} mm from the target in the mean")
print(f"vertices from their true places: {off.mean():.2f} mm in the mean, {off.max():.2f} at most; "
      f"expected {np.nanmean(expected):.2f}")
print(f"state hash: {result.hash:016x}")

# %% [markdown]
# ## What lies beside the bone goes along

# %%
tumour = np.array([[30.0, 10.0, 60.0]])
print("a point beside the bone:", np.round(result.carry(tumour)[0], 2), "truly:", np.round(patient(tumour)[0], 2))

# %% [markdown]
# ## The figure
# Seen along y: before, after, and the expected error. The panels share one scale.

# %%
panels = [
    ("before: model (blue), patient (grey)",
     [(target_xyz, target_triangles, "#b0b0b0"), (model_xyz, model_triangles, "#3b6fb6")]),
    ("after", [(target_xyz, target_triangles, "#b0b0b0"), (result.positions[0], model_triangles, "#3b6fb6")]),
    (f"expected error, 0 to {np.nanmax(expected):.1f} mm", [(result.positions[0], model_triangles, expected)]),
]


def shades(xyz, triangles, colour):
    """The triangles that face the viewer, the farthest first, and a colour [k][3] in 0..1 for each."""
    corner = xyz[triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    front = np.flatnonzero(normal[:, 1] < 0)
    front = front[np.argsort(-corner[front].mean(1)[:, 1])]
    light = 0.45 + 0.55 * -normal[front, 1] / np.linalg.norm(normal[front], axis=1)
    if isinstance(colour, str):
        base = np.array([int(colour[k:k + 2], 16) / 255 for k in (1, 3, 5)])[None]
    else:  # dark blue to yellow: readable in black and white, too
        share = np.nan_to_num(colour[triangles[front]].mean(1) / np.nanmax(colour))[:, None]
        base = (1 - share) * [0.15, 0.2, 0.5] + share * [1.0, 0.9, 0.3]
    return corner[front][:, :, [0, 2]], light[:, None] * base


def draw_svg(path):
    """The figure as SVG, without any library."""
    every = np.concatenate([model_xyz, target_xyz])[:, [0, 2]]
    low, size = every.min(0) - 10, np.ptp(every, 0) + 20
    with open(path, "w", encoding="utf-8") as file:
        print(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {3 * size[0]:.0f} {size[1] + 16:.0f}" '
              f'font-family="sans-serif" font-size="9"><rect width="100%" height="100%" fill="white"/>', file=file)
        for k, (title, meshes) in enumerate(panels):
            print(f'<text x="{k * size[0] + 6:.0f}" y="12">{title}</text>', file=file)
            for mesh in meshes:
                for corner, rgb in zip(*shades(*mesh)):
                    x, y = corner[:, 0] - low[0] + k * size[0], low[1] + size[1] - corner[:, 1] + 16
                    ink = "#" + "".join(f"{int(255 * c):02x}" for c in rgb)
                    print(f'<path d="M{x[0]:.1f} {y[0]:.1f}L{x[1]:.1f} {y[1]:.1f}L{x[2]:.1f} {y[2]:.1f}z" fill="{ink}" '
                          f'stroke="{ink}" stroke-width=".3"/>', file=file)
        print("</svg>", file=file)


def draw_png(path):
    """The same by matplotlib."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.collections import PolyCollection
    figure, axes = pyplot.subplots(1, 3, sharex=True, sharey=True, figsize=(12, 6))
    for axis, (title, meshes) in zip(axes, panels):
        for mesh in meshes:
            corners, rgb = shades(*mesh)
            axis.add_collection(PolyCollection(corners, facecolors=rgb, edgecolors=rgb, linewidths=0.3))
        axis.set_title(title)
        axis.set_xlabel("x, mm")
        axis.set_aspect("equal")
        axis.autoscale_view()
    axes[0].set_ylabel("z, mm")
    figure.tight_layout()
    figure.savefig(path, dpi=110)


arguments = sys.argv[1:]
svg = "--svg" in arguments
if svg:
    arguments.remove("--svg")
out = arguments[0] if len(arguments) == 1 else "register_bone"
try:
    if svg:
        raise ImportError
    draw_png(out + ".png")
    print(f"figure: {out}.png")
except ImportError:
    draw_svg(out + ".svg")
    print(f"figure: {out}.svg")
