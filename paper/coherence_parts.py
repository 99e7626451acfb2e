# SPDX-License-Identifier: BSD-3-Clause
"""The paper's parts on coherence: nine bunnies, the law, strategies beside the best rebuilds, what wins, workloads."""

import numpy as np

import coherence
import column
import law
import nine_bunnies
import style
from sheet import duration, escape, listed, medians, percent, read_right, signed, times

PART_LABEL = {"one body": "one", "all bodies": "all", "one freedom": "one", "all freedoms": "all"}
SHORT = {"recursive": "R", "recursive-both": "B", "separation-list": "L", "deferred": "D", "by-cost": "C", "raise": "U",
         "margins": "M", "adaptive": "A"}


def write_nine_bunnies(paper):
    published = nine_bunnies.PUBLISHED.mean()
    for name, variant in (("publishedList", "separation-list"), ("publishedDeferred", "deferred")):
        paper.put(name, published["recursive"] / published[variant], f"{published['recursive'] / published[variant]:.2f}")
    record = paper.record("nine-bunnies")
    if not record:
        return
    runs = nine_bunnies.read(record)
    (reading, density), time = nine_bunnies.nearest_reading(runs)
    tests = nine_bunnies.speedups(runs, "n_v").groupby(level=["reading", "density"], sort=False).mean()
    paper.put_text(nearestReading=escape(reading), nearestDensity=escape(density), bunniesRuns=runs.seed.nunique(),
                   bunniesFrames=f"{runs.frames.max():.0f}")
    nearest = time.loc[(reading, density)]
    two = "{:.2f}".format
    paper.put("nearestList", nearest["separation-list"], two(nearest["separation-list"]))
    paper.put("nearestDeferred", nearest["deferred"], two(nearest["deferred"]))
    paper.put_range("tests", [tests[c].min() for c in tests] + [tests[c].max() for c in tests], two)
    free = tests[["rejecting" not in r for r, _ in tests.index]]
    one, every = (free[[r.startswith(who) for r, _ in free.index]] for who in ("one body", "all bodies"))
    for who, of in (("oneBody", one), ("allBodies", every)):
        paper.put_range(f"{who}List", of["separation-list"], two)
        paper.put_range(f"{who}Deferred", of["deferred"], two)
    reached = [key for key, of in time.iterrows() if of["separation-list"] >= paper.values["publishedList"]
               and of["deferred"] >= paper.values["publishedDeferred"]]
    paper.put_text(bunniesInTime=f"{len(reached)} of {len(time)} readings reach both" if reached else "no reading reaches both")
    rows = []
    for (r, d), saved in tests.iterrows():
        parts = r.split(", ")
        line = [PART_LABEL.get(part, escape(part)) for part in parts[:2]] + ["yes" if len(parts) > 2 else "no", escape(d)]
        of_time = time.loc[(r, d)]
        rows.append(line + [two(v) for name in ("separation-list", "deferred") for v in (saved[name], of_time[name])])
    paper.table("nine-bunnies", "llllrrrr", ["bodies", "freed.", "rej.", "density", "$N_v$", "time", "$N_v$", "time"], rows,
                [r"\multicolumn{4}{@{}l}{what moves in a step} & \multicolumn{2}{c}{list} & \multicolumn{2}{c@{}}{deferred} \\"])
    paper.have("nine-bunnies")


def write_talk(paper):
    """The talk's tree, as near as it describes it, beside Quinlan's division: what each reading saves."""
    record = paper.record("talk")
    if not record:
        return
    rows = read_right(record)
    middle = medians(rows, ["build", "reading", "density", "seed", "strategy"], ["n_v", "time_ns"])
    two = "{:.2f}".format
    saved = {}
    for what in ("n_v", "time_ns"):
        wide = middle.pivot_table(index=["build", "reading", "density", "seed"], columns="strategy", values=what, sort=False)
        saved[what] = wide[["recursive"]].to_numpy() / wide[nine_bunnies.LISTS]
    of = {what: table.groupby(level=["build", "reading"], sort=False).mean() for what, table in saved.items()}
    builds = list(dict.fromkeys(rows.build))
    lines = []
    for reading in dict.fromkeys(rows.reading):
        parts = reading.split(", ")
        line = [PART_LABEL.get(part, escape(part)) for part in parts[:2]] + ["yes" if len(parts) > 2 else "no"]
        lines.append(line + [two(of[what].loc[(build, reading), name]) for build in builds for name in nine_bunnies.LISTS
                             for what in ("n_v", "time_ns")])
    heads = " & ".join([r"\multicolumn{3}{@{}l}{}"] + [rf"\multicolumn{{4}}{{c}}{{{escape(b)}}}" for b in builds]) + r" \\"
    kinds = " & ".join([r"\multicolumn{3}{@{}l}{moves}"] + [r"\multicolumn{2}{c}{list} & \multicolumn{2}{c}{deferred}"] * len(builds)) + r" \\"
    paper.table("talk", "lll" + "r" * 4 * len(builds), ["bodies", "freed.", "rej."] + ["$N_v$", "time"] * 2 * len(builds), lines, [heads, kinds])
    paper.put_text(talkSeeds=rows.seed.nunique(), talkBuilds=listed(f"\\emph{{{escape(b)}}}" for b in builds))
    for what, name in (("n_v", "Tests"), ("time_ns", "Time")):
        paper.put_range(f"talk{name}List", of[what]["separation-list"], two)
        paper.put_range(f"talk{name}Deferred", of[what]["deferred"], two)
    reached = [key for key, line in of["time_ns"].iterrows() if line["separation-list"] >= paper.values["publishedList"]
               and line["deferred"] >= paper.values["publishedDeferred"]]
    paper.put_text(talkInTime=f"{len(reached)} of {len(of['time_ns'])} pairs of tree and reading reach the published times"
                   if reached else "no pair of tree and reading reaches the published times")
    paper.have("talk")


