#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A stability record as totals (printed) and a picture: false answers of each volume (the worst of
its strategies) at each precision, and of each peer, under each stressor and level.

usage: stability_map.py RECORD [--out FOLDER]
"""

from pathlib import Path

import numpy as np
import pandas as pd
import matplotlib.pyplot as plt
from matplotlib.colors import LogNorm, to_rgba

import style
from arguments import record_arguments


def read(record):
    (table,) = Path(record).glob("*.csv")
    rows = pd.read_csv(table, keep_default_na=False)
    for column in ("false_positives", "false_negatives"):
        rows[column] = pd.to_numeric(rows[column], errors="coerce")
    rows["wrong"] = rows.false_positives + rows.false_negatives
    return rows, table.stem


def print_totals(rows):
    ours = rows[rows.source == "bvlab"]
    per = ours.groupby("precision", sort=False)
    print("Ours: answers, false positives, false negatives, over all volumes and strategies")
    for precision, group in per:
        print(f"  {precision:8s} {group.answers.sum():8d} {group.false_positives.sum():8.0f} "
              f"{group.false_negatives.sum():8.0f}")
    print("Peers: answers, false positives, false negatives, cases without an answer")
    for peer, group in rows[rows.source != "bvlab"].groupby("source", sort=False):
        print(f"  {peer:12s} {group.answers.sum():8d} {group.false_positives.sum():8.0f} "
              f"{group.false_negatives.sum():8.0f} {(group.answers == 0).sum():4d}")


def lines_of(rows):
    """Label and rows of the record for each line of the map."""
    ours = rows[rows.source == "bvlab"]
    for precision in dict.fromkeys(ours.precision):
        for volume in dict.fromkeys(ours.volume):
            yield f"{precision}, {volume}", ours[(ours.precision == precision) &
                                                 (ours.volume == volume)]
    for peer in dict.fromkeys(rows[rows.source != "bvlab"].source):
        yield peer, rows[rows.source == peer]


def draw(rows, out, name):
    columns = list(dict.fromkeys(zip(rows.stressor, rows.level)))
    labels, cells = [], []
    answers = rows.answers.max()
    for label, group in lines_of(rows):
        worst = group.groupby(["stressor", "level"]).wrong.max()
        labels.append(label)
        cells.append([worst.get(column, np.nan) for column in columns])
    cells = np.array(cells)
    figure, axis = plt.subplots(figsize=(7.2, 0.16 * len(labels) + 1.2))
    shades = plt.get_cmap("YlOrRd").copy()
    shades.set_bad("#bbbbbb")
    zero = cells == 0
    image = axis.imshow(np.where(zero, np.nan, cells / answers * 100), cmap=shades, aspect="auto",
                        norm=LogNorm(vmin=0.5, vmax=100))
    green = np.zeros((*cells.shape, 4))
    green[zero] = to_rgba("#dcefd9")
    axis.imshow(green, aspect="auto")
    for y, x in zip(*np.nonzero(cells > 0)):
        axis.text(x, y, f"{cells[y, x]:.0f}", ha="center", va="center", fontsize=3.6,
                  color="white" if cells[y, x] > 0.4 * answers else "black")
    for y, x in zip(*np.nonzero(np.isnan(cells))):
        axis.text(x, y, "–", ha="center", va="center", fontsize=4)
    axis.set_yticks(range(len(labels)), labels, fontsize=5)
    axis.set_xticks(range(len(columns)), [f"{level:g}" for _, level in columns], fontsize=4.5,
                    rotation=90)
    stressors = [stressor for stressor, _ in columns]
    for stressor in dict.fromkeys(stressors):
        places = [i for i, each in enumerate(stressors) if each == stressor]
        axis.axvline(places[0] - 0.5, color="white", linewidth=1.5)
        axis.text(np.mean(places), -0.8, stressor, rotation=35, ha="left", va="bottom", fontsize=6)
    groups = [label.split(",")[0] if "," in label else "peers" for label in labels]
    for y in range(1, len(groups)):
        if groups[y] != groups[y - 1]:
            axis.axhline(y - 0.5, color="white", linewidth=1.5)
    axis.grid(False)
    axis.tick_params(length=0)
    for spine in axis.spines.values():
        spine.set_visible(False)
    bar = figure.colorbar(image, ax=axis, fraction=0.02, pad=0.01)
    bar.set_label(f"% of {answers} answers false; green: none; grey: no answer", fontsize=6)
    bar.ax.tick_params(labelsize=5)
    return style.save(figure, out, name)


def main():
    arguments = record_arguments(__doc__)
    rows, name = read(arguments.record)
    print_totals(rows)
    print(draw(rows, arguments.out, name))


if __name__ == "__main__":
    main()
