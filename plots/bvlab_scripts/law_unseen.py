# SPDX-License-Identifier: BSD-3-Clause
"""The law on what it has not seen: predictions from a prefix and from other seeds, beside opponents, with intervals.

usage: plots/script law-unseen RECORD [--out FOLDER] [--table-only]

Figure: law-unseen (predicted against measured, from a prefix and from other seeds; errors by setting). What is
predicted from what is said in experiments/definitions/law-unseen.md, whose hypotheses are numbered in what is printed.
kappa and the regressions come from the committed record of coherence.
"""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from bvlab_scripts import law
from bvlab_plots import records, style
from bvlab_plots.arguments import record_arguments
from bvlab_plots.hypotheses import print_hypotheses
from bvlab_plots.refused import Refused
from bvlab_plots.ticks import log_ticks, name_log_ticks
from bvlab_plots.words import plain

COHERENCE = Path(__file__).resolve().parents[2] / "experiments" / "record" / "coherence"
CELL = ["setting", "query", "volume", "strategy"]
SUMS = ["pair_runs", "near_runs", "tests", "entries", "kept", "grown", "again", "still_entries", "n_v", "n_v_recursive",
        "n_p", "n_p_recursive", "motion_leaf", "motion_gap"]
PREFIX, OTHERS, ITSELF = "prefix", "other seeds", "the run itself"
LAW, ALONE, REGRESSION, FULL, LAST, SAME = ("the law", "R and c alone", "regression", "regression on all inputs",
                                            "last run's cost", "no change")
LATER = "last run's, first frame off"
DRAWS = 2000


@dataclass
class Fit:
    """What is taken from runs that are not predicted: kappa, and coefficients for each strategy."""
    kappa: float
    regression: dict
    full: dict


def alone(rows, first=None):
    """By R and c alone: a list that stays as it is."""
    return law.predicted(rows.assign(growth=0.0, stillness=1.0), 1, first)


def terms(rows, of_list=None):
    """What a regression sees: the measures, and what else the law is given."""
    columns = [np.ones(len(rows)), rows.survival, rows.stillness, rows.growth]
    return np.column_stack(columns + ([] if of_list is None else [np.log(of_list), rows.persistence]))


def regressed(rows, still):
    """Coefficients for each strategy, on the measures and on all."""
    known = rows.survival.notna().to_numpy()
    found = {}, {}
    for strategy in law.LISTS:
        here = known & (rows.strategy == strategy).to_numpy()
        if here.any():
            for into, each in zip(found, (terms(rows[here]), terms(rows[here], still[here]))):
                into[strategy] = np.linalg.lstsq(each, np.log(rows.tests_saved[here]), rcond=None)[0]
    return found


def by_regression(rows, coefficients, of_list=None):
    result = np.full(len(rows), np.nan)
    for strategy, found in coefficients.items():
        here = (rows.strategy == strategy).to_numpy()
        result[here] = np.exp(terms(rows[here], None if of_list is None else of_list[here]) @ found)
    return result


@cache
def fit_of_coherence():
    rows = law.read(COHERENCE)
    lists = rows[rows.strategy.isin(law.LISTS)]
    return Fit(law.fit_kappa(rows), *regressed(lists, alone(lists)))


def motion_model(row):
    if row.scene != "random-walk":
        return row.scene
    if row.persistence > 0:
        return f"persisting {row.persistence:g}"
    return "one body" if row.moving else "wandering"


@dataclass
class Runs:
    """Of each cell and seed of the lists a row: `measured` is what is predicted, of the frames from `first` on;
    `sources` what is known beforehand. `totals` are the tests of every strategy in these frames."""
    measured: pd.DataFrame
    sources: dict
    totals: pd.DataFrame
    first: int

    def off(self, values, where=slice(None), share=0.5):
        """By how many percent predictions are off in the cells of a mask: a quantile; NaN where there is none."""
        found = off_by(values, self)[where]
        return 100 * np.quantile(found, share) if len(found) else np.nan

    def line(self, values, where=slice(None)):
        """Median and 95th percentile of that with their intervals, as a part of a line."""
        return shown(middle_and_most(off_by(values, self)[where], self.measured.seed.to_numpy()[where]))


