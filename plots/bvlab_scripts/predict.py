# SPDX-License-Identifier: BSD-3-Clause
"""What strategies cost, predicted by `bvlab predict`, beside what they took; and the strategy that is chosen by that.

usage: plots/script predict RECORD [--out FOLDER] [--table-only]

Figure: predict (tests predicted against tests counted; errors by strategy; the chosen strategy's time over the
fastest's). What is judged is said in experiments/definitions/predict.md, whose hypotheses are numbered in what is
printed.
"""

from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from bvlab_plots import records, style
from bvlab_plots.arguments import record_arguments
from bvlab_plots.hypotheses import print_hypotheses
from bvlab_plots.refused import Refused
from bvlab_plots.ticks import decades
from bvlab_plots.words import plain

KEEPING = ["separation-list", "deferred", "by-cost", "raise", "margins"]  # what keeps something from frame to frame
HALF, LESS = "half or more", "less than half"
NEAR = 1.1  # times the fastest


@dataclass
class Cells:
    """`rows`: of each cell (setting, query) and strategy a row, with n_v, n_p and time_ns and the same predicted
    (said_*). `chosen`: of each cell a row: named, the strategy that is predicted to be fastest; fastest, the one that
    was; and times, its time over that. `taken`: what the prediction of a cell took of playing every strategy once."""
    rows: pd.DataFrame
    chosen: pd.DataFrame
    taken: pd.Series


