# SPDX-License-Identifier: BSD-3-Clause
"""Figures as wide as a column, in letters of the size in which they are printed."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import NullLocator

from bvlab_plots import style
from bvlab_plots.words import number

COLUMN = 3.3  # inches
PAGE = 6.85
LETTERS = {
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.labelsize": 8,
    "legend.fontsize": 8,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "lines.linewidth": 0.9,
    "lines.markersize": 2.8,
    "axes.linewidth": 0.6,
    "grid.linewidth": 0.4,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
}


def panels(count, height, width=COLUMN, **keywords):
    """A figure and its panels, beside each other."""
    plt.rcParams.update(LETTERS)  # in place of those that style sets for wider figures
    figure, axes = plt.subplots(1, count, figsize=(width, height), squeeze=False, layout="constrained", **keywords)
    return figure, list(axes[0])


def across(figure, label):
    """One label under all panels."""
    figure.supxlabel(label, fontsize=LETTERS["axes.labelsize"])


def finish(figure, axes, out, name):
    handles, labels = style.labelled(axes)
    if len(labels) > 1:
        style.legend_below(figure, handles, labels)
    return style.save(figure, out, name)


def log_axis(axis, values, letters="y"):
    """Ticks at 1 and 3 of each decade, written as numbers."""
    low, high = np.floor(np.log10(min(values))), np.ceil(np.log10(max(values)))
    step = 1 if high - low < 5 else 2
    ticks = [f * 10.0**e for e in np.arange(low, high + 1, step) for f in ((1,) if high - low > 3 else (1, 3))]
    ticks = [t for t in ticks if 0.7 * min(values) <= t <= 1.5 * max(values)]
    for letter in letters:
        of = getattr(axis, f"{letter}axis")
        getattr(axis, f"set_{letter}scale")("log")
        of.set_ticks(ticks, [number(t) for t in ticks])
        of.set_minor_locator(NullLocator())


def lines(axis, table, looks, names=None):
    """A line for each column of a frame, at its index' places one after the other."""
    places = range(len(table))
    for column in table:
        axis.plot(places, table[column], label=(names or {}).get(column, column), **style.point_style(looks[column]))
    axis.set_xticks(places, [value if isinstance(value, str) else number(value) for value in table.index])
