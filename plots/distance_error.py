#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A distance record as a table (printed) and a figure: time for each relative error allowed, for every
volume, and the error seen beside the one promised.

usage: distance_error.py RECORD [--out FOLDER]
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
    return rows, table.stem


def middle_of(rows):
    return rows.groupby(["mesh", "strategy", "volume", "relative_error"], sort=False).agg(
        us=("us", "median"), largest=("largest_error", "max"), mean=("mean_error", "first"),
        n_v=("n_v", "first"), outside=("outside", "max")).reset_index()


def draw(middle, out, name):
    meshes = list(dict.fromkeys(middle.mesh))
    middle["variant"] = middle.volume if middle.strategy.nunique() == 1 else middle.volume + " " + middle.strategy
    looks = style.variant_looks(middle.variant)
    figure, axes = plt.subplots(len(meshes), 3, figsize=(7.2, 2.5 * len(meshes)), squeeze=False)
    for line, mesh in zip(axes, meshes):
        for variant in dict.fromkeys(middle.variant):
            part = middle[(middle.mesh == mesh) & (middle.variant == variant)].sort_values("relative_error")
            look = dict(linewidth=1, markersize=3, label=variant, **style.point_style(looks[variant]))
            line[0].plot(part.relative_error, part.us, **look)
            line[1].plot(part.relative_error, part.largest, **look)
            line[2].plot(part["mean"], part.us, **look)
        line[1].plot([0, 0.5], [0, 0.5], color="#888888", linewidth=0.8, linestyle=":")
        line[1].text(0.3, 0.34, "promised", fontsize=6, color="#666666", rotation=35)
        line[0].set_yscale("log")
        line[2].set_yscale("log")
        line[2].set_xscale("symlog", linthresh=1e-4)
        line[0].set_ylabel("µs a pair")
        line[1].set_ylabel("largest error seen")
        line[2].set_ylabel("µs a pair")
        line[0].set_title(mesh, loc="left")
    axes[-1, 0].set_xlabel("relative error allowed")
    axes[-1, 1].set_xlabel("relative error allowed")
    axes[-1, 2].set_xlabel("mean error seen")
    style.legend_below(figure, axes[0, 0])
    figure.tight_layout()
    return style.save(figure, out, name)


def main():
    arguments = record_arguments(__doc__)
    rows, name = read(arguments.record)
    assert (rows.outside == 0).all(), "an answer lies outside of what is promised"
    middle = middle_of(rows)
    print("Median microseconds a pair:")
    with pd.option_context("display.width", 200):
        print(middle.pivot_table(index=["mesh", "strategy", "volume"], columns="relative_error",
                                 values="us").round(1).to_string())
        print("Largest error seen:")
        print(middle.pivot_table(index=["mesh", "strategy", "volume"], columns="relative_error",
                                 values="largest").round(3).to_string())
    print(draw(middle, arguments.out, name))


if __name__ == "__main__":
    main()
