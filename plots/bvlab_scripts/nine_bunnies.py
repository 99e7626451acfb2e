# SPDX-License-Identifier: BSD-3-Clause
"""The nine-bunnies record as the talk's table (printed) and as figures.

usage: plots/script nine-bunnies RECORD [--out FOLDER] [--table-only]

Figures: nine-bunnies-table (speedup of both lists by reading and density beside the published one),
nine-bunnies-runs (the talk's ten runs).
"""

import numpy as np
import pandas as pd
import matplotlib.pyplot as plt

from bvlab_plots import records, style
from bvlab_plots.arguments import record_arguments

# Li and Chen's table (li1998incremental): seconds for the recursive algorithm, the separation list
# and the deferred one, runs 1 to 10.
PUBLISHED = pd.DataFrame(
    [(1507.9, 1075.7, 759.2), (1744, 1252.2, 1021.7), (1552.8, 1077.7, 781.5),
     (1713, 1177.3, 980.1), (1548.4, 1080.5, 808.2), (1653.4, 1168.3, 969.5),
     (1403, 1021.2, 687.5), (1570.5, 1120.2, 831.4), (1564.9, 1163.1, 900.4),
     (1580.5, 1139.2, 865.7)],
    columns=["recursive", "separation-list", "deferred"], index=range(1, 11))
LISTS = ["separation-list", "deferred"]
BASE = "recursive"
SPEEDUPS = PUBLISHED[BASE].mean() / PUBLISHED[LISTS].mean()  # as they were published


def read(record):
    """One row per (reading, density, seed, variant): median time over repetitions, mean counts."""
    rows = records.right(record, needs=["reading", "density"])
    keys = ["reading", "density", "seed", "variant"]
    counts = dict.fromkeys(["pairs", "frames", "hits", "n_u", "n_v", "n_p", "front"], "first")
    return rows.groupby(keys, sort=False).agg({"time_ns": "median"} | counts).reset_index()


def lists_of(runs):
    """The talk's two, then whatever else was run; not what the others are compared with."""
    present = dict.fromkeys(runs.variant)
    return [v for v in dict.fromkeys([*LISTS, *present]) if v in present and v != BASE]


def speedups(runs, what="time_ns"):
    """Recursive over each other variant, one row per (reading, density, seed), one column per variant."""
    wide = runs.pivot_table(index=["reading", "density", "seed"], columns="variant", values=what, sort=False)
    return wide[lists_of(runs)].rdiv(wide[BASE], axis=0)


def mean_speedups(runs, what="time_ns"):
    """Means over seeds: one row per (reading, density)."""
    return speedups(runs, what).groupby(level=["reading", "density"], sort=False).mean()


def percent(ratio):
    return f"{100 * (ratio - 1):+.0f}%"


def print_table(runs):
    published = PUBLISHED.mean()
    print("Published: nine bunnies, K5 at 133 MHz. Average seconds and speedup:")
    print(f"  recursive {published['recursive']:.1f}   list {published['separation-list']:.1f} "
          f"(+40%)   deferred {published['deferred']:.1f} (+84%)\n")
    for (reading, density), group in runs.groupby(["reading", "density"], sort=False):
        touching = group.hits.sum() / group.pairs.sum()
        print(f"{reading}; {density} ({100 * touching:.1f}% of the pairs touch)")
        variants = [BASE, *lists_of(group)]
        print("run  " + ", ".join(variants) + "; N_u, N_v, N_p per pair and frame (front) of each")
        wide = {name: group[group.variant == name].set_index("seed") for name in variants}
        for seed in wide[BASE].index:
            print(table_line(str(seed), {name: wide[name].loc[seed] for name in variants}))
        print(table_line("ave", {name: wide[name].mean(numeric_only=True) for name in variants}), "\n")


def table_line(label, of):
    seconds = {name: of[name].time_ns / 1e9 for name in of}
    counts = [" ".join(f"{row[n] / row.pairs:.1f}" for n in ("n_u", "n_v", "n_p")) +
              ("" if name == "recursive" else f" ({row.front:.0f})") for name, row in of.items()]
    columns = [f"{label:>3}  {seconds['recursive']:8.4f} s"]
    for name in list(of)[1:]:
        columns.append(f"{seconds[name]:8.4f} s {percent(seconds['recursive'] / seconds[name]):>6}")
    return "  ".join(columns) + "   " + " | ".join(counts)


