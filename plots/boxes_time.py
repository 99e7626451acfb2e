#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A record of boxes_benchmark as figures: time against number, or against displacement.

usage: boxes_time.py RECORD/NAME.csv [--out FOLDER]

A table whose displacement varies becomes <name>-<set>: processor time of a frame against displacement,
one line per method. Any other becomes <name>-<set>: time against the number of boxes with the fitted
exponent of each method, filled markers coherent, hollow from scratch.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import style

GREYS = ["#1b1b1b", "#d95f0e", "#41a5c4", "#7a5195", "#3c8d40", "#bc9fd1", "#8f8f8f", "#c43c6b"]
MARKERS = ["o", "s", "^", "D", "P", "v", "x", "*"]
DASHES = ["-", "--", "-.", ":", (0, (5, 1)), (0, (3, 1, 1, 1)), (0, (1, 1)), (0, (6, 2, 1, 2))]
# In the order of their family, so that a name looks the same in every figure.
NAMES = ["blocks", "hybrid", "hash", "sweep1", "sweep2", "sweep3", "sweep4", "cgal-1000",
         "sort-and-sweep", "sap", "dynamic-tree", "fcl-tree", "bullet-dbvt", "grid", "lbvh", "embree"]


def look(name):
    if name in style.STYLES:
        known = style.STYLES[name]
        return dict(color=known["color"], marker=known["marker"], linestyle=known["linestyle"])
    place = NAMES.index(name) if name in NAMES else len(name)
    return dict(color=GREYS[place % 8], marker=MARKERS[place % 8], linestyle=DASHES[place % 8])


def read(path):
    """Median over repetitions; variants whose pairs differ from the reference are refused."""
    rows = pd.read_csv(path)
    wrong = sorted(set(rows[rows.differing != 0].method))
    if wrong:
        print("refused, since their pairs differ:", ", ".join(wrong))
        rows = rows[~rows.method.isin(wrong)]
    keys = ["set", "boxes", "motion", "displacement", "method", "coherent"]
    return rows.groupby(keys, sort=False).frame_ns.agg(
        q1=lambda x: x.quantile(0.25), time="median", q3=lambda x: x.quantile(0.75)).reset_index()


def exponent(group):
    """Slope of log time over log number, over the larger half of the numbers."""
    upper = group[group.boxes >= group.boxes.median()]
    if len(upper) < 2:
        return None
    return np.polyfit(np.log(upper.boxes), np.log(upper.time), 1)[0]


def against_number(name, rows, out):
    for set_name, of_set in rows.groupby("set", sort=False):
        figure, axes = plt.subplots(figsize=(5.2, 3.8))
        for (method, coherent), group in of_set.groupby(["method", "coherent"], sort=False):
            group = group.sort_values("boxes")
            both = of_set[of_set.method == method].coherent.nunique() > 1
            slope = exponent(group)
            label = method + (", kept" if both and coherent == "on" else "")
            if slope is not None:
                label += f"  $n^{{{slope:.2f}}}$"
            hollow = dict(markerfacecolor="white") if both and coherent == "off" else {}
            axes.plot(group.boxes, group.time / 1e6, label=label, markersize=4, linewidth=1.1, **look(method), **hollow)
        axes.set(xscale="log", yscale="log", xlabel="boxes", ylabel="processor time of a frame, ms", title=set_name)
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
        print(style.save(figure, out, f"{name}-{set_name}"))


def against_displacement(name, rows, out):
    for set_name, of_set in rows.groupby("set", sort=False):
        figure, axes = plt.subplots(figsize=(5.2, 3.8))
        least = of_set[of_set.displacement > 0].displacement.min()
        for (method, coherent), group in of_set.groupby(["method", "coherent"], sort=False):
            group = group.sort_values("displacement")
            where = group.displacement.where(group.displacement > 0, least / 10)
            axes.plot(where, group.time / 1e6, label=method, markersize=4, linewidth=1.1, **look(method))
        axes.set(xscale="log", yscale="log", xlabel="displacement a frame, fraction of box size (leftmost: none)",
                 ylabel="processor time of a frame, ms", title=f"{set_name}, {int(of_set.boxes.iloc[0])} boxes")
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
        print(style.save(figure, out, f"{name}-{set_name}"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", type=Path)
    parser.add_argument("--out", type=Path, default=None)
    arguments = parser.parse_args()
    rows = read(arguments.table)
    out = arguments.out or arguments.table.parent
    if rows.displacement.nunique() > 2:
        against_displacement(arguments.table.stem, rows, out)
    else:
        against_number(arguments.table.stem, rows, out)


if __name__ == "__main__":
    main()
