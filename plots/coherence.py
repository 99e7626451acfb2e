#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""How coherence relates to speedup: a record of a definition that measures coherence, as tables
(printed) and as figures.

usage: coherence.py RECORD [--out FOLDER] [--table-only]

Figures: coherence-speedup (tests saved by each strategy against survival), coherence-law (predicted
against measured, with residuals, fitted and left out apart), coherence-margins (what margins leave to do
against the motion in leaf sizes).

The law (the talk's 2n, n, n argument, carried on). A recursion that ends in n pairs makes 2n - 1 tests (R;
fewer where a hit ends it), a run through the front that it leaves makes c: n, 2 more for every entry gained,
and fewer where a hit found again ends it. From then on the list never shrinks. In its first run it gains the
share g of n. It gains more as the bodies come farther from where it was built than they have been: in its a-th
run g (D(a) - D(a - 1))^kappa, where D(a) is how far a walk gets in a steps, of which each is the last one again
with the probability p that the scene calls persistence (root mean square, D(1) = 1):

    D(a)^2 = a (1 + p) / (1 - p) - 2 p (1 - p^a) / (1 - p)^2.

A run takes c times its length over n. Where exp(-lambda) is the stillness (of runs weighted with their ends), it
gains nothing with probability exp(-lambda (D(a) - D(a - 1))^kappa), and the talk's rules say when it is rebuilt. Only
kappa is fitted; R, c, g and lambda are measured from recursive fronts of one frame and the next.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import records
import style
from arguments import record_arguments

LISTS = {"separation-list": 0, "deferred": 1}
# The fit sees the bunny and the knot, when all bodies move or one does. Everything else is left out of it.
FITTED_MESHES = ["bunny", "knot"]
FITTED_MANNERS = ["all bodies, all freedoms", "one body, one freedom"]


def read(record):
    """One row per trace, volume and strategy: counts, median time, and the coherence of the trace."""
    (table,) = [p for p in Path(record).glob("*.csv") if p.name.count(".") == 1]
    rows = records.table(table)
    coherence = records.table(table.with_suffix(".coherence.csv"))
    if (rows.differing != 0).any():
        raise SystemExit("a variant's answers differ from the reference: refused")
    records.say_left_out(rows[rows.peer != ""].peer, "which keep no front")
    rows = rows[rows.peer == ""]
    trace = [c for c in coherence.columns if c in rows]
    labels = [c for c in ("motion", "manner", "density", "workload") if c in rows]
    rows = rows.groupby(trace + labels + ["strategy"], sort=False).agg(
        time_ns=("time_ns", "median"), pairs=("pairs", "first"), n_u=("n_u", "first"),
        n_v=("n_v", "first"), n_p=("n_p", "first"), front=("front", "first"),
        hits=("hits", "first")).reset_index()
    measured = rows.merge(coherence, on=trace)
    records.say_left_out(set(rows.volume) - set(measured.volume), "whose coherence was not measured")
    rows = measured
    recursive = rows[rows.strategy == "recursive"][trace + labels + ["time_ns", "n_v", "n_p"]]
    rows = rows.merge(recursive, on=trace + labels, suffixes=("", "_recursive"))
    rows["survival"] = rows.kept / rows.ends
    rows["stillness"] = rows.still_ends / rows.ends
    rows["growth"] = rows.grown / rows.ends
    rows["leaves"] = rows.motion_leaf / rows.near_runs
    rows["gaps"] = rows.motion_gap / rows.near_runs
    rows["tests_saved"] = rows.n_v_recursive / rows.n_v
    rows["all_saved"] = (rows.n_v_recursive + rows.n_p_recursive) / (rows.n_v + rows.n_p)
    rows["time_saved"] = rows.time_ns_recursive / rows.time_ns
    return rows


def strategies_of(rows):
    """All but the recursion, in the order in which they were thought of."""
    order = ["separation-list", "deferred", "by-cost", "margins", "adaptive", "raise"]
    present = set(rows.strategy) - {"recursive"}
    return [s for s in order if s in present] + sorted(present - set(order))


def fitted(rows):
    """Which rows the fit may see."""
    seen = rows.mesh.isin(FITTED_MESHES)
    if "manner" in rows:
        seen &= rows.manner.isin(FITTED_MANNERS)
    if "motion" in rows:  # motions of one kind only are left out
        seen &= ~rows.motion.str.match(r"^0 /|.*/ 0$")
    return seen


def way_out(persistence, steps):
    """How far a walk gets in so many steps, in steps."""
    p = np.minimum(persistence, 1 - 1e-4)
    return np.sqrt(np.maximum(steps * (1 + p) / (1 - p) - 2 * p * (1 - p**steps) / (1 - p) ** 2, 0))


