# SPDX-License-Identifier: BSD-3-Clause
"""The paper's part on the law: its errors, its opponents', and when to keep what."""

import coherence
import column
import law
import law_bullet
import law_unseen
import numpy as np
import predict
import style
from sheet import escape, listed, part, percent, signed


def alone(rows):
    """What R and c say by themselves: a list that never grows, and so is rebuilt every other or every third run."""
    full, once = rows.tests, rows.again
    ratio = np.where(rows.strategy == "deferred", (full + 2 * once) / 3, (full + once) / 2)
    far = rows.pair_runs - rows.near_runs
    return (far + full) / (far + ratio)


def opponents(rows, kappa):
    """Predicted speedups of what the law is set beside."""
    talk = rows.strategy.map({"separation-list": 4 / 3, "deferred": 3 / 2})
    return {
        rf"the law, $\kappa={kappa:.2f}$": law.predicted(rows, kappa),
        r"the law, $\kappa=0$": law.predicted(rows, 0),
        r"the law, $\kappa=1$": law.predicted(rows, 1),
        "$R$ and $c$ alone": alone(rows),
        "$2n$ and $n$": talk,
    }


def off_by(predicted, rows):
    return np.abs(predicted / rows.tests_saved - 1)


def two_errors(off):
    return [percent(off.median()), percent(off.quantile(0.95), 0)]


@part("coherence")
def write_coherence(paper, record):
    rows = law.read(record)
    kappa = law.fit_kappa(rows)
    paper.kappa = kappa
    lists = rows[rows.strategy.isin(law.LISTS)]
    seen = law.fitted(lists)
    off = off_by(law.predicted(lists, kappa), lists)
    paper.put("lawKappa", kappa, f"{kappa:.2f}")
    paper.put_text(
        lawCells=len(lists),
        lawCellsFitted=int(seen.sum()),
        lawCellsLeftOut=int((~seen).sum()),
        lawShapes=rows.mesh.nunique(),
        lawMotions=rows.motion.nunique(),
        lawModels=rows.motion_model.nunique(),
        lawFittedShapes=listed(map(escape, law.FITTED_MESHES)),
    )
    others = opponents(lists, kappa)
    paper.table(
        "law-errors",
        "lrrrr",
        ["", "median", r"95\,\%", "median", r"95\,\%"],
        [
            [name, *two_errors(off_by(said, lists)[seen]), *two_errors(off_by(said, lists)[~seen])]
            for name, said in others.items()
        ],
        [r" & \multicolumn{2}{c}{fitted} & \multicolumn{2}{c@{}}{left out} \\"],
    )
    where = {
        "contacts": lists["query"] == "contacts",
        "touching": lists["query"] == "touching",
        **{m: lists.motion_model == m for m in dict.fromkeys(lists.motion_model)},
        "survival of a half and more": lists.survival >= 0.5,
        "survival below a half": lists.survival < 0.5,
    }
    paper.table(
        "law-regimes",
        "lrrrr",
        ["", "cells", "median", r"95\,\%", r"$R$, $c$ alone"],
        [
            [
                escape(name),
                str(int(part.sum())),
                *two_errors(off[part]),
                percent(off_by(alone(lists), lists)[part].median()),
            ]
            for name, part in where.items()
        ],
    )
    persisting = ~seen & lists.motion_model.str.contains("persisting")
    paper.put_percent(
        lawErrorFitted=off[seen].median(),
        lawErrorLeftOut=off[~seen].median(),
        lawErrorPersisting=off[persisting].median(),
        aloneErrorFitted=off_by(alone(lists), lists)[seen].median(),
        aloneErrorLeftOut=off_by(alone(lists), lists)[~seen].median(),
    )
    paper.put_percent(
        0,
        lawTailFitted=off[seen].quantile(0.95),
        lawTailLeftOut=off[~seen].quantile(0.95),
        lawTailPersisting=off[persisting].quantile(0.95),
        lawTailKept=off[where["survival of a half and more"]].quantile(0.95),
        lawErrorLost=off[where["survival below a half"]].median(),
        aloneTailFitted=off_by(alone(lists), lists)[seen].quantile(0.95),
    )
    paper.put_percent(0, lawFarMost=((lists.pair_runs - lists.near_runs) / lists.n_v_recursive).max())
    write_ceiling(paper, lists)
    write_margins(paper, rows)
    write_measures(paper, rows)
    if paper.out:
        draw_law(lists, kappa, paper.figures())
        draw_strategies(rows, paper.figures())
        draw_curve(kappa, paper.figures())


