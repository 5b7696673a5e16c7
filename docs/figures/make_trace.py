#!/usr/bin/env python3
# make_trace: draws traces of `smr register --trace` side by side in one SVG. Needs the standard library only.
# SPDX-License-Identifier: MIT
# usage: python3 docs/figures/make_trace.py OUT.svg TITLE=TRACE.csv...
#
# For each trace a column: distances to the target or the truth, likeness, and movement (logarithmic) over time; a line
# where the cluster radius falls. What no trace has is left out: surfaces have no likeness.
import csv
import math
import sys

WIDTH, HEIGHT, LEFT, RIGHT, TOP, GAP, BOTTOM = 470, 150, 52, 12, 56, 34, 44
BLUE, RED, GREEN = "#0b6bb8", "#c8400f", "#2b8a3e"
PANELS = (  # title, logarithmic, curves: column, name, colour
    ("distance to the truth, mm", True, (("hausdorff_mm", "Hausdorff", RED), ("mean_to_mm", "mean, to", BLUE),
                                         ("mean_from_mm", "mean, from", GREEN))),
    ("movement of an iteration, mm", True, (("moved_max_mm", "largest", RED), ("moved_mean_mm", "mean", BLUE))),
    ("likeness of image and profiles", False, (("likeness", "likeness", BLUE),)),
)


def read(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def numbers(rows, name):
    """(time, value) of the rows that have one."""
    return [(float(r["time_ms"]) / 1000.0, float(r[name])) for r in rows if r[name] != ""]


def nice(value):
    power = 10.0 ** math.floor(math.log10(value))
    return next(power * k for k in (1, 2, 5, 10) if power * k >= value * 0.999)


class Panel:
    """Places of values in one frame."""

    def __init__(self, x, y, t_max, low, high, logarithmic):
        self.x, self.y, self.t_max, self.log = x, y, t_max, logarithmic
        self.low, self.high = (math.log10(low), math.log10(high)) if logarithmic else (low, high)

    def px(self, t):
        return self.x + (WIDTH - LEFT - RIGHT) * t / self.t_max

    def py(self, v):
        v = math.log10(max(v, 1e-9)) if self.log else v
        share = (v - self.low) / (self.high - self.low)
        return self.y + HEIGHT * (1.0 - min(max(share, 0.0), 1.0))


def axes(out, p, title, low, high, last):
    ticks = [10.0 ** k for k in range(math.ceil(p.low), math.floor(p.high) + 1)] if p.log else \
        [low + (high - low) * k / 4.0 for k in range(5)]
    for v in ticks:
        out.append('<path d="M%.1f %.1fH%.1f" stroke="#dddddd"/><text x="%.1f" y="%.1f" text-anchor="end">%g</text>'
                   % (p.x, p.py(v), p.px(p.t_max), p.x - 5, p.py(v) + 4, round(v, 4)))
    step = nice(p.t_max / 6.0)
    for k in range(int(p.t_max / step) + 1):
        out.append('<path d="M%.1f %.1fv4" stroke="#333333"/>' % (p.px(k * step), p.y + HEIGHT))
        if last:
            out.append('<text x="%.1f" y="%.1f" text-anchor="middle">%g</text>'
                       % (p.px(k * step), p.y + HEIGHT + 18, round(k * step, 4)))
    out.append('<path d="M%.1f %.1fV%.1fH%.1f" stroke="#333333" fill="none"/>'
               % (p.x, p.y, p.y + HEIGHT, p.px(p.t_max)))
    out.append('<text x="%.1f" y="%.1f">%s</text>' % (p.x, p.y - 8, title))
    if last:
        out.append('<text x="%.1f" y="%.1f" text-anchor="middle">time, s</text>'
                   % (p.px(p.t_max / 2), p.y + HEIGHT + 36))


def changes(rows):
    """(time, label) where the radius falls; where it never does, where the reference shape follows."""
    found = []
    for before, row in zip(rows[1:], rows[2:]):
        if row["radius_mm"] != before["radius_mm"]:
            found.append((float(before["time_ms"]) / 1000.0, row["radius_mm"] + " mm"))
    return found


def panels_of(tables):
    """Those with values. Without a likeness the target is a surface, and distances are to it."""
    has = [any(v > 0 or not logarithmic for rows in tables for key, _, _ in curves for _, v in numbers(rows, key))
           for _, logarithmic, curves in PANELS]
    return [(title if has[-1] else title.replace("truth", "target"), logarithmic, curves)
            for (title, logarithmic, curves), there in zip(PANELS, has) if there]


def draw(out, column, title, rows, panels, ranges):
    t_max = max(t for t, _ in numbers(rows, "time_ms"))
    x = WIDTH * column + LEFT
    out.append('<text x="%.1f" y="22" font-size="15">%s</text>' % (x, title))
    for k, (name, logarithmic, curves) in enumerate(panels):
        p = Panel(x, TOP + k * (HEIGHT + GAP), t_max, ranges[k][0], ranges[k][1], logarithmic)
        axes(out, p, name, ranges[k][0], ranges[k][1], k + 1 == len(panels))
        for t, label in changes(rows):
            out.append('<path d="M%.1f %.1fv%d" stroke="#999999" stroke-dasharray="2 3"/>' % (p.px(t), p.y, HEIGHT))
            if k == 0:
                out.append('<text x="%.1f" y="%.1f" font-size="11" fill="#666666">%s</text>'
                           % (p.px(t) + 3, p.y + 11, label))
        for i, (key, label, colour) in enumerate(curves):
            points = numbers(rows, key)
            if not points:
                continue
            path = "L".join("%.1f %.1f" % (p.px(t), p.py(v)) for t, v in points)
            out.append('<path d="M%s" stroke="%s" stroke-width="1.5" fill="none"/>' % (path, colour))
            if len(curves) > 1:
                out.append('<text x="%.1f" y="%.1f" fill="%s" text-anchor="end">%s</text>'
                           % (p.px(t_max) - 2 - 78 * i, p.y - 8, colour, label))


def ranges_of(panels, tables):
    ranges = []
    for _, logarithmic, curves in panels:
        values = [v for rows in tables for key, _, _ in curves for _, v in numbers(rows, key) if v > 0 or not logarithmic]
        if logarithmic:
            ranges.append((10.0 ** math.floor(math.log10(min(values))), 10.0 ** math.ceil(math.log10(max(values)))))
        else:
            low = math.floor(min(values) * 10) / 10
            ranges.append((low, max(math.ceil(max(values) * 10) / 10, low + 0.1)))
    return ranges


def main():
    titles, tables = zip(*((text.split("=", 1)[0], read(text.split("=", 1)[1])) for text in sys.argv[2:]))
    panels = panels_of(tables)
    height = TOP + len(panels) * (HEIGHT + GAP) - GAP + BOTTOM
    width = WIDTH * len(tables)
    out = ['<svg xmlns="http://www.w3.org/2000/svg" width="%d" height="%d" viewBox="0 0 %d %d" '
           'font-family="sans-serif" font-size="12" fill="#222222">' % (width, height, width, height),
           "<title>%s</title>" % "; ".join(titles), '<rect width="%d" height="%d" fill="#ffffff"/>' % (width, height)]
    for k, (title, rows) in enumerate(zip(titles, tables)):
        draw(out, k, title, rows, panels, ranges_of(panels, tables))
    out.append("</svg>")
    with open(sys.argv[1], "w") as file:
        file.write("\n".join(out) + "\n")


main()
