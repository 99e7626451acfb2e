# SPDX-License-Identifier: BSD-3-Clause
"""The paper's parts on exactness: triangle tests, stability, time against error."""

import column
import records
import style
from sheet import count, duration, escape, listed, part, percent


@part("triangles-error")
def write_triangles(paper, record):
    rows = records.read(record)
    rows["wrong"] = rows.false_positives + rows.false_negatives
    keys = ["test", "source", "set"]
    of = rows.groupby(keys)[["ns_per_call", "wrong", "pairs"]].median()
    sets = rows.set.nunique()
    names = {"batched": "sixteen at once", "one by one": "alone", "peer": ""}
    lines = []
    for test, source in dict.fromkeys(zip(rows.test, rows.source)):
        group = of.loc[test, source]
        share = group.wrong / group.pairs
        lines.append(
            [
                escape(test) + (f", {names[source]}" if names.get(source) else ""),
                f"{group.ns_per_call.min():.0f}--{group.ns_per_call.max():.0f}",
                str(int((group.wrong > 0).sum())),
                f"{1000 * share.max():.0f}" if share.max() >= 1e-3 or share.max() == 0 else "$<$1",
            ]
        )
    paper.table("triangles", "lrrr", ["", "ns a call", "sets", r"worst, \textperthousand"], lines)
    exact = of.loc["exact"]
    paper.put_text(triangleSets=sets, trianglePairs=count(rows.pairs.max()), exactWrong=int(exact.wrong.sum()))
    if "batched" in exact.index:
        paper.put_range("exactBatched", exact.loc["batched"].ns_per_call, "{:.0f}".format)


@part("stability-map")
def write_stability(paper, record):
    rows = records.read(record)
    rows["wrong"] = rows.false_positives + rows.false_negatives
    ours = rows[rows.peer == ""].groupby("precision", sort=False)[["answers", "wrong", "false_negatives"]].sum()
    for precision, total in ours.iterrows():
        name = {"exact": "Exact", "float64": "Double", "float32": "Single"}.get(precision, precision.title())
        paper.put(f"stability{name}Answers", int(total.answers), count(total.answers))
        paper.put(f"stability{name}Wrong", int(total.wrong), count(total.wrong))
        paper.put(f"stability{name}Missed", int(total.false_negatives), count(total.false_negatives))
    stressors = list(dict.fromkeys(rows.stressor))
    paper.put_text(
        stabilityStressors=len(stressors), stabilityLevels=len(rows[["stressor", "level"]].drop_duplicates())
    )
    lines, kinds = [], {}
    groups = [
        (f"ours, {p}", rows[(rows.peer == "") & (rows.precision == p)])
        for p in dict.fromkeys(rows[rows.peer == ""].precision)
    ]
    groups += [(p, rows[rows.peer == p]) for p in dict.fromkeys(rows[rows.peer != ""].peer)]
    for name, group in groups:
        by = group.groupby("stressor")[["answers", "wrong", "false_negatives"]].sum()
        cells = [share_of(by.loc[s]) for s in stressors]
        total = group[["answers", "wrong", "false_negatives"]].sum()
        shares = cells + [count(total.wrong), count(total.false_negatives), count(total.answers)]
        kinds.setdefault(tuple(shares), []).append(name)
    for shares, names in kinds.items():
        lines.append([escape(", ".join(names)), *shares])
    paper.table(
        "stability",
        "l" + "r" * (len(stressors) + 3),
        [""] + [escape(s.removeprefix("exact ")) for s in stressors] + ["wrong", "missed", "of"],
        lines,
    )
    peers = rows[rows.peer != ""].groupby("peer")[["wrong"]].sum().wrong.sort_values()
    fcl = peers[[p for p in peers.index if p.startswith("fcl")]]
    paper.put_range("stabilityPeers", peers, count)
    if len(fcl):
        paper.put_range("stabilityFcl", fcl, count)
        paper.put_text(stabilityFclWorst=escape(fcl.idxmax()))
    embree = rows[rows.peer == "embree"]
    where = listed(escape(s) for s in dict.fromkeys(embree[embree.wrong > 0].stressor))
    paper.text(
        "stability-embree",
        f"Embree, which calls our triangle test, is wrong under the stressor \\emph{{{where}}} alone."
        if len(embree) and embree[embree.wrong > 0].stressor.nunique() == 1
        else "",
    )


