#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A peers record as a table (printed) and a figure: time per pair, ours beside other libraries.

usage: peers.py RECORD [--out FOLDER]
"""

from pathlib import Path

import numpy as np
import pandas as pd
import matplotlib.pyplot as plt

import records
import style
from arguments import record_arguments

def read(record):
    (table,) = Path(record).glob("*.csv")
    rows = records.table(table)
    rows["us_per_pair"] = rows.time_ns / rows.pairs / 1e3
    return rows


def refused(rows):
    """Variants whose answers differ somewhere: listed, not drawn."""
    wrong = rows[rows.differing != 0]
    return wrong.groupby("variant").differing.sum()


def variants_of(rows):
    """Ours, then the peers."""
    return list(dict.fromkeys([*rows[rows.peer == ""].variant, *rows.variant]))


def print_table(rows):
    middle = rows.groupby(["query", "polygons", "density", "motion", "variant"],
                          sort=False).us_per_pair.median().unstack("variant")
    middle = middle[variants_of(rows)]
    middle = middle.dropna(axis=1, how="all")
    ours = [v for v in middle.columns if v in set(rows[rows.peer == ""].variant)]
    peers = [v for v in middle.columns if v not in ours]
    middle["recursive / best peer"] = middle["sphere recursive"] / middle[peers].min(axis=1)
    middle["best of ours / best peer"] = middle[ours].min(axis=1) / middle[peers].min(axis=1)
    print("Median microseconds per pair and frame; answers compared frame by frame:")
    with pd.option_context("display.width", 200, "display.max_columns", 20):
        print(middle.round(3).to_string())


def draw(rows, out, name):
    panels = list(rows.groupby(["query", "polygons"], sort=False))
    lines = int(np.ceil(len(panels) / 2))
    figure, axes = plt.subplots(lines, min(2, len(panels)), figsize=(7.2, 3.2 * lines),
                                squeeze=False)
    variants = variants_of(rows)
    looks = style.variant_looks(variants)
    for axis, ((query, polygons), group) in zip(axes.flat, panels):
        cells = list(dict.fromkeys(zip(group.density, group.motion)))
        for k, variant in enumerate(variants):
            quartiles = np.array([
                group[(group.variant == variant) & (group.density == d) & (group.motion == m)]
                .us_per_pair.quantile([0.25, 0.5, 0.75]) for d, m in cells])
            places = np.arange(len(cells)) + (k - (len(variants) - 1) / 2) * 0.7 / len(variants)
            axis.errorbar(places, quartiles[:, 1], markersize=4, elinewidth=0.8, label=variant,
                          yerr=[quartiles[:, 1] - quartiles[:, 0], quartiles[:, 2] - quartiles[:, 1]],
                          **style.marker_style(looks[variant]))
        axis.set_yscale("log")
        axis.set_title(f"{query}, {polygons} polygons")
        axis.set_xticks(range(len(cells)), [f"{d}; {m}" for d, m in cells], fontsize=6,
                        rotation=35, ha="right", rotation_mode="anchor")
        axis.grid(axis="x", visible=False)
    for axis in axes[:, 0]:
        axis.set_ylabel("µs per pair and frame")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncol=len(variants), frameon=False,
                  bbox_to_anchor=(0.5, -0.05))
    figure.tight_layout()
    return style.save(figure, out, name)


def main():
    arguments = record_arguments(__doc__)
    rows = read(arguments.record)
    for variant, count in refused(rows).items():
        print(f"{variant}: {count} answers differ from ours; refused")
        rows = rows[rows.variant != variant]
    print_table(rows)
    (table,) = arguments.record.glob("*.csv")
    print(draw(rows, arguments.out, table.stem))


if __name__ == "__main__":
    main()