# The law and its opponents --------------------------------------------------------------------------------------------


def alone(rows):
    """What R and c say by themselves: a list that never grows, and so is rebuilt every other or every third run."""
    full, once = rows.tests, rows.again
    ratio = np.where(rows.strategy == "deferred", (full + 2 * once) / 3, (full + once) / 2)
    far = rows.pair_runs - rows.near_runs
    return (far + full) / (far + ratio)


def opponents(rows, kappa):
    """Predicted speedups of what the law is set beside."""
    talk = rows.strategy.map({"separation-list": 4 / 3, "deferred": 3 / 2})
    return {rf"the law, $\kappa={kappa:.2f}$": law.predicted(rows, kappa), r"the law, $\kappa=0$": law.predicted(rows, 0),
            r"the law, $\kappa=1$": law.predicted(rows, 1), "$R$ and $c$ alone": alone(rows), "$2n$ and $n$": talk}


def off_by(predicted, rows):
    return np.abs(predicted / rows.tests_saved - 1)


def two_errors(off):
    return [percent(off.median()), percent(off.quantile(0.95), 0)]


def write_coherence(paper):
    record = paper.record("coherence")
    if not record:
        return
    rows = law.read(record)
    kappa = law.fit_kappa(rows)
    paper.kappa = kappa
    lists = rows[rows.strategy.isin(law.LISTS)]
    seen = law.fitted(lists)
    off = off_by(law.predicted(lists, kappa), lists)
    paper.put("lawKappa", kappa, f"{kappa:.2f}")
    paper.put_text(lawCells=len(lists), lawCellsFitted=int(seen.sum()), lawCellsLeftOut=int((~seen).sum()),
                   lawShapes=rows.mesh.nunique(), lawMotions=rows.motion.nunique(), lawModels=rows.motion_model.nunique(),
                   lawFittedShapes=listed(map(escape, law.FITTED_MESHES)))
    others = opponents(lists, kappa)
    paper.table("law-errors", "lrrrr", ["", "median", r"95\,\%", "median", r"95\,\%"],
                [[name, *two_errors(off_by(said, lists)[seen]), *two_errors(off_by(said, lists)[~seen])]
                 for name, said in others.items()],
                [r" & \multicolumn{2}{c}{fitted} & \multicolumn{2}{c@{}}{left out} \\"])
    where = {"contacts": lists["query"] == "contacts", "touching": lists["query"] == "touching",
             **{m: lists.motion_model == m for m in dict.fromkeys(lists.motion_model)},
             "survival of a half and more": lists.survival >= 0.5, "survival below a half": lists.survival < 0.5}
    paper.table("law-regimes", "lrrrr", ["", "cells", "median", r"95\,\%", r"$R$, $c$ alone"],
                [[escape(name), str(int(part.sum())), *two_errors(off[part]),
                  percent(off_by(alone(lists), lists)[part].median())] for name, part in where.items()])
    persisting = ~seen & lists.motion_model.str.contains("persisting")
    paper.put_percent(lawErrorFitted=off[seen].median(), lawErrorLeftOut=off[~seen].median(),
                      lawErrorPersisting=off[persisting].median(), aloneErrorFitted=off_by(alone(lists), lists)[seen].median(),
                      aloneErrorLeftOut=off_by(alone(lists), lists)[~seen].median())
    paper.put_percent(0, lawTailFitted=off[seen].quantile(0.95), lawTailLeftOut=off[~seen].quantile(0.95),
                      lawTailPersisting=off[persisting].quantile(0.95),
                      lawTailKept=off[where["survival of a half and more"]].quantile(0.95),
                      lawErrorLost=off[where["survival below a half"]].median(),
                      aloneTailFitted=off_by(alone(lists), lists)[seen].quantile(0.95))
    paper.put_percent(0, lawFarMost=((lists.pair_runs - lists.near_runs) / lists.n_v_recursive).max())
    write_ceiling(paper, lists)
    write_margins(paper, rows)
    write_measures(paper, rows)
    if paper.out:
        draw_law(lists, kappa, paper.figures())
        draw_strategies(rows, paper.figures())
        draw_curve(kappa, paper.figures())
    paper.have("coherence")


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
    paper.text("ceiling", f"The bound holds for runs that nothing ends early. Of the {len(lists)} cells {len(above)} exceed 2, "
               f"all of them {names} where \\emph{{{queries}}} is asked (up to {best.tests_saved:.2f}): there a hit that is found again ends a "
               "run at its first test, so that $c$ is far below $n$.")


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
    paper.table("coherence-crossing", "llrrrrrrr", ["query", "strategy", "below", "wins", "below", "wins", "least", "med.", "most"],
                lines, [r" & & \multicolumn{2}{c}{tests} & \multicolumn{2}{c}{time} & \multicolumn{3}{c@{}}{speedup, time} \\"])
    ranks = law.rank_correlations(rows)
    most = {s: abs(ranks.loc[s]).idxmax() for s in ranks.index}
    words = {"leaves": "motion in leaf sizes", "gaps": "motion in gaps"}
    paper.text("measures-text", "most is told by " + listed(
        f"{words.get(m, m)} ({listed(escape(s) for s in most if most[s] == m)})" for m in dict.fromkeys(most.values())))
    paper.table("coherence-measures", "lrrrrr", ["", "survival", "stillness", "growth", "leaves", "gaps"],
                [[escape(s)] + [signed(f"{v:.2f}") for v in line] for s, line in zip(ranks.index, ranks.values)])


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
            marks = dict(linestyle="none", marker=look["marker"], markersize=2.2, markeredgecolor=look["color"],
                         markerfacecolor=fill, markeredgewidth=0.4, label=f"{name}, {label}")
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
            axis.plot(part.leaves, 1 / part[what], linestyle="none", marker=looks[volume]["marker"], markersize=1.8,
                      markeredgewidth=0.4, markerfacecolor="none", color=looks[volume]["color"], label=volume)
        axis.axhline(1, color="black", linewidth=0.6)
        axis.set_title(title)
        column.log_axis(axis, group.leaves, "x")
    leaves = np.geomspace(group.leaves.min(), group.leaves.max(), 50)
    axes[0].plot(leaves, np.minimum(1, fit[0] * leaves ** fit[1]), color="black", linewidth=1.2, label="fitted")
    column.across(figure, "motion a frame, in leaf sizes")
    axes[0].set_ylabel("margins / recursive")
    column.log_axis(axes[0], np.concatenate([1 / group.all_saved, 1 / group.time_saved]))
    return column.finish(figure, axes, out, "margins")