def list_over_recursion(rows, defer, kappa):
    """Tests of a list over those of the recursion, near pairs only, by the law."""
    near = rows.near_runs.to_numpy(float)
    full = rows.tests.to_numpy() / near
    once = rows.again.to_numpy() / near
    gain = rows.growth.to_numpy()
    rate = -np.log(np.clip(rows.stillness.to_numpy(), 1e-12, 1))
    persistence = rows.persistence.to_numpy(float)
    states = [np.ones(len(rows))] + [np.zeros(len(rows)) for _ in range(defer)]
    cost, runs, length = full.copy(), np.ones(len(rows)), np.ones(len(rows))
    for age in range(1, int(rows.frames.max())):
        alive = sum(states) * (age < rows.frames.to_numpy())
        fresh = (way_out(persistence, age) - way_out(persistence, age - 1)) ** kappa
        cost += alive * once * length
        runs += alive
        length = length + gain * fresh
        still = np.exp(-rate * fresh)
        states = [alive * (1 - still)] + [state * still for state in states[:-1]]
    return cost / runs / full


def predicted(rows, kappa):
    """The speedup in tests by the law; pairs that are not near take one test either way."""
    result = np.full(len(rows), np.nan)
    for name, defer in LISTS.items():
        of_list = (rows.strategy == name).to_numpy()
        part = rows[of_list]
        far = part.pair_runs - part.near_runs
        ratio = list_over_recursion(part, defer, kappa)
        result[of_list] = (far + part.tests) / (far + part.tests * ratio)
    return result


def fit_kappa(rows):
    """The kappa with the least squared error of log speedup, to two digits."""
    seen = rows[fitted(rows) & rows.strategy.isin(LISTS)]
    candidates = np.arange(0, 2.001, 0.02)
    errors = [np.mean(np.log(predicted(seen, g) / seen.tests_saved) ** 2) for g in candidates]
    return candidates[int(np.argmin(errors))]


def errors(rows, kappa):
    """Median and 95th percentile of |predicted / measured - 1|, fitted and left out."""
    rows = rows[rows.strategy.isin(LISTS)]
    off = np.abs(predicted(rows, kappa) / rows.tests_saved - 1)
    table = {}
    for label, part in (("fitted", fitted(rows)), ("left out", ~fitted(rows))):
        if part.any():
            table[label] = (off[part].median(), off[part].quantile(0.95), int(part.sum()))
    return table


def constant_errors(rows):
    """The same for the talk's own argument, that a list costs n where recursion costs 2n (a still list
    rebuilt every other or every third run)."""
    constant = {"separation-list": 4 / 3, "deferred": 3 / 2}
    rows = rows[rows.strategy.isin(LISTS)]
    off = np.abs(rows.strategy.map(constant) / rows.tests_saved - 1)
    return off.median(), off.quantile(0.95)


def rank_correlations(rows):
    """Spearman's rank correlation of each measure with the tests saved, by strategy."""
    table = {}
    for strategy, group in rows[rows.strategy != "recursive"].groupby("strategy", sort=False):
        what = "tests_saved" if strategy in LISTS else "all_saved"
        ranks = group[[what, "survival", "stillness", "growth", "leaves", "gaps"]].rank()
        table[strategy] = ranks.corr()[what].drop(what)
    return pd.DataFrame(table).T


def crossing(rows, strategy, what):
    """The survival below which most cells lose: the threshold that misjudges the fewest."""
    group = rows[rows.strategy == strategy].sort_values("survival")
    wins = (group[what] > 1).to_numpy()
    # Below the threshold wins are misjudged, above it losses.
    wrong = np.concatenate([[0], np.cumsum(wins)]) + np.concatenate(
        [np.cumsum(~wins[::-1])[::-1], [0]])
    k = int(np.argmin(wrong))
    survival = group.survival.to_numpy()
    at = survival[0] if k == 0 else survival[-1] if k == len(survival) else survival[k - 1:k + 1].mean()
    return at, wrong[k] / len(group), wins.mean()


def fit_margins(rows):
    """What margins leave to do, as c leaves^alpha: least squares in logarithms, where they save."""
    group = rows[(rows.strategy == "margins") & fitted(rows)]
    group = group[(group.leaves > 0) & (group.all_saved > 1.1)]
    if len(group) < 3:
        return None
    alpha, log_c = np.polyfit(np.log(group.leaves), -np.log(group.all_saved), 1)
    return np.exp(log_c), alpha


def margins_errors(rows, law):
    """By which factor the fitted line is off, median, fitted and left out."""
    group = rows[(rows.strategy == "margins") & (rows.leaves > 0)]
    left = np.minimum(1, law[0] * group.leaves ** law[1])
    off = np.exp(np.abs(np.log(left * group.all_saved)))
    return {label: off[part].median() for label, part in
            (("fitted", fitted(group)), ("left out", ~fitted(group))) if part.any()}