def share_of(total):
    if not total.answers:
        return "--"
    share = total.wrong / total.answers
    return "0" if not total.wrong else f"{100 * share:.0f}" if share >= 0.005 else "$<$1"


@part("boxes-precision")
def write_precision(paper, record):
    rows = records.read(record)
    outward = rows[rows.numbers == "float, outward"].assign(share=lambda r: r.false_positives / r.pairs)
    middle = outward.groupby(["set", "offset"]).share.median()
    far = max(rows.offset)
    loose = middle[[s != "adjacent" for s, _ in middle.index]]
    paper.put_text(precisionMissed=int(rows[rows.numbers != "double"].false_negatives.sum()), precisionFar=count(far))
    paper.put_range("precisionFalse", loose.xs(far, level="offset"), percent)
    if "adjacent" in set(rows.set):
        paper.put_range("precisionAdjacent", middle.loc["adjacent"], lambda v: percent(v, 0))
    ratio = rows.groupby(["method", "set", "offset", "numbers"]).ns_per_frame.median().unstack()
    ratio = (ratio["float, outward"] / ratio["double"]).groupby("method").quantile([0, 0.5, 1]).unstack()
    paper.text(
        "precision-time",
        listed(f"\\emph{{{escape(m)}}} {r[0.5]:.2f} ({r[0.0]:.2f} to {r[1.0]:.2f})" for m, r in ratio.iterrows()),
    )


@part("distance-error")
def write_distance_error(paper, record):
    rows = records.read(record)
    rows["an_answer"] = rows.time_ns / rows.answers
    table = rows.groupby(["mesh", "volume", "relative_error"], sort=False).an_answer.median().unstack("relative_error")
    paper.put_range("errorTenthSaves", table[0.0] / table[0.1])
    paper.put_text(errorOutside=int(rows.outside.sum()), errorAnswers=count(rows.answers.sum()))
    seen = (rows.largest_error / rows.relative_error)[rows.relative_error > 0]
    paper.put_range("errorSeen", seen, "{:.2f}".format)
    parts, won = [], []
    for mesh in dict.fromkeys(rows.mesh):
        best = {error: table.loc[mesh][error].idxmin() for error in table}
        spans = []
        for error, volume in best.items():
            if spans and spans[-1][2] == volume:
                spans[-1][1] = error
            else:
                spans.append([error, error, volume])
        parts.append(
            f"on the {escape(mesh)} "
            + listed(f"{escape(v)} ({a:g}" + (f" to {b:g})" if b != a else ")") for a, b, v in spans)
        )
        won += [mesh] if "shell" in best.values() else []
    nowhere = "best in no cell of Table~\\ref{hierarchies}, " if paper.shell_best == 0 else ""
    paper.text(
        "distance-best",
        "; ".join(parts)
        + (
            f". Shells, {nowhere}win here on the {listed(map(escape, won))}: "
            "they are meant for surface that is curved"
            if won
            else ""
        ),
    )
    if paper.out:
        draw_distance(table, paper.figures())


def draw_distance(table, out):
    meshes = list(dict.fromkeys(table.index.get_level_values(0)))
    looks = style.looks(list(dict.fromkeys(table.index.get_level_values(1))))
    figure, axes = column.panels(len(meshes), 2.1, sharey=True)
    for axis, mesh in zip(axes, meshes):
        column.lines(axis, table.loc[mesh].T / 1e3, looks)
        axis.set_title(mesh)
        axis.tick_params(axis="x", labelrotation=45)
    column.across(figure, "relative error allowed")
    axes[0].set_ylabel(r"time an answer ($\mu$s)")
    column.log_axis(axes[0], table.to_numpy().ravel() / 1e3)
    return column.finish(figure, axes, out, "distance-error")


@part("budget")
def write_budget(paper, record):
    rows = records.read(record)
    rows["an_answer"] = rows.time_ns / rows.answers
    middle = rows.groupby(["mesh", "volume", "budget"], as_index=False)[
        ["an_answer", "mean_deepest_per_radius"]
    ].median()
    parts = []
    for most, word in ((0.1, "a tenth"), (0.01, "a hundredth")):
        good = middle[middle.mean_deepest_per_radius <= most]
        best = good.loc[good.groupby("mesh").an_answer.idxmin()]
        parts.append(
            f"{word} of the radius "
            + listed(f"{duration(r.an_answer)} ({escape(r.mesh)}, {escape(r.volume)})" for r in best.itertuples())
        )
    paper.text("budget", "; ".join(parts))
