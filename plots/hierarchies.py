#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A record of all volumes and strategies beside peers, as tables (printed) and figures: every variant against
the best peer, and the best of ours beside the best of theirs.

usage: hierarchies.py RECORD [--out FOLDER]

Times are those of all frames but the first, which builds what the others use again. Variants with an answer that
differs from the exact one are listed and left out.
"""

import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import matplotlib.pyplot as plt

import records
import style
from arguments import record_arguments

# What may tell one trace from another, where a record has it.
PLACES = ["query", "polygons", "density", "motion"]


def read(record):
    definition = tomllib.loads((Path(record) / "definition.toml").read_text())
    name = definition["name"]
    rows = records.table(Path(record) / f"{name}.csv")
    for column in PLACES:
        if column not in rows:
            rows[column] = ""
    later = (rows.frames - 1) / rows.frames
    rows["us"] = (rows.time_ns - rows.first_ns) / (rows.pairs * later) / 1e3
    rows["ours"] = rows.peer == ""
    # Timed in random order; shown in the definition's.
    for axis in reversed(definition["axis"]):
        labels = axis.get("values") or [value["name"] for value in axis["value"]]
        place = {str(label): i for i, label in enumerate(labels)}
        rows = rows.sort_values(axis["name"], key=lambda c: c.map(lambda v: place.get(str(v), -1)), kind="stable")
    rows = rows.reset_index(drop=True)
    rows["variant"] = np.where(rows.ours, rows.volume + " " + rows.strategy, rows.peer)
    return name, rows


def without_wrong(rows):
    wrong = rows[rows.differing != 0]
    for (query, variant), group in wrong.groupby(["query", "variant"]):
        cells = group.drop_duplicates(PLACES)
        print(f"{variant}, {query}: {cells.differing.sum()} answers differ in {len(cells)} cells; left out there")
    return rows[rows.differing == 0]


def medians(rows):
    keys = PLACES + ["ours", "variant", "volume", "strategy"]
    return rows.groupby(keys, sort=False).us.median().reset_index()


def best(middle):
    """One row a cell: the best of ours, of ours without coherence, and of the peers."""
    def of(part, name):
        part = part.loc[part.groupby(PLACES, sort=False).us.idxmin()]
        return part.set_index(PLACES)[["variant", "us"]].add_prefix(name + " ")
    ours = middle[middle.ours]
    table = pd.concat([of(ours[ours.strategy == "recursive"], "recursive"), of(ours, "best"),
                       of(middle[~middle.ours], "peer")], axis=1).dropna()
    table["recursive: times faster"] = table["peer us"] / table["recursive us"]
    table["best: times faster"] = table["peer us"] / table["best us"]
    return table


def panel_name(query, polygons):
    return f"{query}, {polygons} polygons" if str(polygons) else query


def draw_best(table, out, name):
    panels = list(table.groupby(level=["query", "polygons"], sort=False))
    lines = int(np.ceil(len(panels) / 2))
    figure, axes = plt.subplots(lines, 2, figsize=(7.4, 2.9 * lines), squeeze=False)
    series = [("peer", "best of the peers", "fcl-obb"), ("recursive", "best of ours, recursive", "recursive"),
              ("best", "best of ours", "separation-list")]
    for axis, (key, group) in zip(axes.flat, panels):
        for k, (column, label, look) in enumerate(series):
            axis.bar(np.arange(len(group)) + (k - 1) * 0.27, group[column + " us"], 0.27, label=label,
                     **style.bar_style(style.looks([look])[look]))
        for place, (_, row) in enumerate(group.iterrows()):
            axis.text(place + 0.27, row["best us"], f"{row['best: times faster']:.1f}×", ha="center", va="bottom",
                      fontsize=6, bbox=dict(facecolor="white", edgecolor="none", pad=0.5, alpha=0.85))
        axis.set_yscale("log")
        axis.set_ylim(group[["peer us", "recursive us", "best us"]].min().min() / 2)
        axis.set_title(panel_name(*key))
        axis.set_xticks(range(len(group)), [f"{d}; {m}" for _, _, d, m in group.index], fontsize=6, rotation=35,
                        ha="right", rotation_mode="anchor")
        axis.grid(axis="x", visible=False)
    for axis in axes[:, 0]:
        axis.set_ylabel("µs per pair and frame")
    for axis in axes.flat[len(panels):]:
        axis.remove()
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.tight_layout()
    figure.legend(handles, labels, loc="upper center", ncol=3, frameon=False, bbox_to_anchor=(0.5, 0.0))
    return style.save(figure, out, name + "-best")


def draw_variants(middle, out, name):
    """Bars: the median over scenes and motions of time against the best peer's there, with quartiles."""
    theirs = middle[~middle.ours].groupby(PLACES, sort=False).us.min().rename("theirs")
    ours = middle[middle.ours].join(theirs, on=PLACES).dropna(subset="theirs")
    ours = ours.assign(ratio=ours.us / ours.theirs)
    volumes, strategies = (list(dict.fromkeys(ours[c])) for c in ("volume", "strategy"))
    panels = list(ours.groupby(["query", "polygons"], sort=False))
    lines = int(np.ceil(len(panels) / 2))
    figure, axes = plt.subplots(lines, 2, figsize=(7.4, 2.4 * lines), squeeze=False)
    width = 0.8 / len(strategies)
    looks = style.looks(strategies)
    for axis, (key, group) in zip(axes.flat, panels):
        for k, strategy in enumerate(strategies):
            quartiles = np.array([group[(group.volume == v) & (group.strategy == strategy)]
                                  .ratio.quantile([0.25, 0.5, 0.75]) for v in volumes])
            axis.bar(np.arange(len(volumes)) + (k - (len(strategies) - 1) / 2) * width, quartiles[:, 1], width,
                     yerr=[quartiles[:, 1] - quartiles[:, 0], quartiles[:, 2] - quartiles[:, 1]],
                     error_kw=dict(elinewidth=0.7), label=strategy, **style.bar_style(looks[strategy]))
        axis.axhline(1, color="#7a5195", linewidth=0.8)
        axis.set_yscale("log")
        axis.set_ylim(group.ratio.min() / 2)
        axis.set_title(panel_name(*key))
        axis.set_xticks(range(len(volumes)), volumes, fontsize=7, rotation=35, ha="right", rotation_mode="anchor")
        axis.grid(axis="x", visible=False)
    for axis in axes[:, 0]:
        axis.set_ylabel("time / best peer's")
    for axis in axes.flat[len(panels):]:
        axis.remove()
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.tight_layout()
    figure.legend(handles, labels, loc="upper center", ncol=len(strategies), frameon=False,
                  bbox_to_anchor=(0.5, 0.0))
    return style.save(figure, out, name + "-variants")


def print_tests(rows):
    """Volume tests of those that count, per pair and frame."""
    counted = rows[rows.n_v.notna()].drop_duplicates(PLACES + ["variant"])
    counted = counted.assign(n_v=counted.n_v / counted.pairs, n_p=counted.n_p / counted.pairs)
    print(counted.pivot_table(index="variant", columns=["query", "polygons"], values=["n_v", "n_p"], sort=False)
          .round(1).to_string())


def main():
    arguments = record_arguments(__doc__)
    name, rows = read(arguments.record)
    rows = without_wrong(rows)
    middle = medians(rows)
    table = best(middle)
    with pd.option_context("display.width", 250, "display.max_columns", 40, "display.max_rows", 500):
        print("Median microseconds per pair and frame, without the first frame:")
        print(middle.pivot_table(index=PLACES, columns="variant", values="us", sort=False).round(2).T.to_string())
        print("\nBest of ours against best of the peers:")
        print(table.round(2).to_string())
        print("\nVolume and triangle tests per pair and frame, mean over scenes and motions:")
        print_tests(rows)
    out = arguments.out
    print(draw_best(table, out, name))
    print(draw_variants(middle, out, name))


if __name__ == "__main__":
    main()