def print_tables(rows, kappa):
    print(f"{len(rows)} cells, of {len(rows.groupby(['mesh', 'volume']))} pairs of mesh and volume.\n")
    print("Rank correlation with what is saved (tests; for others than the talk's lists, tests of volumes "
          "and triangles):")
    print(rank_correlations(rows).round(2).to_string(), "\n")
    print(f"The law's kappa = {kappa:.2f}; error of the predicted speedup, median and 95 %:")
    for label, (middle, most, count) in errors(rows, kappa).items():
        print(f"  {label:9} {100 * middle:5.1f} %  {100 * most:5.1f} %   of {count} cells")
    for query, part in rows.groupby("query", sort=False):
        for label, (middle, most, count) in errors(part, kappa).items():
            print(f"  {query}, {label}: {100 * middle:.1f} %  {100 * most:.1f} %   of {count} cells")
    middle, most = constant_errors(rows)
    print(f"  talk's constants 4/3, 3/2: {100 * middle:.1f} %  {100 * most:.1f} %\n")
    print("Survival below which a strategy loses, cells on the wrong side, share of cells won:")
    for query, strategy, what, label in ((q, s, w, t) for q in dict.fromkeys(rows["query"])
                                         for s in strategies_of(rows)
                                         for w, t in (("tests_saved", "tests"), ("time_saved", "time"))):
        at, wrong, won = crossing(rows[rows["query"] == query], strategy, what)
        print(f"  {query:9} {strategy:16} {label:5}  {at:.3f}  {100 * wrong:4.1f} %  {100 * won:5.1f} %")
    law = fit_margins(rows)
    if law:
        print(f"\nMargins leave {law[0]:.2f} leaves^{law[1]:.2f} of the recursion's tests to do; off by a factor of",
              ", ".join(f"{v:.2f} ({k})" for k, v in margins_errors(rows, law).items()))


def draw_speedup(rows, out):
    """Speedup against survival, a panel per strategy, tests above and time below."""
    strategies, looks = strategies_of(rows), style.looks(rows.volume)
    figure, axes = plt.subplots(2, len(strategies), figsize=(2.1 * len(strategies) + 0.6, 4.6),
                                sharex=True, sharey="row", squeeze=False)
    edges = np.quantile(rows.survival, np.linspace(0, 1, 13))
    for column, strategy in zip(axes.T, strategies):
        group = rows[rows.strategy == strategy]
        for axis, what in zip(column, ("all_saved" if strategy not in LISTS else "tests_saved", "time_saved")):
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
        column[1].set_xlabel("share of the front lost a frame")
        column[1].set_xscale("symlog", linthresh=0.01)
        column[1].set_xlim(left=0)
        column[1].set_xticks([0, 0.01, 0.1, 1], ["0", "1%", "10%", "all"])
        column[1].minorticks_off()
    axes[0, 0].set_ylabel("tests, recursive / strategy")
    axes[1, 0].set_ylabel("time, recursive / strategy")
    for line in axes:
        ticks = [t for t in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 500)
                 if line[0].get_ylim()[0] <= t <= line[0].get_ylim()[1]]
        line[0].set_yticks(ticks, [f"{t:g}" for t in ticks])
        line[0].minorticks_off()
    figure.tight_layout()
    style.legend_below(figure, axes[0, 0])
    return style.save(figure, out, "coherence-speedup")


