#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Records of boxes-fast, -fast-large and -million as a table of ratios and one figure: ours beside the best peer.

usage: boxes_fast.py RECORD [RECORD ...] [--out FOLDER]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import style

OURS = ["blocks", "auto"]
WORK = {"off": "from scratch", "still": "nothing moves", "drift": "all move 2% of their size", "teleport": "teleports"}
COLOURS = {"off": "#1b1b1b", "drift": "#d95f0e", "still": "#41a5c4", "teleport": "#8f8f8f"}
MARKERS = {"off": "o", "drift": "s", "still": "^", "teleport": "x"}


def read(folders):
    rows = pd.concat([pd.read_csv(next(Path(folder).glob("boxes-*.csv"))) for folder in folders])
    wrong = rows[rows.differing > 0].groupby(["method", "set"]).size()
    for (method, name), count in wrong.items():
        print(f"{method} on {name}: pairs differ in {count} runs; refused")
    rows = rows[rows.differing == 0]
    return rows[rows.threads == 1]


def table(rows):
    """One line per (boxes, set, work): our time, the best peer's, its name, the ratio."""
    keys = ["count", "set", "motion", "method", "coherent"]
    middle = rows.groupby(keys, sort=False).agg(boxes=("boxes", "first"), time=("frame_ns", "median"),
                                                first=("first_ns", "median"), pairs=("overlaps", "median")).reset_index()
    lines = []
    for (count, name), group in middle.groupby(["count", "set"], sort=False):
        for work in WORK:
            motion = "drift" if work == "off" else work
            here = group[group.motion == motion]
            ours = here[(here.method == "blocks") & (here.coherent == ("off" if work == "off" else "on"))]
            peers = here[~here.method.isin(OURS)].copy()
            if work == "off":
                # What a peer that keeps something needs for a first frame, too, is from scratch.
                peers["time"] = np.minimum(peers["time"].where(peers.method == "cgal-1000", np.inf), peers["first"])
            if ours.empty or peers.empty:
                continue
            best = peers.loc[peers.time.idxmin()]
            lines.append(dict(count=count, set=name, work=work, boxes=int(ours.boxes.iloc[0]),
                              pairs=int(ours.pairs.iloc[0]), ours_ms=ours.time.iloc[0] / 1e6,
                              peer_ms=best.time / 1e6, peer=best.method, ratio=best.time / ours.time.iloc[0]))
    return pd.DataFrame(lines)


def draw(lines, out, name):
    counts = sorted(lines["count"].unique())
    figure, axes = plt.subplots(1, len(counts), figsize=(1.2 + 2.6 * len(counts), 3.4), sharex=True, squeeze=False)
    for axis, count in zip(axes[0], counts):
        here = lines[lines["count"] == count]
        sets = list(dict.fromkeys(here.set))[::-1]
        for work in WORK:
            some = here[here.work == work].set_index("set").reindex(sets)
            axis.plot(some.ratio, range(len(sets)), linestyle="none", color=COLOURS[work], marker=MARKERS[work],
                      markersize=5, label=WORK[work])
        axis.set_yticks(range(len(sets)), sets)
        axis.set_xscale("log")
        axis.axvline(1, color="#8f8f8f", linewidth=0.8)
        for target, work in ((8, "off"), (15, "drift")):
            axis.axvline(target, color=COLOURS[work], linewidth=0.7, linestyle=":")
        axis.set_title(f"{count:,} boxes".replace(",", " "))
        axis.set_xlabel("times as fast as the best peer")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncol=4, frameon=False, bbox_to_anchor=(0.5, -0.06))
    figure.tight_layout()
    return style.save(figure, out, name)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("records", type=Path, nargs="+")
    parser.add_argument("--out", type=Path, help="folder for the figure (default: figures of the first record)")
    arguments = parser.parse_args()
    lines = table(read(arguments.records))
    pd.set_option("display.width", 200)
    print(lines.round(3).to_string(index=False))
    print(draw(lines, arguments.out or arguments.records[0] / "figures", "boxes-fast"))


if __name__ == "__main__":
    main()
