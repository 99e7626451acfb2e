#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A record of boxes in float and double as a table (printed) and a figure: false pairs against the
distance from the origin, and time a frame.

usage: boxes_precision.py RECORD [--out FOLDER]
"""

import numpy as np
import pandas as pd
import matplotlib.pyplot as plt

import style
from arguments import record_arguments


def middle_of(rows):
    return rows.groupby(["set", "method", "numbers", "offset"], sort=False).agg(
        us=("ns_per_frame", lambda ns: ns.median() / 1e3), pairs=("pairs", "first"),
        positives=("false_positives", "max"), negatives=("false_negatives", "max")).reset_index()


def draw(middle, out, name):
    sets, methods = list(dict.fromkeys(middle.set)), list(dict.fromkeys(middle.method))
    looks = {numbers: style.point_style(look) for numbers, look in style.looks(middle.numbers).items()}
    figure, axes = plt.subplots(1 + len(methods), len(sets), figsize=(7.2, 2 * len(methods) + 2.4), squeeze=False,
                                sharex=True)
    for column, which in zip(axes.T, sets):
        # Which pairs are found is the same for every method.
        part = middle[(middle.set == which) & (middle.method == methods[0])]
        for numbers, look in looks.items():
            line = part[part.numbers == numbers].sort_values("offset")
            x = np.maximum(line.offset, 1)
            million = 1e6 / np.maximum(line.pairs, 1)
            column[0].plot(x, np.maximum(line.positives * million, 0.3), markersize=4,
                           label=f"{numbers}: too many", **look)
            if line.negatives.any() or numbers == "float, nearest":
                column[0].plot(x, np.maximum(line.negatives * million, 0.3), markersize=4,
                               markerfacecolor="none", label=f"{numbers}: missed", **look)
            for axis, method in zip(column[1:], methods):
                line = middle[(middle.set == which) & (middle.method == method) & (middle.numbers == numbers)]
                line = line.sort_values("offset")
                axis.plot(np.maximum(line.offset, 1), line.us, markersize=4, **look)
        column[0].set_xscale("log")
        column[0].set_yscale("log")
        column[0].set_title(which)
        for axis in column[1:]:
            axis.set_ylim(bottom=0)
        column[-1].set_xlabel("distance from the origin")
        column[0].axhline(0.3, color="#888888", linewidth=0.6)
    axes[0, 0].set_ylabel("false pairs per million\n(the lowest line: none)")
    for axis, method in zip(axes[1:, 0], methods):
        axis.set_ylabel(f"µs a frame, {method}")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncol=2, frameon=False,
                  bbox_to_anchor=(0.5, -0.1))
    figure.tight_layout()
    return style.save(figure, out, name)


def main():
    arguments = record_arguments(__doc__)
    (table,) = arguments.record.glob("*.csv")
    middle = middle_of(pd.read_csv(table))
    outward = middle[middle.numbers != "float, nearest"]
    assert (outward.negatives == 0).all(), "a pair was missed that must not be"
    with pd.option_context("display.width", 200):
        print(middle.to_string())
    print(draw(middle, arguments.out, table.stem))


if __name__ == "__main__":
    main()