def read(record, setting=("setting",)):
    """Runs of two lengths of the same seeds; `setting` are the columns that tell settings apart, of which other seeds are a
    source."""
    rows = law.read(record)
    if set(setting) <= set(rows):
        rows["setting"] = rows[list(setting)].astype(str).agg(", ".join, axis=1)
    lengths = sorted(rows.frames.unique()) if "setting" in rows and "seed" in rows else []
    if len(lengths) != 2:
        raise Refused(f"{record}: has to have settings, seeds, and runs of two lengths")
    rows["motion_model"] = rows.apply(motion_model, axis=1)
    keys = CELL + ["seed"]
    short, long = (rows[rows.frames == length].sort_values(keys).reset_index(drop=True) for length in lengths)
    if not short[keys].equals(long[keys]):
        raise Refused(f"{record}: has no prefix of some runs")
    later = long.assign(**{name: long[name] - short[name] for name in ("n_v", "n_p", "n_v_recursive", "n_p_recursive")})
    later = law.with_measures(later)
    seeds = long.groupby(CELL, sort=False)[SUMS].transform("sum")
    others = law.with_measures(long.assign(**{name: seeds[name] - long[name] for name in SUMS}))
    lists = later.strategy.isin(law.LISTS)
    records.say_left_out(set(later[~lists].strategy) - {"recursive"}, "of which the law says nothing")
    # The law is asked for a run of the length that is predicted, whatever its source's.
    sources = {PREFIX: short.assign(frames=lengths[1]), OTHERS: others, ITSELF: long}
    sources = {name: each[lists].reset_index(drop=True) for name, each in sources.items()}
    if later.seed.nunique() < 2:
        del sources[OTHERS]
    measured = later[lists].reset_index(drop=True)
    near = sources[PREFIX].survival
    measured["survives"] = np.where(near.isna(), "nothing near", np.where(near >= 0.5, "half or more", "less than half"))
    return Runs(measured, sources, later, int(lengths[0]))


def predictions(source, first, fit):
    """What each predictor says of the frames from `first` on; 1 where nothing was near in the source."""
    still = alone(source, first)
    frames = first  # of a prefix
    found = {LAW: law.predicted(source, fit.kappa, first), "kappa 0": law.predicted(source, 0, first),
             "kappa 1": law.predicted(source, 1, first), ALONE: still,
             REGRESSION: by_regression(source, fit.regression),
             FULL: by_regression(source, fit.full, still), LAST: source.tests_saved.to_numpy(),
             LATER: (source.n_v_recursive * (frames - 1) / frames
                     / (source.n_v - source.n_v_recursive / frames)).to_numpy(),
             SAME: np.ones(len(source))}
    unknown = ~(source.near_runs > 0).to_numpy() | source.survival.isna().to_numpy()
    return {name: np.where(unknown, 1, values) for name, values in found.items()}


def all_predictions(runs, fit):
    """By source and predictor."""
    found = {source: predictions(rows, runs.first, fit) for source, rows in runs.sources.items()}
    for source in found:
        if source != PREFIX:
            del found[source][LATER]
    del found[ITSELF][LAST]  # is what is to be predicted, but for the prefix
    return found


def off_by(values, runs):
    return np.abs(values / runs.measured.tests_saved.to_numpy() - 1)


def middle_and_most(off, seeds):
    """Median and 95th percentile, in percent, each with its interval: seeds drawn again, all their cells together."""
    parts = [off[seeds == seed] for seed in np.unique(seeds)]
    random = np.random.default_rng(1)
    drawn = np.array([np.quantile(np.concatenate([parts[k] for k in draw]), [0.5, 0.95])
                      for draw in random.integers(len(parts), size=(DRAWS, len(parts)))])
    low, high = np.percentile(drawn, [2.5, 97.5], axis=0)
    return [(100 * v, 100 * a, 100 * b) for v, a, b in zip(np.quantile(off, [0.5, 0.95]), low, high)]


def drawn_difference(a, b, seeds, statistic):
    """The 95 % interval of statistic(a) - statistic(b), in percent: both of the same seeds, drawn again."""
    at = [np.flatnonzero(seeds == seed) for seed in np.unique(seeds)]
    random = np.random.default_rng(1)
    drawn = [statistic(a[rows]) - statistic(b[rows]) for rows in
             (np.concatenate([at[k] for k in draw]) for draw in random.integers(len(at), size=(DRAWS, len(at))))]
    return 100 * np.percentile(drawn, [2.5, 97.5])


def shown(values):
    return "  ".join(f"{value:6.1f} [{low:.1f}, {high:.1f}]".ljust(22) for value, low, high in values)


