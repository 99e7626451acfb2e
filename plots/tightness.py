#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A tightness record as a table (printed) and a figure: what volumes leave out of distances, on each level of
the tree.

usage: tightness.py RECORD [--out FOLDER]

One panel for each mesh, one line for each volume: mean over a level's probes, in diameters of the node;
levels of fewer nodes than a sixteenth of the widest level's that lie below it are left out, for they are what
is left of branches that go deep. A record of several builds is drawn for the first.
"""

from pathlib import Path

import pandas as pd
import matplotlib.pyplot as plt

import records
import style
from arguments import record_arguments

LINES = {"published": dict(linestyle="-"), "tight": dict(linestyle="--", markerfacecolor="white")}
OTHER = dict(linestyle=":", markerfacecolor="#dddddd")


def read(record):
    (table,) = Path(record).glob("*.csv")
    rows = pd.read_csv(table)
    if (rows.least < 0).any():
        raise SystemExit(f"{table}: a gap exceeds the distance: refused")
    records.say_left_out(set(rows.build) - {rows.build.iloc[0]}, "builds but the first")
    rows = rows[rows.build == rows.build.iloc[0]]
    return rows, table.stem


def without_stragglers(rows):
    widest = rows.loc[rows.groupby("mesh").nodes.idxmax()].set_index("mesh")
    level, nodes = widest.level.reindex(rows.mesh).values, widest.nodes.reindex(rows.mesh).values
    return rows[(rows.level <= level) | (rows.nodes >= nodes / 16)]


def draw(rows, out, name):
    meshes = list(dict.fromkeys(rows.mesh))
    looks = style.looks(rows.volume)
    figure, axes = plt.subplots(1, len(meshes), figsize=(2.7 * len(meshes), 3.6), sharey=True,
                                squeeze=False)
    for axis, mesh in zip(axes[0], meshes):
        part = rows[rows.mesh == mesh]
        for (volume, fit), line in part.groupby(["volume", "fit"], sort=False):
            look = looks[volume]
            axis.plot(line.level, line["mean"], color=look["color"], marker=look["marker"],
                      markersize=3, linewidth=1.1, label=volume if fit == "published" else f"{volume}, {fit}",
                      **LINES.get(fit, OTHER))
        kind, _, polygons = mesh.partition(":")
        axis.set_title(f"{kind}, {polygons} polygons" if polygons else kind, loc="left")
        axis.set_xlabel("level (the root is 0)")
    axes[0, 0].set_ylim(bottom=0)
    axes[0, 0].set_ylabel("distance left out, in diameters of the node")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=(len(labels) + 1) // 2, frameon=False,
                  columnspacing=1)
    figure.tight_layout(rect=(0, 0.1, 1, 1))
    return style.save(figure, out, name)


def main():
    arguments = record_arguments(__doc__)
    rows, name = read(arguments.record)
    print("Mean over probes, in diameters of the node:")
    with pd.option_context("display.width", 200, "display.max_columns", 30):
        print(rows.pivot_table(index=["mesh", "volume", "fit"], columns="level", values="mean",
                               sort=False).round(3).to_string(na_rep=""))
    print(draw(without_stragglers(rows), arguments.out, name))


if __name__ == "__main__":
    main()
