#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A budget record as a table (printed) and a figure: how deep surfaces can be where it is not known yet
whether they touch, and how many answers are not known, against tests of volumes and against time.

usage: budget.py RECORD [--out FOLDER]
"""

from pathlib import Path

import pandas as pd
import matplotlib.pyplot as plt

import style
from arguments import record_arguments


def read(record):
    (table,) = Path(record).glob("*.csv")
    rows = pd.read_csv(table)
    rows["us"] = rows.time_ns / rows.answers / 1e3
    rows["unknown_percent"] = 100 * rows.unknown / rows.answers
    return rows, table.stem


def middle_of(rows):
    return rows.groupby(["mesh", "volume", "budget"], sort=False).agg(
        us=("us", "median"), unknown=("unknown_percent", "first"), wrong=("wrong", "max"),
        mean=("mean_deepest_per_radius", "first")).reset_index().sort_values("budget")


def winners(middle):
    """For each mesh and error, the volume that comes below it in the least time."""
    print("Least microseconds a pair to a mean bound below a part of the radius:")
    for mesh, group in middle.groupby("mesh", sort=False):
        for error in (0.3, 0.1, 0.03, 0.01, 0.003, 0.001):
            good = group[group["mean"] <= error]
            if good.empty:
                continue
            best = good.loc[good.us.idxmin()]
            print(f"  {mesh:8s} {error:6g}: {best.volume} ({best.us:.2f} us, budget {best.budget})")


def draw(middle, out, name):
    meshes = list(dict.fromkeys(middle.mesh))
    looks = style.looks(middle.volume)
    figure, axes = plt.subplots(len(meshes), 3, figsize=(7.2, 2.5 * len(meshes)), squeeze=False)
    for line, mesh in zip(axes, meshes):
        for volume in dict.fromkeys(middle.volume):
            part = middle[(middle.mesh == mesh) & (middle.volume == volume)]
            look = dict(linewidth=1, markersize=3, label=volume, **style.point_style(looks[volume]))
            known = part[part["mean"] > 0]
            line[0].plot(known.budget, known["mean"], **look)
            line[1].plot(known.us, known["mean"], **look)
            line[2].plot(part.us, part.unknown, **look)
        for axis in line:
            axis.set_xscale("log")
        line[0].set_yscale("log")
        line[1].set_yscale("log")
        line[0].set_ylabel("mean bound on depth, radii")
        line[1].set_ylabel("mean bound on depth, radii")
        line[2].set_ylabel("not yet known, %")
        line[2].set_ylim(bottom=0)
        line[0].set_title(mesh, loc="left")
    axes[-1, 0].set_xlabel("tests of volumes allowed")
    axes[-1, 1].set_xlabel("µs a pair")
    axes[-1, 2].set_xlabel("µs a pair")
    style.legend_below(figure, axes[0, 0])
    figure.tight_layout()
    return style.save(figure, out, name)


def main():
    arguments = record_arguments(__doc__)
    rows, name = read(arguments.record)
    assert (rows.wrong == 0).all(), "an early answer was wrong"
    middle = middle_of(rows)
    with pd.option_context("display.width", 200):
        print(middle.pivot_table(index=["mesh", "volume"], columns="budget",
                                 values="mean").round(4).to_string())
    winners(middle)
    print(draw(middle, arguments.out, name))


if __name__ == "__main__":
    main()