def read(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    if not {"setting", "kept", "entries"} <= set(rows):
        raise Refused(f"{record}: has to have settings and coherence")
    said = records.read(record, "predictions")
    records.say_left_out(set(said.strategy) - set(rows.strategy), "which were predicted and not measured")
    said = said[said.strategy.isin(rows.strategy)]
    strategies = list(dict.fromkeys(said.strategy))
    if missing := [s for s in KEEPING if s not in strategies]:
        raise Refused(f"{record}: has no measured {', '.join(missing)}")
    cell = ["setting", "query", "strategy"]
    rows["survival"] = rows.kept / rows.entries
    rows = rows[rows.strategy.isin(strategies)]
    measured = rows.groupby(cell, sort=False, as_index=False).agg(
        mesh=("mesh", "first"), volume=("volume", "first"), survival=("survival", "first"), n_v=("n_v", "first"),
        n_p=("n_p", "first"), time_ns=("time_ns", "median"))
    told = with_settings(said, records.read_table(record / f"{rows.attrs.get('name', record.name)}.csv"))
    told = told.rename(columns={name: f"said_{name}" for name in ("n_v", "n_p", "time_ns")})
    rows = measured.merge(told[[*cell, "said_n_v", "said_n_p", "said_time_ns", "taken_ns"]], on=cell, validate="one_to_one")
    if len(rows) != len(measured):
        raise Refused(f"{record}: some cells are not predicted")
    rows["regime"] = np.where(rows.survival >= 0.5, HALF, LESS)
    return Cells(rows, choices(rows), rows.groupby(["setting", "query"], sort=False).apply(
        lambda cell: cell.taken_ns.iloc[0] / cell.time_ns.sum()))


def with_settings(said, table):
    """Predictions are of what a front depends on: which setting that is, the rows of the record say."""
    shared = [column for column in said if column in table and column not in ("n_v", "n_p", "time_ns", "strategy")]
    settings = table[[*shared, "setting"]].drop_duplicates()
    return said.merge(settings, on=shared)


def choices(rows):
    def of(cell):
        named, fastest = cell.loc[cell.said_time_ns.idxmin()], cell.loc[cell.time_ns.idxmin()]
        return pd.Series({"survival": fastest.survival, "regime": fastest.regime, "named": named.strategy,
                          "fastest": fastest.strategy, "times": named.time_ns / fastest.time_ns})
    return rows.groupby(["setting", "query"], sort=False).apply(of).reset_index()


def always(rows, strategy):
    """The time of one strategy over the fastest's, in every cell."""
    times = rows.pivot_table(index=["setting", "query"], columns="strategy", values="time_ns", sort=False)
    return times[strategy] / times.min(axis=1)


def off(rows, what="n_v"):
    """Predicted over measured, less 1; NaN where nothing was to be counted."""
    return (rows[f"said_{what}"] / rows[what].where(rows[what] > 0)) - 1


def errors(cells, what="n_v", regime=None, strategies=KEEPING):
    """Absolute errors, of some strategies and one regime of survival or all."""
    rows = cells.rows[cells.rows.strategy.isin(strategies)]
    rows = rows if regime is None else rows[rows.regime == regime]
    return off(rows, what).abs().dropna()


def middle(values):
    return 100 * np.median(values) if len(values) else np.nan


def near(times):
    """The share that is within 1.1 of the fastest, in percent."""
    return 100 * (np.asarray(times) <= NEAR).mean()


def hypotheses(cells):
    """Those of predict.md, as (number, whether it holds, numbers in percent)."""
    by = {regime: {s: middle(errors(cells, regime=regime, strategies=[s])) for s in KEEPING} for regime in (HALF, LESS)}
    half, less = (middle(errors(cells, regime=regime)) for regime in (HALF, LESS))
    triangles = [middle(errors(cells, "n_p", regime)) for regime in (HALF, LESS)]
    best = max(cells.rows.strategy.unique(), key=lambda s: near(always(cells.rows, s)))
    lists = cells.rows[cells.rows.strategy.isin(["separation-list", "deferred"]) & (cells.rows.regime == LESS)]
    seconds = middle(errors(cells, "time_ns", strategies=list(cells.rows.strategy.unique())))
    named = near(cells.chosen.times)
    return [("1", half < 5 and less < 15, f"{half:.1f} and {less:.1f}"),
            ("2", max(by[HALF].values()) < 5 and max(by[LESS].values()) < 15,
             "; ".join(", ".join(f"{s} {v:.1f}" for s, v in each.items()) for each in by.values())),
            ("3", triangles[0] < 5 and triangles[1] < 15, " and ".join(f"{t:.1f}" for t in triangles)),
            ("4", named >= 90, f"{named:.0f} %"),
            ("5", named > near(always(cells.rows, best)), f"always {best}: {near(always(cells.rows, best)):.0f} %"),
            ("6", seconds < 10, f"{seconds:.1f}"),
            ("7", off(lists).median() < 0, f"{100 * off(lists).median():.1f}"),
            ("8", cells.taken.median() < 2 / 3, f"{100 * cells.taken.median():.0f} % of the time of playing all")]


def print_tables(cells):
    rows = cells.rows
    counts = rows.groupby("regime").setting.size() // rows.strategy.nunique()
    print(f"{len(cells.chosen)} cells, of which half of the front survives in {counts.get(HALF, 0)}. Errors in %: median, 95 %")
    for regime in (HALF, LESS):
        print(f"\n{regime}: {'':12} tests of volumes     of triangles         time")
        for strategy in [*dict.fromkeys(rows.strategy), "all that keep something"]:
            names = [strategy] if strategy in set(rows.strategy) else KEEPING
            found = [errors(cells, what, regime, names) for what in ("n_v", "n_p", "time_ns")]
            print(f"  {strategy:24}", "   ".join(f"{middle(e):6.1f} {100 * e.quantile(0.95):8.1f}   " for e in found))
    print("\nThe strategy that is named, and its time over the fastest's:")
    print(cells.chosen.round(3).to_string(index=False))
    print(f"\nright in {100 * (cells.chosen.times <= 1).mean():.0f} %, right or within 1.1 in {near(cells.chosen.times):.0f} %, "
          f"at worst {cells.chosen.times.max():.2f}")
    for strategy in dict.fromkeys(rows.strategy):
        times = always(rows, strategy)
        print(f"  always {strategy:16} fastest in {100 * (times <= 1).mean():3.0f} %, within 1.1 in {near(times):3.0f} %, at worst {times.max():.1f}")
    print_hypotheses(hypotheses(cells))


def draw_tests(axis, rows, size=3.5):
    """Predicted against counted; open where less than half of the front survives."""
    looks = style.looks(KEEPING)
    for strategy in KEEPING:
        for regime, fill in ((HALF, looks[strategy]["color"]), (LESS, "none")):
            here = rows[(rows.strategy == strategy) & (rows.regime == regime)]
            axis.plot(here.n_v, here.said_n_v, linestyle="none", marker=looks[strategy]["marker"], markersize=size,
                      markeredgecolor=looks[strategy]["color"], markerfacecolor=fill, markeredgewidth=0.6,
                      label=strategy if regime == HALF else "_")
    every = rows[rows.strategy.isin(KEEPING)]
    low, high = 0.7 * every[["n_v", "said_n_v"]].min().min(), 1.4 * every[["n_v", "said_n_v"]].max().max()
    axis.plot([low, high], [low, high], color="black", linewidth=0.7)
    axis.set(xscale="log", yscale="log", xlim=(low, high), ylim=(low, high))
    ticks = decades(low, high)
    for each in (axis.xaxis, axis.yaxis):
        each.set_ticks(ticks, [f"$10^{{{round(np.log10(tick))}}}$" for tick in ticks])
        each.set_minor_locator(plt.NullLocator())


def draw_choice(axis, cells, size=3.5):
    """The named strategy's time over the fastest's, cell by cell, from best to worst."""
    chosen = cells.chosen.sort_values("times").reset_index(drop=True)
    looks = style.looks(list(dict.fromkeys(cells.rows.strategy)))
    for strategy in dict.fromkeys(cells.rows.strategy):
        here = chosen[chosen.named == strategy]
        if len(here):
            axis.plot(here.index + 1, here.times, linestyle="none", marker=looks[strategy]["marker"], markersize=size,
                      color=looks[strategy]["color"], label=strategy)
    axis.axhline(NEAR, color="black", linewidth=0.7, linestyle="--")
    axis.set_ylim(0.98, max(1.25, 1.03 * chosen.times.max()))


def draw(cells, out):
    figure, axes = plt.subplots(1, 3, figsize=(11.5, 4.4), width_ratios=[1, 1.15, 1])
    draw_tests(axes[0], cells.rows)
    axes[0].set(xlabel="volume tests, counted", ylabel="predicted", title="a filled mark: half of the front survives")
    looks, places = style.looks(KEEPING), np.arange(len(KEEPING))
    for regime, fill, aside in ((HALF, True, -0.17), (LESS, False, 0.17)):
        for place, strategy in zip(places, KEEPING):
            found = 100 * off(cells.rows[(cells.rows.strategy == strategy) & (cells.rows.regime == regime)])
            color = looks[strategy]["color"]
            axes[1].plot(found, place + aside + np.linspace(-0.1, 0.1, len(found)), linestyle="none", marker=looks[strategy]["marker"],
                         markersize=3, color=color, markerfacecolor=color if fill else "none", markeredgewidth=0.6)
            if len(found):
                axes[1].plot([found.median()] * 2, place + aside + np.array([-0.15, 0.15]), color="black", linewidth=1.4)
    for bound, line in ((5, "-"), (15, "--")):
        for side in (-bound, bound):
            axes[1].axvline(side, color="#999999", linewidth=0.7, linestyle=line)
    axes[1].set_yticks(places, [plain(s) for s in KEEPING])
    axes[1].set(xscale="symlog", xlabel="error of the predicted volume tests (%), and its median")
    ticks = [-100, -15, -5, 0, 5, 15, 100]
    axes[1].set_xticks(ticks, [f"{tick}" for tick in ticks])
    axes[1].xaxis.set_minor_locator(plt.NullLocator())
    axes[1].grid(False, axis="y")
    axes[1].invert_yaxis()
    draw_choice(axes[2], cells)
    axes[2].set(xlabel="cells, in this order", ylabel="time of the strategy named, over the fastest's")
    figure.tight_layout()
    style.legend_below(figure, *style.labelled([axes[0], axes[2]]))
    return style.save(figure, out, "predict")


def main():
    arguments = record_arguments(__doc__, table_only=True)
    cells = read(arguments.record)
    print_tables(cells)
    if not arguments.table_only:
        print(draw(cells, arguments.out))