# Beside the best rebuilds, what wins, workloads ----------------------------------------------------------------------


def write_best_rebuilds(paper):
    record = paper.record("best-rebuilds")
    if not record:
        return
    rows = read_right(record)
    cells = ["motion", "degrees", "query", "strategy"]
    rows["over_best"] = rows.n_v / rows.best_tests
    over = medians(rows, cells, "over_best")
    time = medians(rows, cells, "later_ns")
    least = time.groupby(["motion", "query"]).later_ns.transform("min")
    time["over_least"] = time.later_ns / least
    for name, strategies in (("Raise", ["raise"]), ("Cost", ["by-cost"]), ("Talk", ["separation-list", "deferred"]),
                             ("Recursive", ["recursive"]), ("Adaptive", ["adaptive"]), ("Margins", ["margins"])):
        for query in ("contacts", "touching"):
            of = over[over.strategy.isin(strategies) & (over["query"] == query)].over_best
            paper.put_range(f"rebuilds{name}{query.title()}", of, "{:.2f}".format)
            of = time[time.strategy.isin(strategies) & (time["query"] == query)].over_least
            paper.put_range(f"rebuildsTime{name}{query.title()}", of, "{:.2f}".format)
    if paper.out:
        draw_rebuilds(over, paper.figures())
    paper.have("best-rebuilds")


def draw_rebuilds(over, out):
    strategies = list(dict.fromkeys(over.strategy))
    looks = style.looks(strategies)
    figure, axes = column.panels(2, 1.9, sharey=True)
    for axis, query in zip(axes, dict.fromkeys(over["query"])):
        table = over[over["query"] == query].pivot(index="degrees", columns="strategy", values="over_best")[strategies]
        column.lines(axis, table, looks)
        axis.axhline(1, color="black", linewidth=0.6)
        axis.set_title(query)
    column.across(figure, "rotation a frame, degrees")
    axes[0].set_ylabel("tests / those of the best")
    column.log_axis(axes[0], over.over_best)
    return column.finish(figure, axes, out, "best-rebuilds")


