# SPDX-License-Identifier: BSD-3-Clause
"""How coherence relates to speedup, by a record of a definition that measures coherence: two figures.

usage: plots/script coherence RECORD [--out FOLDER]

Figures: coherence-speedup (tests saved by each strategy against survival), coherence-law (predicted
against measured, with residuals, fitted and left out apart).

The law is that of law.py.
"""

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from bvlab_scripts import law
from bvlab_plots import style
from bvlab_plots.arguments import record_arguments
from bvlab_plots.ticks import log_ticks, name_log_ticks


def share_axis(axis, ticks, texts):
    """A share, from nothing on, where little matters most."""
    axis.set_xscale("symlog", linthresh=ticks[1])
    axis.set_xlim(left=0)
    axis.set_xticks(ticks, texts)
    axis.minorticks_off()


def draw_speedup(rows, out):
    """Speedup against survival, a panel per strategy, tests above and time below."""
    strategies, looks = law.strategies_of(rows), style.looks(rows.volume)
    figure, axes = plt.subplots(2, len(strategies), figsize=(2.1 * len(strategies) + 0.6, 4.6),
                                sharex=True, sharey="row", squeeze=False)
    edges = np.quantile(rows.survival, np.linspace(0, 1, 13))
    for column, strategy in zip(axes.T, strategies):
        group = rows[rows.strategy == strategy]
        for axis, what in zip(column, ("all_saved" if strategy not in law.LISTS else "tests_saved", "time_saved")):
            for volume, part in group.groupby("volume", sort=False):
                look = looks[volume]
                axis.plot(1 - part.survival, part[what], linestyle="none", marker=look["marker"],
                          color=look["color"], markersize=2.5, alpha=0.5, label=volume)
            bins = group.groupby(np.clip(np.digitize(group.survival, edges), 1, 12))
            middle = bins[[what]].median().join(bins.survival.median())
            axis.plot(1 - middle.survival, middle[what], color="black", linewidth=1.6, label="median")
            axis.axhline(1, color="black", linewidth=0.8)
            axis.set_yscale("log")
        column[0].set_title(strategy)
        column[1].set_xlabel("share of the front lost per frame")
        share_axis(column[1], [0, 0.01, 0.1, 1], ["0", "1%", "10%", "all"])
    axes[0, 0].set_ylabel("tests, recursive / strategy")
    axes[1, 0].set_ylabel("time, recursive / strategy")
    for line in axes:
        name_log_ticks(line[0].yaxis)
    figure.tight_layout()
    style.legend_below(figure, *axes[0, 0].get_legend_handles_labels())
    return style.save(figure, out, "coherence-speedup")


def draw_law(rows, kappa, out):
    """Predicted against measured, and residuals against survival."""
    rows = rows[rows.strategy.isin(law.LISTS)].copy()
    rows["predicted"] = law.predicted(rows, kappa)
    seen = law.fitted(rows)
    figure, axes = plt.subplots(1, 3, figsize=(9.2, 3.1))
    both = rows[["predicted", "tests_saved"]]
    low, high = 0.8 * both.min().min(), 1.25 * both.max().max()
    for name in law.LISTS:
        look = style.looks(law.LISTS)[name]
        for part, fill, label in ((seen, look["color"], "fitted"), (~seen, "none", "left out")):
            group = rows[(rows.strategy == name) & part]
            drawn = dict(linestyle="none", marker=look["marker"], markersize=3.5, markeredgecolor=look["color"],
                         markerfacecolor=fill, markeredgewidth=0.7)
            if len(group):
                axes[0].plot(group.predicted, group.tests_saved, label=f"{name}, {label}", **drawn)
                axes[1].plot(1 - group.survival, group.predicted / group.tests_saved, **drawn)
    axes[0].plot([low, high], [low, high], color="black", linewidth=0.8)
    axes[0].set(xlabel="speedup in tests, by the law", ylabel="measured", xlim=(low, high), ylim=(low, high),
                xscale="log", yscale="log")
    for axis in (axes[0].xaxis, axes[0].yaxis):
        name_log_ticks(axis, log_ticks(low, high))
    axes[0].legend(frameon=False, fontsize=7)
    axes[1].axhline(1, color="black", linewidth=0.8)
    axes[1].set(xlabel="share of the front lost per frame", ylabel="law / measured", yscale="log")
    name_log_ticks(axes[1].yaxis)
    share_axis(axes[1], [0, 0.01, 0.1, 1], ["0", "1%", "10%", "all"])
    draw_curve(axes[2], kappa)
    figure.tight_layout()
    return style.save(figure, out, "coherence-law")


def draw_curve(axis, kappa):
    """What the law says of a pair with 100 ends, of which a run opens more and more."""
    opened = np.concatenate([[0], np.geomspace(1e-3, 0.3, 60)])
    ends, frames = 100, 1000
    model = pd.DataFrame({"near_runs": 1, "tests": 2 * ends - 1, "entries": ends, "grown": opened * ends,
                          "stillness": np.exp(-opened * ends), "frames": frames, "growth": opened, "persistence": 0.0,
                          "again": ends * (1 + 2 * opened)})
    for name, defer in law.LISTS.items():
        axis.plot(opened, 1 / law.list_over_recursion(model, defer, kappa), linewidth=1.5, label=name,
                  **style.line_style(style.looks(law.LISTS)[name]))
    axis.axhline(1, color="black", linewidth=0.8)
    axis.axhline(2, color="black", linewidth=0.8, linestyle=":")
    share_axis(axis, [0, 1e-3, 1e-2, 1e-1], ["0", "0.1%", "1%", "10%"])
    axis.set(xlabel="ends opened per frame, of 100", ylabel="speedup in tests, by the law")
    axis.legend(frameon=False, fontsize=7)


def main():
    arguments = record_arguments(__doc__)
    rows = law.read(arguments.record)
    kappa = law.fit_kappa(rows)
    print(f"The law's kappa = {kappa:.2f}; error of the predicted speedup, median and 95 %:")
    for label, (middle, most, count) in law.errors(rows, kappa).items():
        print(f"  {label:9} {100 * middle:5.1f} %  {100 * most:5.1f} %   of {count} cells")
    print(draw_speedup(rows, arguments.out))
    print(draw_law(rows, kappa, arguments.out))