def draw_law(rows, kappa, out):
    """Predicted against measured, and residuals against survival."""
    rows = rows[rows.strategy.isin(LISTS)].copy()
    rows["predicted"] = predicted(rows, kappa)
    seen = fitted(rows)
    figure, axes = plt.subplots(1, 3, figsize=(9.2, 3.1))
    low, high = (f * x for f, x in ((0.8, rows[["predicted", "tests_saved"]].min().min()),
                                    (1.25, rows[["predicted", "tests_saved"]].max().max())))
    for name in LISTS:
        look = style.looks(LISTS)[name]
        for part, fill, label in ((seen, look["color"], "fitted"), (~seen, "none", "left out")):
            group = rows[(rows.strategy == name) & part]
            if not len(group):
                continue
            axes[0].plot(group.predicted, group.tests_saved, linestyle="none", marker=look["marker"],
                         markersize=3.5, markeredgecolor=look["color"], markerfacecolor=fill,
                         markeredgewidth=0.7, label=f"{name}, {label}")
            axes[1].plot(1 - group.survival, group.predicted / group.tests_saved, linestyle="none",
                         marker=look["marker"], markersize=3.5, markeredgecolor=look["color"],
                         markerfacecolor=fill, markeredgewidth=0.7)
    axes[0].plot([low, high], [low, high], color="black", linewidth=0.8)
    axes[0].set(xlabel="speedup in tests, by the law", ylabel="measured", xlim=(low, high), ylim=(low, high),
                xscale="log", yscale="log")
    for axis in (axes[0].xaxis, axes[0].yaxis):
        ticks = [t for t in (0.05, 0.1, 0.2, 0.5, 1, 2, 5) if low <= t <= high]
        axis.set_ticks(ticks, [f"{t:g}" for t in ticks])
        axis.set_minor_locator(plt.NullLocator())
    axes[0].legend(frameon=False, fontsize=7)
    axes[1].axhline(1, color="black", linewidth=0.8)
    axes[1].set(xlabel="share of the front lost a frame", ylabel="law / measured", yscale="log", ylim=(0.2, 5))
    axes[1].set_yticks([0.2, 0.5, 1, 2, 5], ["0.2", "0.5", "1", "2", "5"])
    axes[1].yaxis.set_minor_locator(plt.NullLocator())
    axes[1].set_xscale("symlog", linthresh=0.01)
    axes[1].set_xlim(left=0)
    axes[1].set_xticks([0, 0.01, 0.1, 1], ["0", "1%", "10%", "all"])
    axes[1].minorticks_off()
    draw_curve(axes[2], kappa)
    figure.tight_layout()
    return style.save(figure, out, "coherence-law")


def draw_curve(axis, kappa):
    """What the law says of a pair with 100 ends, of which a run opens more and more."""
    opened = np.concatenate([[0], np.geomspace(1e-3, 0.3, 60)])
    ends, frames = 100, 1000
    model = pd.DataFrame({"near_runs": 1, "tests": 2 * ends - 1, "ends": ends, "grown": opened * ends,
                          "stillness": np.exp(-opened * ends), "frames": frames, "growth": opened, "persistence": 0.0,
                          "again": ends * (1 + 2 * opened)})
    for name, defer in LISTS.items():
        axis.plot(opened, 1 / list_over_recursion(model, defer, kappa), linewidth=1.5, label=name,
                  **style.line_style(style.looks(LISTS)[name]))
    axis.axhline(1, color="black", linewidth=0.8)
    axis.axhline(2, color="black", linewidth=0.8, linestyle=":")
    axis.set_xscale("symlog", linthresh=1e-3)
    axis.set_xlim(left=0)
    axis.set_xticks([0, 1e-3, 1e-2, 1e-1], ["0", "0.1%", "1%", "10%"])
    axis.minorticks_off()
    axis.set(xlabel="ends opened a frame, of 100", ylabel="speedup in tests, by the law")
    axis.legend(frameon=False, fontsize=7)


def draw_margins(rows, out):
    law = fit_margins(rows)
    group = rows[(rows.strategy == "margins") & (rows.leaves > 0)]
    figure, axes = plt.subplots(1, 2, figsize=(7.2, 3.1), sharex=True)
    looks = style.looks(rows.volume)
    for axis, what in zip(axes, ("all_saved", "time_saved")):
        for volume, part in group.groupby("volume", sort=False):
            look = looks[volume]
            seen = fitted(part)
            for where, fill in ((seen, look["color"]), (~seen, "none")):
                axis.plot(part.leaves[where], 1 / part[what][where], linestyle="none", marker=look["marker"],
                          markersize=3.5, markeredgecolor=look["color"], markerfacecolor=fill,
                          markeredgewidth=0.7, label=volume if fill != "none" else None)
        axis.axhline(1, color="black", linewidth=0.8)
        axis.set(xscale="log", yscale="log", xlabel="motion a frame, in leaf sizes")
    leaves = np.geomspace(group.leaves.min(), group.leaves.max(), 50)
    if law:
        axes[0].plot(leaves, np.minimum(1, law[0] * leaves ** law[1]), color="black", linewidth=1.4,
                     label=f"{law[0]:.2f} leaves$^{{{law[1]:.2f}}}$")
    axes[0].set_ylabel("tests, margins / recursive")
    axes[1].set_ylabel("time, margins / recursive")
    axes[0].legend(frameon=False, fontsize=7)
    figure.tight_layout()
    return style.save(figure, out, "coherence-margins")


def main():
    arguments = record_arguments(__doc__, table_only=True)
    rows = read(arguments.record)
    kappa = fit_kappa(rows)
    print_tables(rows, kappa)
    if arguments.table_only:
        return
    out = arguments.out
    print(draw_speedup(rows, out))
    print(draw_law(rows, kappa, out))
    if (rows.strategy == "margins").any():
        print(draw_margins(rows, out))


if __name__ == "__main__":
    main()