def regimes(runs):
    """Name and mask of each regime."""
    rows = runs.measured
    walks = rows.scene == "random-walk"
    found = {"all": pd.Series(True, rows.index), "half or more, not persisting": easy(runs)}
    for label, column in (("survival: ", "survives"), ("model: ", "motion_model"), ("setting: ", "setting"), ("query: ", "query")):
        found.update({label + str(value): rows[column] == value for value in dict.fromkeys(rows[column])})
    found["walks that persist"], found["walks that do not"] = walks & (rows.persistence > 0), walks & (rows.persistence == 0)
    return {name: mask.to_numpy() for name, mask in found.items() if mask.any()}


def easy(runs):
    """Where the law is expected to hold: half of the front survives, and motion does not persist."""
    rows = runs.measured
    return (rows.survives == "half or more") & (rows.scene == "random-walk") & (rows.persistence == 0)


CANDIDATES = np.arange(0, 2.001, 0.05)  # for kappa


def known(rows):
    return (rows.near_runs > 0) & rows.survival.notna()


def errors_of_candidates(rows, measured, first):
    """Squared errors of log speedup: a row for each that is known, a column for each kappa."""
    seen = rows[known(rows)]
    saved = measured[known(rows)]
    return pd.DataFrame({kappa: np.log(law.predicted(seen, kappa, first) / saved) ** 2 for kappa in CANDIDATES})


def fitted_to(rows, measured, first, errors):
    """kappa and regressions fitted to what was measured, with these inputs."""
    seen = rows[known(rows)].assign(tests_saved=measured[known(rows)])
    return Fit(errors.loc[seen.index].mean().idxmin(), *regressed(seen, alone(seen, first)))


def models_left_out(runs, fit):
    """Of each motion model: kappa fitted to the others, and median errors of the law by it, of the law by the kappa of the
    record, and of regressions fitted to the others. From prefixes."""
    source, rows, lines = runs.sources[PREFIX], runs.measured, []
    errors = errors_of_candidates(source, rows.tests_saved, runs.first)
    by_record = off_by(predictions(source, runs.first, fit)[LAW], runs)
    for model in dict.fromkeys(rows.motion_model):
        out = (rows.motion_model == model).to_numpy()
        if out.all():
            continue
        other = fitted_to(source[~out], rows.tests_saved[~out], runs.first, errors)
        said = predictions(source, runs.first, other)
        lines.append((model, other.kappa, *(100 * np.median(off_by(said[name], runs)[out])
                                            for name in (LAW, REGRESSION, FULL)), 100 * np.median(by_record[out])))
    return pd.DataFrame(lines, columns=["left out", "kappa", LAW, REGRESSION, FULL, "the law, kappa as before"])


def choices(runs, said):
    """By which share of cells a prediction names the strategy of the fewest tests, and one of at most 1.1 times
    these: of recursive and the lists. The cells, and for each predictor a column of times the fewest."""
    keys = ["setting", "query", "volume", "seed"]
    def wide(values):
        table = runs.measured.assign(value=values).pivot(index=keys, columns="strategy", values="value")
        return table.reindex(columns=list(law.LISTS)).assign(recursive=1.0)
    saved = wide(runs.measured.tests_saved.to_numpy())
    best = saved.max(axis=1)
    found = pd.DataFrame(index=saved.index)
    for name, values in said.items():
        named = wide(values).idxmax(axis=1)
        found[name] = best / saved.to_numpy()[np.arange(len(saved)), saved.columns.get_indexer(named)]
    return found.reset_index()


def best_of_all(runs):
    """Tests of volumes and triangles by the best of recursive and the lists, over those by the best of all strategies."""
    keys = ["setting", "query", "volume", "seed"]
    tests = runs.totals.assign(all=runs.totals.n_v + runs.totals.n_p)
    three = tests[tests.strategy.isin([*law.LISTS, "recursive"])].groupby(keys)["all"].min()
    return three / tests.groupby(keys)["all"].min()


