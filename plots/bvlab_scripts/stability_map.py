# SPDX-License-Identifier: BSD-3-Clause
"""A stability record as a picture: false answers of each volume (the worst of
its strategies) at each precision, and of each peer, under each stressor and level.

usage: plots/script stability-map RECORD [--out FOLDER]

Volumes, and peers, that are wrong in the same way everywhere stand on one line.
"""

import textwrap

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm

from bvlab_plots import records, style
from bvlab_plots.arguments import record_arguments
from bvlab_plots.words import number


def read(record):
    rows = records.read(record, needs=["stressor", "false_positives", "false_negatives"])
    rows["wrong"] = rows.false_positives + rows.false_negatives
    return rows


def lines_of(rows, columns):
    """For each precision of ours, and for peers: names, and the share of false answers under each stressor."""
    lines = {}
    for row, group in rows.groupby(["peer", "precision", "volume"], sort=False):
        worst = (group.wrong / group.answers.where(group.answers > 0)).groupby([group.stressor, group.level]).max()
        share = tuple(round(100 * worst.get(column, np.nan), 3) for column in columns)
        lines.setdefault((row[1] if not row[0] else "peers", str(share)), (share, []))[1].append(row[0] or row[2])
    kinds = list(dict.fromkeys(kind for kind, _ in lines))
    return sorted(((kind, names, share) for (kind, _), (share, names) in lines.items()),
                  key=lambda line: (line[0] == "peers", kinds.index(line[0])))


def label_of(kind, names, volumes):
    if kind == "peers":
        return textwrap.fill(", ".join(names), 34)
    return kind if len(names) == volumes else textwrap.fill(f"{kind}: {', '.join(names)}", 34)


def draw(rows, out):
    cases = rows[["stressor", "level"]].drop_duplicates()
    columns = [case for stressor in dict.fromkeys(cases.stressor) for case in
               cases[cases.stressor == stressor].itertuples(index=False, name=None)]
    lines = lines_of(rows, columns)
    cells = np.array([share for _, _, share in lines], float)
    labels = [label_of(kind, names, rows[rows.peer == ""].volume.nunique()) for kind, names, _ in lines]
    heights = [1 + 0.6 * label.count("\n") for label in labels]
    edges = np.concatenate([[0], np.cumsum(heights)])
    figure, axis = plt.subplots(figsize=(7.2, 0.2 * edges[-1] + 1))
    shades = plt.get_cmap("YlOrRd").copy()
    shades.set_bad("#cccccc")
    shown = np.ma.masked_where(np.isnan(cells), np.maximum(cells, 1e-9))
    shades.set_under("white")
    image = axis.pcolormesh(np.arange(len(columns) + 1), edges, shown, cmap=shades, norm=LogNorm(0.5, 100))
    for (y, x), share in np.ndenumerate(cells):
        text = "–" if np.isnan(share) else "" if share == 0 else f"{share:.0f}" if share >= 0.95 else "<1"
        axis.text(x + 0.5, (edges[y] + edges[y + 1]) / 2, text, ha="center", va="center", fontsize=4.6,
                  color="white" if share > 24 else "black")
    axis.set_yticks((edges[1:] + edges[:-1]) / 2, labels, fontsize=6)
    axis.set_xticks(np.arange(len(columns)) + 0.5, [number(level) for _, level in columns], fontsize=5.5, rotation=90)
    for place, (stressor, _) in enumerate(columns):
        if place == 0 or columns[place - 1][0] != stressor:
            axis.axvline(place, color="#8f8f8f", linewidth=0.7)
            axis.text(place + 0.2, -0.25, stressor, rotation=35, ha="left", va="bottom", fontsize=7)
    for y, (kind, _, _) in enumerate(lines[1:], 1):
        axis.axhline(edges[y], color="#8f8f8f", linewidth=0.9 if lines[y - 1][0] != kind else 0.2)
    axis.set(ylim=(edges[-1], 0), xlabel="level of the stressor")
    axis.grid(False)
    axis.tick_params(length=0)
    bar = figure.colorbar(image, ax=axis, fraction=0.02, pad=0.01, ticks=[1, 10, 100], format="%g %%")
    bar.set_label(f"false answers of {rows.answers.max()}; white: none, grey: no answer", fontsize=6.5)
    bar.ax.tick_params(labelsize=6)
    bar.minorticks_off()
    return style.save(figure, out, rows.attrs["name"])


def main():
    arguments = record_arguments(__doc__)
    print(draw(read(arguments.record), arguments.out))

