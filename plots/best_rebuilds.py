#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of every strategy over those of a separation list with the best possible rebuilds.

usage: best_rebuilds.py RECORD [--out FOLDER]

RECORD holds best-rebuilds.csv and best-rebuilds.coherence.csv.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import records
import style
from arguments import record_arguments


def read(record):
    """One row for each motion, query and strategy: medians, N_v over the best, time over the best."""
    rows = records.table(Path(record) / "best-rebuilds.csv")
    best = records.table(Path(record) / "best-rebuilds.coherence.csv")
    if (rows.differing != 0).any():
        raise SystemExit(f"{record}: answers differ")
    # A peer has neither a volume nor tests that could be counted.
    rows["strategy"] = rows.strategy.where(rows.peer == "", rows.peer)
    keys = ["step", "degrees", "query", "volume"]
    labels = rows[["motion"] + keys].drop_duplicates()
    best = best.merge(labels, on=keys)[["motion", "query", "volume", "best_tests", "best_rebuilds"]]
    rows = rows.groupby(["motion", "query", "volume", "strategy"], sort=False, as_index=False).median(
        numeric_only=True)
    rows = rows.merge(best, how="left", on=["motion", "query", "volume"])
    rows["ratio"] = rows.n_v / rows.best_tests
    fastest = rows.groupby(["motion", "query"]).time_ns.transform("min")
    rows["slower"] = rows.time_ns / fastest
    return rows


def draw(rows, out):
    queries = list(dict.fromkeys(rows["query"]))
    several = rows[rows.volume != ""].volume.nunique() > 1
    rows = rows.assign(variant=(rows.volume + " " + rows.strategy).str.strip() if several else rows.strategy)
    looks = style.variant_looks(rows.variant)
    figure, axes = plt.subplots(2, len(queries), figsize=(7.2, 4.8), sharex=True, sharey="row", squeeze=False)
    for column, query in enumerate(queries):
        part = rows[rows["query"] == query]
        for variant in dict.fromkeys(part.variant):
            line = part[part.variant == variant]
            for axis, measure in zip(axes[:, column], ("ratio", "slower")):
                axis.plot(line.motion.str.replace(" / ", "\n"), line[measure], label=variant, markersize=4,
                          **style.point_style(looks[variant]))
        axes[0, column].set(title=query, yscale="log")
        axes[0, column].axhline(1, color="#8f8f8f", lw=0.8)
        axes[1, column].set(yscale="log", yticks=[1, 2, 5], yticklabels=["1", "2", "5"],
                            xlabel="motion a frame: radii, degrees")
        axes[1, column].axhline(1, color="#8f8f8f", lw=0.8)
    axes[0, 0].set_ylabel("tests of volumes over a list's\nwith the best rebuilds")
    axes[1, 0].set_ylabel("time over that of the\nfastest strategy")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=4, frameon=False)
    figure.tight_layout(rect=(0, 0.1, 1, 1))
    style.save(figure, out, "best-rebuilds")


def main():
    arguments = record_arguments(__doc__)
    rows = read(arguments.record)
    for measure, text in (("ratio", "N_v over a list's with the best rebuilds"),
                          ("slower", "time over the fastest strategy's")):
        print(text)
        table = rows.pivot_table(index=["query", "volume", "motion"], columns="strategy", values=measure,
                                 sort=False)
        print(table.round(2).to_string())
    draw(rows, arguments.out)


if __name__ == "__main__":
    main()
