#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A record of boxes against number, displacement or changes as figures, and what was published beside it.

usage: boxes_time.py RECORD [--out FOLDER]

Displacements vary: processor time of a frame against displacement, one panel per set; where a line leaves the
grey one, the method's own time from scratch, it has broken even. Changes are reported: time against how many.
Otherwise: time against the number of boxes with fitted exponents, hollow markers from scratch, and memory.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import records
import style

# The order of legends; what is not in it comes after.
FIRST = ["blocks", "hybrid", "hash", "sweep1", "sweep2", "sweep3", "sweep4"]


def looks_of(rows):
    """Keywords for plot, for every method there is."""
    present = set(rows.method)
    looks = style.looks([m for m in FIRST if m in present] + [m for m in dict.fromkeys(rows.method) if m not in FIRST])
    return {method: style.point_style(look) for method, look in looks.items()}


def read(folder):
    """Medians over repetitions; variants whose pairs differ from the reference are refused."""
    path = next(Path(folder).glob("boxes-*.csv"))
    rows = records.table(path)
    # Other libraries have no mode from scratch: they stand beside both.
    rows["theirs"] = rows.method.isin(records.box_peers(folder))
    slow = rows.frame_ns <= 0
    records.say_left_out(rows[slow].method + " on " + rows[slow].boxes.astype(str),
                         "which took too long for a second frame")
    rows = rows[~slow]
    if rows.motion.nunique() > 1 and rows.changes.nunique() == 1:
        rows["set"] += ", " + rows.motion
    wrong = sorted(set(rows[rows.differing > 0].method))
    if wrong:
        print("refused, since their pairs differ:", ", ".join(wrong))
        rows = rows[~rows.method.isin(wrong)]
    keys = ["set", "boxes", "motion", "displacement", "method", "theirs", "coherent", "changes"]
    return path.stem, rows.groupby(keys, sort=False).agg(
        time=("frame_ns", "median"), bytes=("bytes", "median"), events=("events", "median"),
        pairs=("overlaps", "median")).reset_index()


def exponent(group):
    """Slope of log time over log number, over the larger half of the numbers."""
    upper = group[group.boxes >= group.boxes.median()]
    return np.polyfit(np.log(upper.boxes), np.log(upper.time), 1)[0] if len(upper) > 1 else None


def against_number(name, rows, out):
    both = rows[~rows.theirs].coherent.nunique() > 1
    sets = list(dict.fromkeys(rows.set))
    panels = [(s, c) for s in sets for c in (("off", "on") if both else ("off",))]
    figure, axes = plt.subplots(1, len(panels), figsize=(1 + 3.3 * len(panels), 3.4), sharey=True, squeeze=False)
    looks = looks_of(rows)
    for axis, (set_name, coherent) in zip(axes[0], panels):
        here = rows[rows.set == set_name]
        for method, look in looks.items():
            group = here[(here.method == method) & ((here.coherent == coherent) | here.theirs)]
            group = group.sort_values("boxes")
            if group.empty:
                continue
            slope = exponent(group)
            text = method + (f"  $n^{{{slope:.2f}}}$" if slope is not None else "")
            axis.plot(group.boxes, group.time / 1e6, label=text, markersize=4, linewidth=1.1, **look)
        kind = "" if not both else ", coherent" if coherent == "on" else ", from scratch"
        axis.set(xscale="log", yscale="log", xlabel="boxes", title=set_name + kind)
        axis.legend(frameon=False, fontsize=6.5, loc="upper left", labelspacing=0.25)
    axes[0, 0].set_ylabel("ms of processor time a frame")
    figure.tight_layout()
    print(style.save(figure, out, name))
    memory_against_number(name, rows, sets, out)


def memory_against_number(name, rows, sets, out):
    """Divided by boxes and pairs together: flat is O(n + k)."""
    figure, axes = plt.subplots(1, len(sets), figsize=(2.2 + 3 * len(sets), 3), sharey=True, squeeze=False)
    for axis, set_name in zip(axes[0], sets):
        here = rows[rows.set == set_name]
        for method, look in looks_of(rows).items():
            for coherent in ("off", "on"):
                group = here[(here.method == method) & (here.coherent == coherent)].sort_values("boxes")
                fresh = here[(here.method == method) & (here.coherent == "off")].sort_values("boxes")
                # The seed's methods hold the same either way.
                if group.empty or coherent == "on" and group.bytes.tolist() == fresh.bytes.tolist():
                    continue
                kept = coherent == "on" and not fresh.empty
                axis.plot(group.boxes, group.bytes / (group.boxes + group.pairs), markersize=4, linewidth=1.1,
                          label=method + (", coherent" if kept else ""), **look,
                          **(dict(markerfacecolor="white") if kept else {}))
        axis.set(xscale="log", xlabel="boxes", title=set_name, ylim=(0, None))
    axes[0, 0].set_ylabel("bytes held, a box or pair")
    axes[0, -1].legend(frameon=False, fontsize=7, loc="center left", bbox_to_anchor=(1.0, 0.5))
    figure.tight_layout()
    print(style.save(figure, out, name + "-memory"))