def print_tables(runs, said, fit):
    rows = runs.measured
    print(f"{len(rows)} cells of lists, {rows.setting.nunique()} settings, {rows.seed.nunique()} seeds; kappa {fit.kappa:.2f}. "
          f"Speedup in tests of frames {runs.first} to {int(rows.frames.max()) - 1}; errors in %, 95 % intervals over seeds.")
    for where, mask in ((name, mask) for name, mask in regimes(runs).items() if ":" not in name):
        print(f"\n{where}, {mask.sum()} cells: {'':20} median{'':16}  95 %")
        for source, found in said.items():
            for name, values in found.items():
                print(f"  {source:14} {name:28}", runs.line(values, mask))
    print(f"\nThe law by regime: {'':36} median{'':16}  95 %{'':19} R and c alone, last run's cost (medians)")
    for where, mask in regimes(runs).items():
        for source in (s for s in said if s != ITSELF):
            beside = [runs.off(said[source][name], mask) for name in (ALONE, LAST)]
            print(f"  {where:38} {source:12}", runs.line(said[source][LAW], mask),
                  "".join(f"{value:8.1f}" for value in beside))
    print("\nOne motion model out in turn, from prefixes, medians in %:")
    print(models_left_out(runs, fit).round(2).to_string(index=False))
    print("\nOf recursive, separation-list and deferred: the share of cells in which the fewest tests are named, and within 1.1")
    for source, found in said.items():
        for name, times in choices(runs, found).drop(columns=["setting", "query", "volume", "seed"]).items():
            print(f"  {source:14} {name:28} {100 * (times <= 1).mean():5.1f} %  {100 * (times <= 1.1).mean():5.1f} %   "
                  f"worst {times.max():.2f}")
    times = best_of_all(runs)
    print(f"\nThe best of these takes {times.median():.2f} (median) to {times.max():.1f} times the tests of the best of all; "
          f"it is within 1.1 of it in {100 * (times <= 1.1).mean():.0f} % of the cells.")
    print_hypotheses(hypotheses(runs, said, fit))


def hypotheses(runs, said, fit):
    """Those of law-unseen.md, as (number, whether it holds, numbers in percent)."""
    rows = runs.measured
    def off(mask, name=LAW, source=PREFIX, share=0.5):
        return runs.off(said[source][name], mask, share)
    where = easy(runs).to_numpy()
    persists = ((rows.scene == "random-walk") & (rows.persistence > 0)).to_numpy()
    less, pile = (rows.survives == "less than half").to_numpy(), (rows.scene == "pile").to_numpy()
    found = [("1", off(where) <= 5 and off(where, share=0.95) <= 30, f"{off(where):.1f}, 95 %: {off(where, share=0.95):.1f}")]
    others = {name: off(where, name) for name in (ALONE, REGRESSION, FULL, LAST, LATER, SAME)}
    nearest = min(others, key=others.get)
    apart = drawn_difference(*(off_by(said[PREFIX][name], runs)[where] for name in (LAW, nearest)),
                             rows.seed.to_numpy()[where], np.median) if where.any() else (np.nan, np.nan)
    found.append(("2", off(where) < others[nearest],
                  f"{off(where):.1f}; " + ", ".join(f"{name} {value:.1f}" for name, value in others.items())
                  + f"; the law's less that of {nearest}: [{apart[0]:.1f}, {apart[1]:.1f}]"))
    kappas = [off(persists, name) for name in (LAW, "kappa 0", "kappa 1")]
    found.append(("3", kappas[0] > 5 and kappas[0] < min(kappas[1:]),
                  f"{kappas[0]:.1f}; kappa 0 {kappas[1]:.1f}, kappa 1 {kappas[2]:.1f}"))
    found.append(("4", 20 < off(less) < off(less, ALONE), f"{off(less):.1f}; {ALONE} {off(less, ALONE):.1f}"))
    if OTHERS in said:
        found.append(("5", off(pile) > 20 and off(pile, LAST) > 20 and off(pile, source=OTHERS) <= 10,
                      f"{off(pile):.1f}; {LAST} {off(pile, LAST):.1f}; {OTHERS} {off(pile, source=OTHERS):.1f}"))
        models = {model: [off((rows.motion_model == model).to_numpy(), source=source) for source in (OTHERS, PREFIX)]
                  for model in dict.fromkeys(rows.motion_model)}
        found.append(("6", all(a < b for a, b in models.values()),
                      ", ".join(f"{model} {a:.1f} for {b:.1f}" for model, (a, b) in models.items())))
    named = choices(runs, {name: said[PREFIX][name] for name in (LAW, LAST)})
    near = {name: (named[name] <= 1.1).to_numpy() for name in (LAW, LAST)}
    right = {name: 100 * each.mean() for name, each in near.items()}
    apart = drawn_difference(near[LAW], near[LAST], named.seed.to_numpy(), np.mean)
    found.append(("7", right[LAW] >= 90 and right[LAW] > right[LAST],
                  f"{right[LAW]:.1f}; {LAST} {right[LAST]:.1f}; difference [{apart[0]:.1f}, {apart[1]:.1f}]"))
    if len(table := models_left_out(runs, fit)):
        moved = (table.kappa - fit.kappa).abs().max(), (table[LAW] - table["the law, kappa as before"]).abs().max()
        found.append(("8", moved[0] < 0.3 and moved[1] < 2, f"kappa by up to {moved[0]:.2f}, medians by up to {moved[1]:.1f}"))
    return found


