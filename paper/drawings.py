# SPDX-License-Identifier: BSD-3-Clause
"""The paper's figures: as wide as a column, or as the page, in letters of eight points."""

import contextlib
import io

import matplotlib.pyplot as plt
import numpy as np

import column
from bvlab_scripts import fan_outs
from bvlab_scripts import law
import quoting
from bvlab_plots import records
from bvlab_plots import style
from quotes import reuse, tournament


def draw(folder, out):
    """All of them, into `out`."""
    with contextlib.redirect_stdout(io.StringIO()), plt.rc_context(column.LETTERS):
        draw_reuse(quoting.record_of("fan-outs", folder), out)
        draw_cycles(quoting.record_of("fan-outs", folder), out)
        draw_strategies(quoting.record_of("coherence", folder), out)
        draw_lead(quoting.record_of("tournament-peers", folder), out)
        draw_displacement(quoting.record_of("boxes-displacement", folder), out)


def draw_reuse(record, out):
    names = ("deferred", "raise", "margins")
    figure, axes = plt.subplots(2, len(names), figsize=(column.PAGE, 3.7), sharex=True, sharey="row", layout="constrained")
    fan_outs.draw_coherence(fan_outs.read(record), fan_outs.survival(record), out, figure, axes, names, "reuse")


def draw_cycles(record, out):
    """The counting argument, as lines, and what was measured at rest."""
    cells = fan_outs.read(record)
    rest = fan_outs.at_rest(cells)
    rested = cells.xs("rest", level="motion", drop_level=False)
    figure, (axis,) = column.panels(1, 2.0)
    at = np.linspace(2, 16, 100)
    shown = (("a list's run", 0, rest, "black", "o"), ("deferred", 2, fan_outs.savings(rested, "n_v", "deferred"), "#2f6fb0", "s"),
             ("separation list", 1, fan_outs.savings(rested, "n_v", "separation-list"), "#c0653b", "^"))
    for label, deferral, measured, colour, marker in shown:
        ratio = at / (at - 1)
        axis.plot(at, reuse.cycle(ratio, deferral) if deferral else ratio, color=colour, linewidth=0.8)
        axis.plot(measured.index.get_level_values("fan_out"), measured, color=colour, marker=marker, linestyle="none", label=label)
    axis.set(xlabel="fan-out F", ylabel="speedup in tests at rest", ylim=(0.95, 2.1))
    axis.set_xticks([2, 4, 8, 16])
    column.finish(figure, [axis], out, "cycles")


def draw_strategies(record, out):
    """Medians of what each strategy saves, over the share of the front that is lost."""
    rows = law.read(record)
    strategies = law.strategies_of(rows)
    looks, edges = style.looks(strategies), np.quantile(rows.survival, np.linspace(0, 1, 13))
    figure, axes = column.panels(2, 2.1, sharey=True)
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
    figure, (axis,) = column.panels(1, 2.1)
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