def conclusions(rows):
    """Who wins where, and what coherence saves each method, at the largest number all were run on."""
    for set_name, here in rows.groupby("set", sort=False):
        seed = ["hybrid", "hash", "sweep1", "sweep2", "sweep3", "sweep4"]
        mine = here[here.method.isin(seed)]
        for boxes in sorted(mine.boxes.unique()):
            order = mine[(mine.boxes == boxes) & (mine.coherent == "off")].sort_values("time")
            print(f"{set_name}, {boxes} boxes, from scratch: " +
                  " < ".join(f"{m} {t / 1e6:.3g} ms" for m, t in zip(order.method, order.time)))
            pairs = mine[mine.boxes == boxes].pivot_table(index="method", columns="coherent", values="time")
            if "on" in pairs:
                saved = 100 * (1 - pairs["on"] / pairs["off"]).dropna()
                print("   saved by coherence: " + ", ".join(f"{m} {s:.0f}%" for m, s in saved.items()))


def against_displacement(name, rows, out):
    sets = list(dict.fromkeys(rows.set))
    figure, axes = plt.subplots(1, len(sets), figsize=(1 + 2.5 * len(sets), 3.4), squeeze=False)
    least = rows[rows.displacement > 0].displacement.min()
    for axis, set_name in zip(axes[0], sets):
        here = rows[rows.set == set_name]
        scratch = here[(here.coherent == "off") & (here.method == "blocks")].sort_values("displacement")
        place = lambda group: group.displacement.where(group.displacement > 0, least / 10)
        axis.plot(place(scratch), scratch.time / 1e6, color="#bbbbbb", linewidth=4, label="blocks, from scratch")
        for method, look in looks_of(rows).items():
            group = here[(here.method == method) & (here.coherent == "on")].sort_values("displacement")
            if not group.empty:
                axis.plot(place(group), group.time / 1e6, label=method, markersize=3.5, linewidth=1.1, **look)
        axis.set(xscale="log", yscale="log", title=set_name)
        axis.set_xticks([least / 10, 1e-4, 1e-2, 1], ["none", "$10^{-4}$", "1%", "100%"])
        axis.minorticks_off()
    axes[0, 0].set_ylabel("ms of processor time a frame")
    figure.supxlabel("displacement a frame, of a box's size", fontsize=9)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncol=5, frameon=False, bbox_to_anchor=(0.5, -0.13))
    figure.tight_layout()
    print(style.save(figure, out, name))
    print("coherent over the best of its own from scratch:")
    wide = rows[rows.method == "blocks"].pivot(index=["set", "displacement"], columns="coherent", values="time")
    print((wide["on"] / wide["off"]).unstack(0).round(2).to_string())


def against_changes(name, rows, out):
    figure, axes = plt.subplots(figsize=(4.6, 3.4))
    says = {"part": "one box in a hundred moves", "drift": "all move"}
    wide = rows[rows.changes.eq("on").groupby(rows.method).transform("any")].copy()
    records.say_left_out(set(rows.method) - set(wide.method), "which report no changes")
    several = wide.method.nunique() > 1
    wide["shape"] = wide.method + ", " + wide.motion if several else wide.motion
    sets, shapes = style.looks(wide.set), style.looks(wide["shape"])
    for (shape, set_name, method, motion), group in wide.groupby(["shape", "set", "method", "motion"], sort=False):
        on = group[group.changes == "on"].sort_values("events")
        look = dict(style.point_style(shapes[shape]), color=sets[set_name]["color"])
        axes.plot(on.events.clip(lower=1), on.time / 1e3, **look, markersize=4, linewidth=1.1,
                  label=(method + ", " if several else "") + f"{set_name}, {says.get(motion, motion)}")
    axes.set(xscale="log", yscale="log", xlabel="pairs that began or ended, a frame",
             ylabel="µs of processor time a frame",
             title="changes reported" if several else f"{wide.method.iloc[0]}, changes reported")
    axes.legend(frameon=False, fontsize=7)
    figure.tight_layout()
    print(style.save(figure, out, name))
    table = wide.pivot(index=["method", "set", "motion", "displacement"], columns="changes", values=["time", "events"])
    print((table / 1).round(0).to_string())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("record", type=Path)
    parser.add_argument("--out", type=Path, help="folder for the figures (default: RECORD/figures)")
    arguments = parser.parse_args()
    name, rows = read(arguments.record)
    out = arguments.out or arguments.record / "figures"
    if rows.changes.nunique() > 1:
        against_changes(name, rows, out)
    elif rows.displacement.nunique() > 2:
        against_displacement(name, rows, out)
    else:
        conclusions(rows)
        against_number(name, rows, out)


if __name__ == "__main__":
    main()