def write_ceiling(paper, lists):
    above = lists[lists.tests_saved > 2]
    paper.put_text(aboveTwo=len(above))
    best = lists.loc[lists.tests_saved.idxmax()]
    paper.put("largestSpeedup", best.tests_saved, f"{best.tests_saved:.2f}")
    if above.empty:
        paper.text("ceiling", "No cell exceeds 2.")
        return
    queries = listed(dict.fromkeys(above["query"]))
    names = listed(map(escape, dict.fromkeys(above.strategy)))
    paper.text(
        "ceiling",
        f"The bound holds for runs that nothing ends early. Of the {len(lists)} cells {len(above)} exceed 2, "
        f"all of them {names} where \\emph{{{queries}}} is asked (up to {best.tests_saved:.2f}): there a hit that "
        "is found again ends a "
        "run at its first test, so that $c$ is far below $n$.",
    )


def write_margins(paper, rows):
    group = rows[(rows.strategy == "margins") & (rows.leaves > 0)]
    fit = law.fit_margins(rows) if len(group) else None
    if not fit:
        return
    off = np.exp(np.abs(np.log(np.minimum(1, fit[0] * group.leaves ** fit[1]) * group.all_saved)))
    seen = law.fitted(group)
    for name, part in (("Fitted", seen), ("LeftOut", ~seen)):
        paper.put_times(**{f"margins{name}": off[part].median(), f"marginsTail{name}": off[part].quantile(0.95)})
    paper.put("marginsFactor", fit[0], f"{fit[0]:.2f}")
    paper.put("marginsPower", fit[1], f"{fit[1]:.2f}")
    if paper.out:
        draw_margins(group, fit, paper.figures())
    paper.have("margins")


def write_measures(paper, rows):
    lines = []
    for query in dict.fromkeys(rows["query"]):
        for strategy in law.strategies_of(rows):
            part = rows[rows["query"] == query]
            line = [escape(query) if strategy == law.strategies_of(rows)[0] else "", escape(strategy)]
            for what in ("tests_saved", "time_saved"):
                at, _, won = law.crossing(part, strategy, what)
                line += ["--" if won > 0.99 else f"{at:.2f}", percent(won, 0)]
                if strategy == "separation-list":
                    paper.put(f"crossing{query.title()}{what.split('_')[0].title()}", at, f"{at:.2f}")
            saved = part[part.strategy == strategy].time_saved
            lines.append(line + [f"{saved.min():.2f}", f"{saved.median():.2f}", f"{saved.max():.1f}"])
    paper.table(
        "coherence-crossing",
        "llrrrrrrr",
        ["query", "strategy", "below", "wins", "below", "wins", "least", "med.", "most"],
        lines,
        [r" & & \multicolumn{2}{c}{tests} & \multicolumn{2}{c}{time} & \multicolumn{3}{c@{}}{speedup, time} \\"],
    )
    ranks = law.rank_correlations(rows)
    most = {s: abs(ranks.loc[s]).idxmax() for s in ranks.index}
    words = {"leaves": "motion in leaf sizes", "gaps": "motion in gaps"}
    paper.text(
        "measures-text",
        "most is told by "
        + listed(
            f"{words.get(m, m)} ({listed(escape(s) for s in most if most[s] == m)})"
            for m in dict.fromkeys(most.values())
        ),
    )
    paper.table(
        "coherence-measures",
        "lrrrrr",
        ["", "survival", "stillness", "growth", "leaves", "gaps"],
        [[escape(s)] + [signed(f"{v:.2f}") for v in line] for s, line in zip(ranks.index, ranks.values)],
    )


def share_axis(axis, ticks, texts):
    axis.set_xscale("symlog", linthresh=ticks[1])
    axis.set_xlim(left=0)
    axis.set_xticks(ticks, texts)
    axis.minorticks_off()


