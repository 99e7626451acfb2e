# SPDX-License-Identifier: BSD-3-Clause
"""The paper's figures: as wide as a column, or as the page, in letters of eight points."""

import contextlib
import io

import matplotlib.pyplot as plt
import numpy as np

import column
from bvlab_scripts import fronts
from bvlab_scripts import law
import quoting
from bvlab_plots import records
from bvlab_plots import style
from quotes import tournament


def draw(folder, out):
    """All of them, into `out`."""
    with contextlib.redirect_stdout(io.StringIO()), plt.rc_context(column.LETTERS):
        draw_worth(quoting.record_of("fronts", folder), out)
        draw_strategies(quoting.record_of("coherence", folder), out)
        draw_lead(quoting.record_of("tournament-peers", folder), out)
        draw_displacement(quoting.record_of("boxes-displacement", folder), out)


def draw_worth(record, out):
    """A point for each cell of the study."""
    figure, axes = plt.subplots(2, len(fronts.QUERIES), figsize=(column.PAGE, 3.2), sharex=True, sharey=True, layout="constrained")
    fronts.draw_worth(fronts.read(record), out, figure, axes, "worth")


def draw_strategies(record, out):
    """Medians of what each strategy saves, over the share of the front that is lost."""
    rows = law.read(record)
    strategies = law.strategies_of(rows)
    looks, edges = style.looks(strategies), np.quantile(rows.survival, np.linspace(0, 1, 13))
    figure, axes = column.panels(2, 2.0, sharey=True)
    values = []
    for axis, what in zip(axes, ("tests", "time")):
        for strategy in strategies:
            saved = "time_saved" if what == "time" else "tests_saved" if strategy in law.LISTS else "all_saved"
            group = rows[rows.strategy == strategy]
            bins = group.groupby(np.clip(np.digitize(group.survival, edges), 1, 12))
            middle = bins[[saved]].median().join(bins.survival.median())
            axis.plot(1 - middle.survival, middle[saved], label=strategy, **style.point_style(looks[strategy]))
            values += list(middle[saved])
        axis.axhline(1, color="black", linewidth=0.6)
        axis.set_title(what)
        axis.set_xscale("symlog", linthresh=0.01)
        axis.set_xlim(left=0)
        axis.set_xticks([0, 0.01, 0.1, 1], ["0", "1%", "10%", "all"])
        axis.minorticks_off()
    column.across(figure, "share of the front lost a frame")
    axes[0].set_ylabel("recursive / strategy")
    column.log_axis(axes[0], values)
    column.finish(figure, axes, out, "strategies")


def draw_lead(record, out):
    """How many times as long the fastest library takes, with intervals."""
    found = tournament.beside_all(record)
    figure, (axis,) = column.panels(1, 1.9)
    names = [f"{work}, {polygons}" for work, polygons in found.index]
    places = np.arange(len(found))[::-1]
    axis.errorbar(found.ratio, places, xerr=[found.ratio - found.low, found.high - found.ratio], fmt="o", color="black", capsize=2)
    axis.set_yticks(places, names)
    axis.set_xscale("log")
    axis.set_xticks([1, 2, 5, 10, 20], ["1", "2", "5", "10", "20"])
    axis.minorticks_off()
    axis.axvline(1, color="black", linewidth=0.6)
    axis.set_xlabel("time of the fastest library / ours")
    column.finish(figure, [axis], out, "lead")


def draw_displacement(record, out):
    rows = records.read(record)
    records.wrong_answers(rows)
    rows = rows[(rows.frame_ns > 0) & (rows.method == "blocks")]
    middle = rows.groupby(["set", "displacement", "coherent"], sort=False)[["frame_ns", "p99_ns"]].median().unstack("coherent")
    sets = list(dict.fromkeys(rows.set))
    figure, axes = column.panels(2, 2.0, sharey=True)
    for axis, what, title in zip(axes, ("frame_ns", "p99_ns"), ("mean of frames", "99th percentile")):
        ratio = (middle[what]["on"] / middle[what]["off"]).unstack("displacement")
        column.lines(axis, ratio.loc[sets].T, style.looks(sets))
        axis.set_xticks(range(ratio.shape[1]), [f"{100 * d:g}" for d in ratio.columns], rotation=70)
        axis.axhline(1, color="black", linewidth=0.6)
        axis.set_title(title)
    column.across(figure, "displacement a frame, % of a box's size")
    axes[0].set_ylabel("following / starting over")
    column.log_axis(axes[0], np.array([0.05, 6]))
    column.finish(figure, axes, out, "boxes-displacement")