def write_winners(paper):
    winners_map(paper, "winners-motion", "step", "degrees", "motion")
    winners_map(paper, "winners-scene", "side", "polygons", "scene")


def winners_map(paper, name, across, down, short):
    """A table of fields: the fastest variant, and how many times as fast as recursive spheres it is."""
    record = paper.record(name)
    if not record:
        return
    rows = read_right(record)
    rows = rows[rows.peer == ""].assign(a_pair=rows.time_ns / rows.pairs)
    middle = medians(rows, [across, down, "volume", "strategy"], "a_pair")
    columns, lines = sorted(middle[across].unique()), sorted(middle[down].unique(), reverse=down == "degrees")
    won, body = [], []
    for line in lines:
        cells = [f"{line:g}"]
        for at in columns:
            field = middle[(middle[across] == at) & (middle[down] == line)].sort_values("a_pair", kind="stable")
            best = field.iloc[0]
            base = field[(field.volume == "sphere") & (field.strategy == "recursive")].a_pair.min()
            won.append((best.strategy, best.volume, base / best.a_pair, at, line))
            ties = (field.a_pair <= 1.05 * best.a_pair).sum() > 1
            cells.append(f"{best.volume} {SHORT.get(best.strategy, best.strategy)}{'$^=$' if ties else ''} {times(base / best.a_pair)}")
        body.append(cells)
    paper.table(name, "r" + "l" * len(columns), [""] + [f"{c:g}" for c in columns], body)
    of_margins = [gain for strategy, _, gain, _, _ in won if strategy == "margins"]
    paper.put_text(**{f"{short}Fields": len(won), f"{short}Margins": len(of_margins)})
    if of_margins:
        paper.put_range(f"{short}MarginsGain", of_margins)
    small = [s for s, _, _, at, line in won if short == "motion" and at <= 0.03 and line <= 3]
    paper.put_text(**{f"{short}FieldsSmall": len(small), f"{short}MarginsSmall": small.count("margins")})
    paper.put_text(**{f"{short}Volumes": listed(f"{escape(v)} ({sum(w[1] == v for w in won)})"
                                                for v in dict.fromkeys(w[1] for w in won)),
                      f"{short}Winners": listed(f"\\emph{{{escape(s)}}} ({sum(w[0] == s for w in won)})"
                                                for s in dict.fromkeys(w[0] for w in won))})
    paper.have(name)


def write_workloads(paper):
    record = paper.record("workloads")
    if not record:
        return
    rows = law.read(record)
    strategies = list(dict.fromkeys(rows.strategy))
    rows["a_pair"] = rows.time_ns / rows.pairs
    lines = []
    for strategy in strategies:
        line = [escape(strategy)]
        for workload in dict.fromkeys(rows.workload):
            for volume in dict.fromkeys(rows.volume):
                of = rows[(rows.workload == workload) & (rows.volume == volume) & (rows.strategy == strategy)]
                line.append(duration(of.a_pair.iloc[0]).replace(r"\,ns", "") if len(of) else "--")
        lines.append(line)
    volumes = list(dict.fromkeys(rows.volume))
    above = " & ".join([""] + [rf"\multicolumn{{{len(volumes)}}}{{c}}{{{escape(w)}}}" for w in dict.fromkeys(rows.workload)]) + r" \\"
    heads = [(w, v) for w in dict.fromkeys(rows.workload) for v in dict.fromkeys(rows.volume)]
    paper.table("workloads", "l" + "r" * len(heads), ["ns a pair"] + [escape(v) for _, v in heads], lines, [above])
    kappa = getattr(paper, "kappa", None)
    lists = rows[rows.strategy.isin(law.LISTS)]
    if kappa is not None and len(lists):
        off = off_by(law.predicted(lists, kappa), lists)
        talk = off_by(alone(lists), lists)
        paper.put_percent(workloadsLawMost=off.max(), workloadsAloneMost=talk.max())
    else:
        paper.put_text(workloadsLawMost="--", workloadsAloneMost="--")
    paper.have("workloads")


def write_sweep(paper):
    """The law on the large sweep, which the fit has not seen."""
    record = paper.record("sweep")
    if not record or not hasattr(paper, "kappa") or not (record / "sweep.coherence.csv").is_file():
        return
    rows = law.read(record)
    lists = rows[rows.strategy.isin(law.LISTS)]
    off = off_by(law.predicted(lists, paper.kappa), lists)
    paper.put_text(sweepCells=len(lists))
    paper.put_percent(sweepError=off.median(), sweepAlone=off_by(alone(lists), lists).median())
    paper.put_percent(0, sweepTail=off.quantile(0.95))
    paper.have("sweep")
