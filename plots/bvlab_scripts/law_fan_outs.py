# SPDX-License-Identifier: BSD-3-Clause
"""The law of coherence at every fan-out: predictions from twenty frames, at that fan-out or of binary trees, beside opponents.

usage: plots/script law-fan-outs RECORD [--out FOLDER] [--table-only]

Figure: law-fan-outs (predicted against measured; errors by fan-out; speedup against coherence). What is predicted from
what is said in experiments/definitions/law-fan-outs.md, whose hypotheses are numbered in what is printed. Sources and
intervals are those of law_unseen.py.
"""

import matplotlib.pyplot as plt
import numpy as np

from bvlab_scripts import fan_outs as reuse
from bvlab_scripts import law, law_unseen
from bvlab_plots import style
from bvlab_plots.arguments import record_arguments
from bvlab_plots.hypotheses import print_hypotheses
from bvlab_plots.refused import Refused
from bvlab_plots.ticks import log_ticks, name_log_ticks
from bvlab_scripts.law_unseen import ALONE, LAST, LATER, LAW, PREFIX, SAME

SETTING = ["mesh", "motion"]
BINARY = "the law, from binary trees"
PREDICTORS = [LAW, BINARY, LAST, LATER, ALONE, SAME]


def read(record):
    """law_unseen.Runs of every fan-out; `survival` of what is measured is that of binary trees in the prefix."""
    runs = law_unseen.read(record, setting=[*SETTING, "fan_out"])
    rows, source = runs.measured, runs.sources[PREFIX]
    if not {2, 16} <= set(rows.fan_out):
        raise Refused(f"{record}: has to have fan-outs 2 and 16")
    binary = binary_rows(source)
    rows["survival"] = binary.survival.to_numpy()
    rows["easy"] = ((binary.survival >= 0.5) & (binary.persistence == 0)).to_numpy()
    rows["less"] = (binary.survival < 0.5).to_numpy()
    return runs


def binary_rows(source):
    """For each row, the one of the same run and strategy on binary trees."""
    keys = [*SETTING, "query", "volume", "strategy", "seed"]
    binary = source[source.fan_out == 2].set_index(keys)
    if binary.index.has_duplicates:
        raise Refused("two runs on binary trees are alike")
    return binary.loc[list(source[keys].itertuples(index=False, name=None))].reset_index()


def transferred(source):
    """What binary trees let expect of fan-out F: see law-fan-outs.md."""
    rows = binary_rows(source)
    fan_out = source.fan_out.to_numpy(float)
    opened = (rows.tests / rows.entries - 1) / (fan_out - 1)
    rows["tests"] = rows.entries * (1 + opened)
    rows["again"] = rows.entries * (1 + rows.growth * fan_out / (fan_out - 1))
    return rows


def predictions(runs, fit):
    """law_unseen.predictions from the prefix at each fan-out, and the law's from binary trees."""
    source = runs.sources[PREFIX]
    return {**law_unseen.predictions(source, runs.first, fit),
            BINARY: law_unseen.predictions(transferred(source), runs.first, fit)[LAW]}


def fan_outs_of(runs):
    return sorted(runs.measured.fan_out.unique())


def at(runs, fan_out, regime="easy"):
    return ((runs.measured.fan_out == fan_out) & runs.measured[regime]).to_numpy()


def thresholds(runs):
    """Of each fan-out: the survival below which lists lose, and the share of cells on the wrong side."""
    found = {}
    for fan_out in fan_outs_of(runs):
        here = runs.measured[(runs.measured.fan_out == fan_out) & runs.measured.survival.notna()].assign(strategy="list")
        found[fan_out] = law.crossing(here, "list", "tests_saved")[:2]
    return found


def own_kappas(runs):
    """Of each fan-out: kappa fitted to what was measured there, from prefixes."""
    rows, source = runs.measured, runs.sources[PREFIX]
    errors = law_unseen.errors_of_candidates(source, rows.tests_saved, runs.first)
    return {fan_out: errors[(source.fan_out == fan_out).reindex(errors.index)].mean().idxmin() for fan_out in fan_outs_of(runs)}


def hypotheses(runs, said, kappa):
    """Those of law-fan-outs.md, as (number, whether it holds, numbers in percent)."""
    fan_outs = fan_outs_of(runs)
    errors = {name: {f: runs.off(said[name], at(runs, f)) for f in fan_outs} for name in PREDICTORS}

    def each(values, form="{:.1f}"):
        return "; ".join(f"{f}: {form.format(value)}" for f, value in values.items())
    yield 1, max(errors[LAW].values()) <= 5, each(errors[LAW])
    yield 2, 2 * errors[LAW][16] < errors[LAW][2], f"{errors[LAW][2]:.1f} at 2, {errors[LAW][16]:.1f} at 16"
    yield 3, max(value for f, value in errors[BINARY].items() if f > 2) <= 5, each(errors[BINARY])
    two = {name: errors[name][2] for name in (LAST, LATER, ALONE)}
    yield (4, errors[LAW][2] < min(two.values()) and errors[SAME][16] <= 10,
           f"at 2: {errors[LAW][2]:.1f}; " + ", ".join(f"{name} {value:.1f}" for name, value in two.items())
           + f"; no change at 16: {errors[SAME][16]:.1f}")
    less = {f: runs.off(said[LAW], at(runs, f, "less")) for f in fan_outs}
    yield 5, min(less.values()) > 20, each(less)
    lose = {f: survival for f, (survival, _) in thresholds(runs).items()}
    yield 6, all(a < b for a, b in zip(list(lose.values()), list(lose.values())[1:])), each(lose, "{:.2f}")
    own = own_kappas(runs)
    yield 7, max(abs(value - kappa) for value in own.values()) <= 0.3, f"{kappa:.2f}; " + each(own, "{:.2f}")