def draw(runs, said, out):
    """Predicted against measured, and errors by setting."""
    rows = runs.measured
    models = list(dict.fromkeys(rows.motion_model))
    looks = style.looks(models)
    sources = [source for source in said if source != ITSELF]
    figure, axes = plt.subplots(1, len(sources) + 1, figsize=(3.1 * len(sources) + 4.2, 4.6),
                                width_ratios=[1] * len(sources) + [1.15])
    both = np.concatenate([said[source][LAW] for source in sources] + [rows.tests_saved])
    low, high = 0.8 * both.min(), 1.25 * both.max()
    ticks = log_ticks(low, high)
    for axis, source in zip(axes, sources):
        for model in models:
            here = (rows.motion_model == model).to_numpy()
            axis.plot(said[source][LAW][here], rows.tests_saved[here], linestyle="none", marker=looks[model]["marker"],
                      color=looks[model]["color"], markersize=3, alpha=0.6, label=plain(model))
        axis.plot([low, high], [low, high], color="black", linewidth=0.8)
        axis.set(xscale="log", yscale="log", xlim=(low, high), ylim=(low, high), title=f"inputs from: {source}",
                 xlabel="speedup in tests, by the law")
        for each in (axis.xaxis, axis.yaxis):
            name_log_ticks(each, ticks)
    axes[0].set_ylabel(f"measured, from frame {runs.first} on")
    axes[0].legend(frameon=False, fontsize=6.5, handletextpad=0.1, borderaxespad=0)
    draw_errors(axes[-1], runs, said)
    figure.tight_layout()
    style.legend_below(figure, *axes[-1].get_legend_handles_labels())
    return style.save(figure, out, "law-unseen")


def draw_errors(axis, runs, said):
    rows = runs.measured
    settings = list(dict.fromkeys(rows.setting))
    seeds = rows.seed.to_numpy()
    shown = [(LAW, PREFIX), (LAW, OTHERS), (ALONE, PREFIX), (REGRESSION, PREFIX), (LAST, PREFIX), (LAST, OTHERS)]
    shown = [each for each in shown if each[1] in said]
    marks = [("#1b1b1b", "o", "full"), ("#1b1b1b", "o", "none"), ("#d95f0e", "s", "full"), ("#8c6bb1", "D", "full"),
             ("#41a5c4", "^", "full"), ("#41a5c4", "^", "none")]
    for k, ((name, source), (color, marker, fill)) in enumerate(zip(shown, marks)):
        middle = [middle_and_most(off_by(said[source][name], runs)[here], seeds[here])[0]
                  for here in ((rows.setting == setting).to_numpy() for setting in settings)]
        middle = np.maximum(np.array(middle), 0.05)
        at = np.arange(len(settings)) + 0.13 * (k - (len(shown) - 1) / 2)
        axis.errorbar(middle[:, 0], at, xerr=[middle[:, 0] - middle[:, 1], middle[:, 2] - middle[:, 0]], linestyle="none",
                      color=color, marker=marker, markersize=3.5, elinewidth=0.8, markeredgewidth=0.8,
                      markerfacecolor=color if fill == "full" else "white", label=f"{name}, {source}")
    for between in range(1, len(settings)):
        axis.axhline(between - 0.5, color="#dddddd", linewidth=0.6)
    axis.grid(False, axis="y")
    axis.set_yticks(range(len(settings)), [plain(setting) for setting in settings], fontsize=7)
    axis.set(xscale="log", xlabel="error, median (%), with its interval")
    axis.invert_yaxis()
    name_log_ticks(axis.xaxis)


def main():
    arguments = record_arguments(__doc__, table_only=True)
    fit, runs = fit_of_coherence(), read(arguments.record)
    said = all_predictions(runs, fit)
    print_tables(runs, said, fit)
    if not arguments.table_only:
        print(draw(runs, said, arguments.out))