def nearest_reading(runs):
    """The (reading, density) whose two average speedups are nearest to the published ones."""
    average = mean_speedups(runs)
    distance = (np.log(average[LISTS] / SPEEDUPS) ** 2).sum(axis=1)
    return distance.idxmin(), average


def draw_table(runs, out):
    """Speedup by reading and density, in tests and in time: quartiles over the ten runs, published
    values as lines."""
    readings = list(dict.fromkeys(runs.reading))
    densities = list(dict.fromkeys(runs.density))
    figure, axes = plt.subplots(2, len(densities), figsize=(7.2, 0.86 * len(readings) + 1.2),
                                sharex=True, sharey=True, squeeze=False)
    for line, (what, label) in zip(axes, (("n_v", "$N_v$"), ("time_ns", "time"))):
        ratios = speedups(runs, what)
        for axis, density in zip(line, densities):
            draw_speedups(axis, [ratios.loc[(reading, density)] for reading in readings])
            axis.set_title(f"{label}, recursive / list; {density}")
    axes[0, 0].set_yticks(range(len(readings)), readings)
    axes[0, 0].invert_yaxis()
    for axis in axes[1]:
        axis.set_xlabel("speedup over the recursive algorithm")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.tight_layout()
    figure.legend(handles, labels, loc="lower center", ncol=4, frameon=False,
                  bbox_to_anchor=(0.5, -0.05))
    return style.save(figure, out, "nine-bunnies-table")


def draw_speedups(axis, tables):
    names = list(tables[0].columns)
    looks, height = style.looks(names), 0.76 / len(names)
    for k, name in enumerate(names):
        quartiles = np.array([table[name].quantile([0.25, 0.5, 0.75]) for table in tables])
        places = np.arange(len(tables)) + (k - (len(names) - 1) / 2) * height
        axis.barh(places, quartiles[:, 1], height=height - 0.02, label=name, **style.bar_style(looks[name]))
        axis.errorbar(quartiles[:, 1], places, fmt="none", ecolor="black", elinewidth=0.8,
                      xerr=[quartiles[:, 1] - quartiles[:, 0], quartiles[:, 2] - quartiles[:, 1]])
        if name in LISTS:
            axis.axvline(SPEEDUPS[name], linewidth=1.4, label=f"{name}, published time", **style.line_style(looks[name]))
    axis.axvline(1, color="black", linewidth=0.8)
    axis.grid(axis="y", visible=False)


def draw_runs(runs, out):
    """The ten runs of the nearest reading beside the published ten, both as speedups."""
    (reading, density), _ = nearest_reading(runs)
    ratios = speedups(runs).loc[(reading, density)]
    figure, axes = plt.subplots(1, 2, figsize=(7.2, 2.4), sharey=True)
    published = PUBLISHED[LISTS].rdiv(PUBLISHED[BASE], axis=0)
    for axis, table, title in ((axes[0], published, "published"),
                               (axes[1], ratios, f"measured: {reading}; {density}")):
        looks, width = style.looks(table.columns), 0.8 / len(table.columns)
        for k, name in enumerate(table.columns):
            axis.bar(np.arange(len(table)) + (k - (len(looks) - 1) / 2) * width, table[name], width=width - 0.02,
                     label=name, **style.bar_style(looks[name]))
            axis.axhline(table[name].mean(), linewidth=1.2, **style.line_style(looks[name]))
        axis.axhline(1, color="black", linewidth=0.8)
        axis.set_xticks(range(len(table)), table.index)
        axis.set_xlabel("run")
        axis.set_title(title)
        axis.grid(axis="x", visible=False)
    axes[0].set_ylabel("speedup over recursive")
    style.legend_below(figure, *axes[0].get_legend_handles_labels())
    return style.save(figure, out, "nine-bunnies-runs")


def main():
    arguments = record_arguments(__doc__, table_only=True)
    runs = read(arguments.record)
    print_table(runs)
    (reading, density), average = nearest_reading(runs)
    tests = mean_speedups(runs, "n_v")
    print("Average speedups, list and deferred (published: 1.40 and 1.84), in time | in N_v:")
    for (r, d), row in average.iterrows():
        mark = "   <- nearest in time" if (r, d) == (reading, density) else ""
        saved = tests.loc[(r, d)]
        print(f"  {r + '; ' + d:46} {row['separation-list']:.2f}  {row['deferred']:.2f}  |  "
              f"{saved['separation-list']:.2f}  {saved['deferred']:.2f}{mark}")
    if not arguments.table_only:
        print(draw_table(runs, arguments.out))
        print(draw_runs(runs, arguments.out))

