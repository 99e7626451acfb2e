# SPDX-License-Identifier: BSD-3-Clause
"""Records of boxes-fast, -fast-large and -million as a table of ratios and one figure: ours beside the best peer.

usage: plots/script boxes-fast RECORD [RECORD ...] [--out FOLDER]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from bvlab_plots import records, style
from bvlab_plots.words import number

SCRATCH = "from scratch"
WORK = {"still": "nothing moves", "drift": "all move 2% of their size", "teleport": "teleports"}


def read(folders):
    rows = pd.concat([records.read(folder, needs=["method", "set", "motion", "threads"]) for folder in folders])
    rows["theirs"] = rows.peer != ""
    wrong = records.wrong_answers(rows)
    records.say_left_out(rows[wrong].method + " on " + rows[wrong].set, "where their pairs differ")
    rows = rows[~wrong]
    records.say_left_out(set(rows.threads) - {1}, "runs on other numbers of threads")
    return rows[rows.threads == 1]


def table(rows):
    """One line per (boxes, set, work) and method of ours: its time, the best peer's, its name, the ratio."""
    keys = ["count", "set", "motion", "method", "theirs", "coherent"]
    middle = rows.groupby(keys, sort=False, as_index=False).agg(
        boxes=("boxes", "first"), time=("frame_ns", "median"), first=("first_ns", "median"),
        pairs=("overlaps", "median"))
    lines = []
    for (count, name), group in middle.groupby(["count", "set"], sort=False):
        for work in [SCRATCH, *dict.fromkeys([*WORK, *group.motion])]:
            here = group[group.motion == ("drift" if work == SCRATCH else work)]
            ours = here[~here.theirs & (here.coherent == ("off" if work == SCRATCH else "on"))]
            peers = here[here.theirs].copy()
            if work == SCRATCH:
                # What a peer that keeps something needs for a first frame, too, is from scratch.
                static = peers.method.str.startswith("cgal")
                peers["time"] = np.minimum(peers["time"].where(static, np.inf), peers["first"])
            if peers.empty:
                continue
            best = peers.loc[peers.time.idxmin()]
            lines += [dict(count=count, set=name, work=work, method=mine.method, boxes=int(mine.boxes),
                           pairs=int(mine.pairs), ours_ms=mine.time / 1e6, peer_ms=best.time / 1e6,
                           peer=best.method, ratio=best.time / mine.time) for mine in ours.itertuples()]
    return pd.DataFrame(lines)


def draw(lines, out, name):
    panels = sorted(set(zip(lines["count"], lines.method)), key=lambda panel: (panel[0], panel[1] != "blocks", panel))
    looks = style.looks(lines.work)
    figure, axes = plt.subplots(1, len(panels), figsize=(1.2 + 2.6 * len(panels), 3.4), sharex=True, squeeze=False)
    for axis, (count, method) in zip(axes[0], panels):
        here = lines[(lines["count"] == count) & (lines.method == method)]
        sets = list(dict.fromkeys(here.set))[::-1]
        for work, look in looks.items():
            some = here[here.work == work].set_index("set").reindex(sets)
            axis.plot(some.ratio, range(len(sets)), **style.marker_style(look), markersize=5,
                      label=WORK.get(work, work))
        axis.set_yticks(range(len(sets)), sets)
        axis.set_xscale("log")
        axis.axvline(1, color="#8f8f8f", linewidth=0.8)
        axis.set_title(f"{method}, {number(count)} boxes")
        axis.set_xlabel("times as fast as the best peer")
    figure.tight_layout()
    style.legend_below(figure, *axes[0, 0].get_legend_handles_labels())
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