def draw_law(lists, kappa, out):
    """Predicted against measured on equal axes, and residuals by survival; nothing is clipped."""
    said, seen, looks = law.predicted(lists, kappa), law.fitted(lists), style.looks(law.LISTS)
    figure, axes = column.panels(2, 2.0)
    every = np.concatenate([said, lists.tests_saved])
    for name, look in looks.items():
        for part, fill, label in ((~seen, "none", "left out"), (seen, look["color"], "fitted")):
            at = (lists.strategy == name) & part
            marks = dict(
                linestyle="none",
                marker=look["marker"],
                markersize=2.2,
                markeredgecolor=look["color"],
                markerfacecolor=fill,
                markeredgewidth=0.4,
                label=f"{name}, {label}",
            )
            axes[0].plot(said[at], lists.tests_saved[at], **marks)
            axes[1].plot(1 - lists.survival[at], said[at] / lists.tests_saved[at], **marks)
    axes[0].axline((1, 1), slope=1, color="black", linewidth=0.6)
    axes[0].set(xlabel="speedup in tests, by the law", ylabel="measured")
    column.log_axis(axes[0], every, "xy")
    limits = (0.85 * every.min(), 1.18 * every.max())
    axes[0].set(xlim=limits, ylim=limits)
    axes[1].axhline(1, color="black", linewidth=0.6)
    axes[1].set(xlabel="share of the front lost a frame", ylabel="law / measured")
    column.log_axis(axes[1], said / lists.tests_saved)
    share_axis(axes[1], [0, 0.01, 0.1, 1], ["0", "1%", "10%", "all"])
    return column.finish(figure, axes, out, "law")


def draw_curve(kappa, out):
    """What the law says of a pair with 100 entries, of which a run opens more and more."""
    figure, (axis,) = column.panels(1, 1.5)
    coherence.draw_curve(axis, kappa)
    axis.get_legend().remove()
    axis.set_ylabel("speedup in tests")
    return column.finish(figure, [axis], out, "law-curve")


def draw_strategies(rows, out):
    """Medians of what each strategy saves, over the share of the front that is lost."""
    strategies = law.strategies_of(rows)
    looks, edges = style.looks(strategies), np.quantile(rows.survival, np.linspace(0, 1, 13))
    figure, axes = column.panels(2, 1.9, sharey=True)
    values = []
    for axis, what, title in ((axes[0], "tests", "tests"), (axes[1], "time_saved", "time")):
        for strategy in strategies:
            saved = {"tests": "tests_saved" if strategy in law.LISTS else "all_saved"}.get(what, what)
            group = rows[rows.strategy == strategy]
            bins = group.groupby(np.clip(np.digitize(group.survival, edges), 1, 12))
            middle = bins[[saved]].median().join(bins.survival.median())
            axis.plot(1 - middle.survival, middle[saved], label=strategy, **style.point_style(looks[strategy]))
            values += list(middle[saved])
        axis.axhline(1, color="black", linewidth=0.6)
        axis.set_title(title)
        share_axis(axis, [0, 0.01, 0.1, 1], ["0", "1%", "10%", "all"])
    column.across(figure, "share of the front lost a frame")
    axes[0].set_ylabel("recursive / strategy")
    column.log_axis(axes[0], values)
    return column.finish(figure, axes, out, "strategies")


def draw_margins(group, fit, out):
    figure, axes = column.panels(2, 1.8, sharey=True)
    looks = style.looks(group.volume)
    for axis, what, title in ((axes[0], "all_saved", "tests"), (axes[1], "time_saved", "time")):
        for volume, part in group.groupby("volume", sort=False):
            axis.plot(
                part.leaves,
                1 / part[what],
                linestyle="none",
                marker=looks[volume]["marker"],
                markersize=1.8,
                markeredgewidth=0.4,
                markerfacecolor="none",
                color=looks[volume]["color"],
                label=volume,
            )
        axis.axhline(1, color="black", linewidth=0.6)
        axis.set_title(title)
        column.log_axis(axis, group.leaves, "x")
    leaves = np.geomspace(group.leaves.min(), group.leaves.max(), 50)
    axes[0].plot(leaves, np.minimum(1, fit[0] * leaves ** fit[1]), color="black", linewidth=1.2, label="fitted")
    column.across(figure, "motion a frame, in leaf sizes")
    axes[0].set_ylabel("margins / recursive")
    column.log_axis(axes[0], np.concatenate([1 / group.all_saved, 1 / group.time_saved]))
    return column.finish(figure, axes, out, "margins")


def write_sweep(paper):
    """The law on the large sweep, which the fit has not seen."""
    record = paper.record("sweep")
    if not record or paper.kappa is None or not (record / "sweep.coherence.csv").is_file():
        return
    rows = law.read(record)
    lists = rows[rows.strategy.isin(law.LISTS)]
    off = off_by(law.predicted(lists, paper.kappa), lists)
    paper.put_text(sweepCells=len(lists))
    paper.put_percent(sweepError=off.median(), sweepAlone=off_by(alone(lists), lists).median())
    paper.put_percent(0, sweepTail=off.quantile(0.95))
    paper.have("sweep")