def print_tables(runs, said, kappa):
    rows = runs.measured
    print(f"{len(rows)} cells of lists, {rows.mesh.nunique()} shapes, {rows.seed.nunique()} seeds; kappa {kappa:.2f}. Speedup in tests of "
          f"frames {runs.first} to {int(runs.sources[PREFIX].frames.max()) - 1}; errors in %, 95 % intervals over seeds.")
    for regime, label in (("easy", "half of the binary front survives, not persisting"), ("less", "less survives")):
        for fan_out in fan_outs_of(runs):
            where = at(runs, fan_out, regime)
            if not where.any():
                continue
            saved = rows.tests_saved[where]
            print(f"\nF = {fan_out}, {label}: {where.sum()} cells, speedups {saved.quantile(0.05):.2f} to {saved.quantile(0.95):.2f}"
                  f"{'':12} median{'':16}  95 %")
            for name in PREDICTORS:
                print(f"  {name:30}", runs.line(said[name], where))
    print("\nSurvival (of binary trees) below which lists lose, and cells on the wrong side:",
          "; ".join(f"{f}: {survival:.2f}, {100 * wrong:.0f} %" for f, (survival, wrong) in thresholds(runs).items()))
    print_hypotheses(hypotheses(runs, said, kappa))


def draw(runs, said, out):
    """Predicted against measured, errors by fan-out, and speedup against coherence."""
    rows, fan_outs = runs.measured, fan_outs_of(runs)
    figure, axes = plt.subplots(1, 3, figsize=(10.2, 3.4))
    both = np.concatenate([said[LAW], rows.tests_saved])
    low, high = 0.9 * both.min(), 1.1 * both.max()
    for (f, colour), marker in zip(reuse.colours(fan_outs).items(), "os^Dvp"):
        here = (rows.fan_out == f).to_numpy()
        axes[0].plot(said[LAW][here], rows.tests_saved[here], linestyle="none", marker=marker, color=colour, markersize=2.5, alpha=0.5,
                     label=f"F = {f}")
        near = rows[here & rows.survival.notna() & (rows.persistence == 0)]
        bins = near.groupby(np.digitize(near.survival, np.quantile(near.survival, np.linspace(0, 1, 11)[1:-1])))
        axes[2].plot(100 * (1 - bins.survival.median()), bins.tests_saved.median(), color=colour, marker=marker, markersize=3.5, linewidth=1.2)
    axes[0].plot([low, high], [low, high], color="black", linewidth=0.8)
    ticks = log_ticks(low, high)
    axes[0].set(xscale="log", yscale="log", xlim=(low, high), ylim=(low, high), xlabel="speedup in tests, by the law",
                ylabel=f"measured, from frame {runs.first} on")
    for axis in (axes[0].xaxis, axes[0].yaxis, axes[2].yaxis):
        axis.axes.set_yscale("log")
        name_log_ticks(axis, ticks)
    draw_errors(axes[1], runs, said, fan_outs)
    axes[2].axhline(1, color="black", linewidth=0.8)
    axes[2].set(xscale="symlog", xlabel="share of the binary front lost a frame, %\n(motion does not persist)", ylabel="speedup in tests, medians", xlim=(0, 100))
    axes[2].set_xticks([0, 1, 10, 100], ["0", "1", "10", "all"])
    axes[2].minorticks_off()
    figure.tight_layout()
    style.legend_below(figure, *style.labelled(axes[:2]))
    return style.save(figure, out, "law-fan-outs")


def draw_errors(axis, runs, said, fan_outs):
    seeds = runs.measured.seed.to_numpy()
    marks = ["o", "s", "^", "v", "D", "x"]
    for k, (name, marker) in enumerate(zip(PREDICTORS, marks)):
        middle = np.array([law_unseen.middle_and_most(law_unseen.off_by(said[name], runs)[where], seeds[where])[0]
                           for where in (at(runs, f) for f in fan_outs)])
        middle = np.maximum(middle, 0.05)
        places = np.arange(len(fan_outs)) + 0.12 * (k - (len(PREDICTORS) - 1) / 2)
        axis.errorbar(places, middle[:, 0], yerr=[middle[:, 0] - middle[:, 1], middle[:, 2] - middle[:, 0]], linestyle="none",
                      marker=marker, color="#1b1b1b" if k < 2 else f"C{k}", markersize=4, elinewidth=0.8,
                      markerfacecolor="white" if k == 1 else None, label=name)
    axis.set_xticks(range(len(fan_outs)), [str(f) for f in fan_outs])
    axis.set(yscale="log", xlabel="fan-out F", ylabel="error, median (%)\n(half of the front survives,\nmotion does not persist)")
    name_log_ticks(axis.yaxis)


def main():
    arguments = record_arguments(__doc__, table_only=True)
    fit = law_unseen.fit_of_coherence()
    runs = read(arguments.record)
    said = predictions(runs, fit)
    print_tables(runs, said, fit.kappa)
    if not arguments.table_only:
        print(draw(runs, said, arguments.out))
