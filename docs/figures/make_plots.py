#!/usr/bin/env python3
# make_plots: draws docs/figures/figure1.svg and figure2.svg from the tables beside them. Needs matplotlib; without it
# nothing is drawn.
# SPDX-License-Identifier: MIT
# usage: python3 docs/figures/make_plots.py figure1|figure2...      (after `make figure1`: it writes the table)
import csv
import os
import sys

try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
except ImportError:
    print("skip: the figures are not drawn, python3 has no matplotlib")
    sys.exit(0)

FOLDER = os.path.dirname(os.path.abspath(__file__))
RADII = {"100": "#0b6bb8", "50": "#2b8a3e", "30": "#c8400f", "20": "#7a3e9d"}  # colours of figure 1
METHODS = {"rigid": "#0b6bb8", "polar": "#c8400f"}  # and of figure 2


def table(name):
    with open(os.path.join(FOLDER, name + ".csv"), encoding="ascii", newline="") as file:
        return list(csv.DictReader(file))


def numbers(rows, key):
    return [float(row[key]) for row in rows]


def axes(one, title, x, y):
    one.set(title=title, xlabel=x, ylabel=y, ylim=(0, None), xlim=(0, None))
    one.grid(axis="y", color="#dddddd")
    one.legend(fontsize="small", frameon=False)


def figure1(left, right):
    rows = table("figure1")
    for one, method, title in ((left, "rigid", "Rigid-body kinematics"), (right, "polar", "Polar decomposition")):
        for radius, colour in RADII.items():
            for kind, line in (("elastic", "--"), ("plastic", "-")):
                run = [r for r in rows if (r["method"], r["radius_mm"], r["reference"]) == (method, radius, kind)]
                one.plot(numbers(run, "time_ms"), numbers(run, "hausdorff_mm"), line, marker="o", markersize=3, color=colour,
                         label=f"{radius} mm, {kind}")
        axes(one, title, "time, ms, one thread", "Hausdorff distance, mm")


def figure2(left, right):
    rows = table("figure2")
    for method, colour in METHODS.items():
        for part, line, words in (("with_forces", "-", "with external forces"), ("without_forces", "--", "without")):
            run = [r for r in rows if (r["row"], r["method"], r["part"]) == ("time", method, part)]
            fit = [r for r in rows if (r["row"], r["method"], r["part"]) == ("fit", method, part)][0]
            left.plot(numbers(run, "ignored_percent"), numbers(run, "median_ms"), "o", markersize=4, color=colour)
            left.plot([0, 100], [float(fit["ms_at_0_percent"]), float(fit["ms_at_100_percent"])], line, color=colour,
                      label=f"{method}, {words}")
    for method, part, line, colour, words in (("rigid", "fixed", "-", "#0b6bb8", "rigid"), ("polar", "fixed", "--", "#c8400f", "polar"),
                                              ("rigid", "growing", "-", "#2b8a3e", "rigid, growing to all vertices")):
        run = [r for r in rows if (r["row"], r["method"], r["part"]) == ("error", method, part)]
        right.plot(numbers(run, "ignored_percent"), numbers(run, "to_truth_mm"), line, marker="o", markersize=4, color=colour, label=words)
    axes(left, "Time of an iteration (points) and linear fit", "ignored vertices, %", "ms, one thread")
    axes(right, "Segmentation error after registration", "ignored vertices, %", "mean distance to the truth, mm")


plt.rcParams.update({"svg.hashsalt": "smr", "svg.fonttype": "none"})
for name in sys.argv[1:]:
    picture, panels = plt.subplots(1, 2, figsize=(10.5, 4.6), layout="constrained")
    {"figure1": figure1, "figure2": figure2}[name](*panels)
    picture.savefig(os.path.join(FOLDER, name + ".svg"), metadata={"Date": None})
    print("written:", os.path.join("docs", "figures", name + ".svg"))
