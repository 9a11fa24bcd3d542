#!/usr/bin/env python3
"""Maps of what `mortise bench hertz` measured, beside the renderer's picture: pressure over p0 and its error, node by node.

    tools/pressure_map.py OUT/SIZE_METHOD.csv ... [-o FILE.png]

Reads the CSV files that `mortise bench hertz --out OUT` leaves (x, y, pressure of the block's nodes; contact radius and peak of Hertz in the first
line) and draws one row per file. Needs matplotlib.
"""
import argparse
import os
import re

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.tri import Triangulation


def read(path):
    with open(path) as file:
        head = file.readline()
        a, p0 = (float(re.search(key + r"=(\S+)", head).group(1)) for key in ("contact_radius", "peak_pressure"))
        file.readline()
        rows = [tuple(map(float, line.split(","))) for line in file]
    near = [(x / a, y / a, p / p0) for x, y, p in rows if x * x + y * y < (2 * a) ** 2]
    return list(zip(*near))


def mirrored(x, y, values):
    """The quarter and its images at x = 0 and y = 0."""
    X, Y, V = [], [], []
    for sx, sy in ((1, 1), (-1, 1), (1, -1), (-1, -1)):
        for a, b, v in zip(x, y, values):
            if (sx < 0 and a < 1e-9) or (sy < 0 and b < 1e-9):
                continue
            X.append(sx * a), Y.append(sy * b), V.append(v)
    return X, Y, V


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+")
    parser.add_argument("-o", "--output", default="pressure_map.png")
    arguments = parser.parse_args()
    figure, axes = plt.subplots(len(arguments.files), 2, figsize=(8.6, 3.6 * len(arguments.files)), squeeze=False, constrained_layout=True)
    for row, path in zip(axes, arguments.files):
        x, y, p = read(path)
        exact = [max(0.0, 1 - a * a - b * b) ** 0.5 for a, b in zip(x, y)]
        error = [100 * (v - e) for v, e in zip(p, exact)]
        for axis, values, title, style in ((row[0], p, "p/p0", dict(cmap="magma", vmin=0, vmax=1.2)), (row[1], error, "error [% of p0]", dict(cmap="RdBu_r", vmin=-15, vmax=15))):
            X, Y, V = mirrored(x, y, values)
            image = axis.tripcolor(Triangulation(X, Y), V, shading="gouraud", **style)
            axis.add_patch(plt.Circle((0, 0), 1, fill=False, color="white" if axis is row[0] else "black", lw=1))
            axis.set(xlim=(-1.5, 1.5), ylim=(-1.5, 1.5), aspect="equal", xlabel="x/a", ylabel="y/a", title=os.path.splitext(os.path.basename(path))[0] + ": " + title)
            figure.colorbar(image, ax=axis)
    figure.savefig(arguments.output, dpi=110)


if __name__ == "__main__":
    main()
