#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A closest-features record as a table (printed) and a figure: time, and tests where they are counted, against
motion per frame.

usage: closest_features.py RECORD [--out FOLDER]
"""

from pathlib import Path

import numpy as np
import pandas as pd
import matplotlib.pyplot as plt

import style
from arguments import record_arguments


def read(record):
    rows = pd.read_csv(Path(record) / "closest-features.csv", keep_default_na=False)
    later = (rows.frames - 1) / rows.frames
    rows["us"] = (rows.time_ns - rows.first_ns) / (rows.pairs * later) / 1e3
    rows["variant"] = np.where(rows.peer == "", rows.volume + " " + rows.strategy, rows.peer)
    for count in ("n_v", "n_p"):
        rows[count] = pd.to_numeric(rows[count]) / rows.pairs
    return rows


def draw(rows, out):
    meshes = list(dict.fromkeys(rows.mesh))
    looks = {variant: style.point_style(look) for variant, look in style.variant_looks(rows.variant).items()}
    figure, axes = plt.subplots(2, len(meshes), figsize=(7.4, 5), sharex=True, sharey="row", squeeze=False)
    for column, mesh in enumerate(meshes):
        for variant, group in rows[rows.mesh == mesh].groupby("variant", sort=True):
            group = group.groupby("degrees")
            us = group.us.quantile([0.25, 0.5, 0.75]).unstack()
            axes[0, column].errorbar(us.index, us[0.5], yerr=[us[0.5] - us[0.25], us[0.75] - us[0.5]], markersize=4,
                                     linewidth=0.9, label=variant, **looks[variant])
            tests = group.n_v.first().dropna()
            if len(tests):
                axes[1, column].plot(tests.index, tests, markersize=4, linewidth=0.9, **looks[variant])
        axes[0, column].set_title(mesh)
        for axis in axes[:, column]:
            axis.set_xscale("log")
            axis.set_yscale("log")
        axes[1, column].set_xlabel("degrees per frame")
    axes[0, 0].set_ylabel("µs per pair and frame")
    axes[1, 0].set_ylabel("vertices, planes or volumes\nlooked at per pair")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.tight_layout()
    figure.legend(handles, labels, loc="upper center", ncol=4, frameon=False, bbox_to_anchor=(0.5, 0.0))
    return style.save(figure, out, "closest-features")


def main():
    arguments = record_arguments(__doc__)
    rows = read(arguments.record)
    for variant, group in rows[rows.differing != 0].groupby("variant"):
        cells = group.drop_duplicates(["mesh", "motion"])
        print(f"{variant}: {cells.differing.sum()} of {cells.pairs.sum()} distances differ by more than 1e-12")
    with pd.option_context("display.width", 250, "display.max_columns", 40):
        for value in ("us", "n_v", "n_p"):
            print(f"\n{value} per pair and frame:")
            print(rows.pivot_table(index="variant", columns=["mesh", "degrees"], values=value, aggfunc="median")
                  .round(2).to_string())
    print(draw(rows, arguments.out))


if __name__ == "__main__":
    main()