@part("law-unseen")
def write_law_unseen(paper, record):
    """The law from the first frames of runs that were made after it was written down."""
    fit = law_unseen.fit_of_coherence()
    runs = law_unseen.read(record)
    said = law_unseen.all_predictions(runs, fit)[law_unseen.PREFIX]
    regimes = law_unseen.regimes(runs)
    easy, pile, less = (regimes[name] for name in ("half or more, not persisting", "model: pile", "survival: less than half"))
    off = {name: law_unseen.off_by(said[name], runs) for name in (law_unseen.LAW, law_unseen.ALONE, law_unseen.LAST, "kappa 0", "kappa 1")}
    of_law = off[law_unseen.LAW]
    paper.put_text(unseenSettings=runs.measured.setting.nunique(), unseenSeeds=runs.measured.seed.nunique())
    paper.put_percent(
        unseenLaw=np.median(of_law),
        unseenZero=np.median(off["kappa 0"]),
        unseenOne=np.median(off["kappa 1"]),
        unseenAlone=np.median(off[law_unseen.ALONE]),
        unseenLast=np.median(off[law_unseen.LAST]),
        unseenEasy=np.median(of_law[easy]),
        unseenEasyLast=np.median(off[law_unseen.LAST][easy]),
    )
    paper.put_percent(
        0, unseenTail=np.quantile(of_law, 0.95), unseenPile=np.median(of_law[pile]), unseenLost=np.median(of_law[less])
    )


@part("law-bullet")
def write_law_bullet(paper, record):
    """The law from the first frames of heaps that Bullet lets fall."""
    runs = law_bullet.read(record)
    said = law_unseen.all_predictions(runs, law_unseen.fit_of_coherence())[law_unseen.PREFIX]
    paper.put_percent(heapsLaw=np.median(law_unseen.off_by(said[law_unseen.LAW], runs)),
                      heapsLast=np.median(law_unseen.off_by(said[law_unseen.LAST], runs)))


@part("predict")
def write_predict(paper, record):
    """What every strategy costs, from windows begun at recursive fronts."""
    cells = predict.read(record)
    rows = cells.rows
    names = list(dict.fromkeys(rows.strategy))
    share = {name: predict.near(predict.always(rows, name)) / 100 for name in names}
    best = max(share, key=share.get)
    paper.put_text(
        predictCells=len(cells.chosen),
        predictSettings=rows.setting.nunique(),
        predictHalfCells=int((cells.chosen.regime == predict.HALF).sum()),
        predictAlwaysBest=escape(best),
        predictHeld=listed(number for number, holds, _ in predict.hypotheses(cells) if holds),
    )
    paper.put_percent(
        predictHalf=predict.errors(cells, regime=predict.HALF).median(),
        predictLess=predict.errors(cells, regime=predict.LESS).median(),
        predictTime=predict.errors(cells, "time_ns", strategies=names).median(),
    )
    paper.put_percent(
        0,
        predictNamed=predict.near(cells.chosen.times) / 100,
        predictAlways=share[best],
        predictTaken=cells.taken.median(),
    )
    paper.put_times(predictWorst=cells.chosen.times.max())

    def line(strategies):
        found = [predict.errors(cells, what, regime, strategies) for regime in (predict.HALF, predict.LESS)
                 for what in ("n_v", "n_p", "time_ns")]
        return [percent(each.median()) for each in found]
    paper.table(
        "predict",
        "lrrrrrr",
        ["", "$N_v$", "$N_p$", "time", "$N_v$", "$N_p$", "time"],
        [[escape(name), *line([name])] for name in names],
        [r" & \multicolumn{3}{c}{half or more survives} & \multicolumn{3}{c@{}}{less} \\"],
    )
    if paper.out:
        draw_predict(cells, paper.figures())


def draw_predict(cells, out):
    figure, axes = column.panels(2, 2.1)
    predict.draw_tests(axes[0], cells.rows, 2.2)
    axes[0].set(xlabel="volume tests, counted", ylabel="predicted")
    predict.draw_choice(axes[1], cells, 2.2)
    axes[1].set(xlabel="cells, in this order", ylabel="named / fastest, time")
    return column.finish(figure, axes, out, "predict")
