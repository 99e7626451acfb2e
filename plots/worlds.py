#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A record of whole scenes as a table of ratios (printed) and a figure: time of a frame against the
share of bodies that move, ours beside other libraries' complete pipelines.

usage: worlds.py RECORD [--out FOLDER] [--table-only]
"""

from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

import records
import style
from arguments import record_arguments

SCENE = ["objects", "room", "step", "degrees", "moving"]
PEERS = {"fcl-world": "FCL", "bullet-world": "Bullet"}


def read(record):
    """Median milliseconds of a frame, the first one left out; one row per scene and variant."""
    (table,) = Path(record).glob("worlds*.csv")
    rows = records.table(table)
    rows["variant"] = rows.peer.where(rows.peer != "", rows.volume + " " + rows.strategy)
    rows["ms"] = rows.time_ns / 1e6 / (rows.frames - 1)
    ours = rows[rows.peer == ""]
    if (ours.differing != 0).any():
        raise SystemExit("one of our answers differs from the reference: refused")
    return rows.groupby(SCENE + ["variant", "peer"], sort=False).agg(
        ms=("ms", "median"), least=("ms", "min"), most=("ms", "max"), frames=("frames", "first"),
        differing=("differing", "first"), touching=("touching", "first"), asked=("asked", "first"),
        near=("near", "first")).reset_index()


def ratios(rows):
    """Per scene: our best, each peer's time over it, and how many of the peer's answers differ."""
    table = []
    for scene, group in rows.groupby(SCENE, sort=False):
        ours = group[group.peer == ""].nsmallest(1, "ms").iloc[0]
        entry = dict(zip(SCENE, scene), best=ours.variant, ms=ours.ms,
                     touching=ours.touching / (ours.frames - 1), near=ours.near / (ours.frames - 1))
        for peer, theirs in group[group.peer != ""].groupby("peer", sort=False):
            name = PEERS.get(peer, peer)
            if len(theirs):
                entry[name] = theirs.ms.iloc[0] / ours.ms
                entry[f"{name} differs"] = int(theirs.differing.iloc[0])
        table.append(entry)
    return pd.DataFrame(table)


def print_table(rows):
    table = ratios(rows)
    print("Milliseconds of a frame for the best of ours, and how many times as long others take:")
    with pd.option_context("display.width", 200, "display.max_columns", 20):
        print(table.to_string(index=False, formatters={
            "ms": "{:.4f}".format, **{PEERS.get(p, p): "{:.1f}".format for p in set(rows.peer) - {""}},
            "touching": "{:.0f}".format, "near": "{:.0f}".format}))


def draw(rows, out):
    """One panel per number of bodies and step; the densest workspace."""
    records.say_left_out(set(rows.room) - {rows.room.min()}, "rooms but the densest, of a side of so many radii")
    rows = rows[rows.room == rows.room.min()]
    looks = style.variant_looks(rows.variant)
    objects = list(dict.fromkeys(rows.objects))
    steps = list(dict.fromkeys(zip(rows.step, rows.degrees)))
    figure, axes = plt.subplots(len(steps), len(objects), figsize=(3.7 * len(objects), 2.7 * len(steps)),
                                sharex=True, sharey=True, squeeze=False)
    moving = sorted(set(rows.moving))
    # Nothing moving stands at a place of its own on the logarithmic axis.
    places = {m: m if m > 0 else min(x for x in moving if x > 0) / 10 for m in moving}
    for line, (step, degrees) in zip(axes, steps):
        for axis, count in zip(line, objects):
            panel = rows[(rows.objects == count) & (rows.step == step) & (rows.degrees == degrees)]
            for variant, group in panel.groupby("variant", sort=False):
                group = group.sort_values("moving")
                axis.plot([places[m] for m in group.moving], group.ms, markersize=5, linewidth=1.2,
                          label=PEERS.get(variant, variant), **style.point_style(looks[variant]))
            axis.set(xscale="log", yscale="log")
            axis.set_xticks([places[m] for m in moving],
                            ["none" if m == 0 else f"{100 * m:g}%" for m in moving])
            axis.minorticks_off()
            axis.set_title(f"{count} bunnies; a step of {step:g} radii and {degrees:g}°")
    for axis in axes[-1]:
        axis.set_xlabel("share of the bodies that move")
    for axis in axes[:, 0]:
        axis.set_ylabel("ms per frame")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncol=2 * len(objects) + 1, frameon=False,
                  bbox_to_anchor=(0.5, -0.03 * len(labels) / (len(objects) + 1)))
    figure.tight_layout()
    return style.save(figure, out, "worlds")


def main():
    arguments = record_arguments(__doc__, table_only=True)
    rows = read(arguments.record)
    print_table(rows)
    if not arguments.table_only:
        print(draw(rows, arguments.out))


if __name__ == "__main__":
    main()
