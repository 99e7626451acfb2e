# SPDX-License-Identifier: BSD-3-Clause
"""The paper's part on strategies: beside the best rebuilds, who wins, workloads."""

import column
import law
import style
from law_parts import alone, off_by
from sheet import duration, escape, listed, medians, part, read_right, times


SHORT = {
    "recursive": "R",
    "recursive-both": "B",
    "separation-list": "L",
    "deferred": "D",
    "by-cost": "C",
    "raise": "U",
    "margins": "M",
    "adaptive": "A",
}


@part("best-rebuilds")
def write_best_rebuilds(paper, record):
    rows = read_right(record)
    cells = ["motion", "degrees", "query", "strategy"]
    rows["over_best"] = rows.n_v / rows.best_tests
    over = medians(rows, cells, "over_best")
    time = medians(rows, cells, "later_ns")
    least = time.groupby(["motion", "query"]).later_ns.transform("min")
    time["over_least"] = time.later_ns / least
    for name, strategies in (
        ("Raise", ["raise"]),
        ("Cost", ["by-cost"]),
        ("Talk", ["separation-list", "deferred"]),
        ("Recursive", ["recursive"]),
        ("Adaptive", ["adaptive"]),
        ("Margins", ["margins"]),
    ):
        for query in ("contacts", "touching"):
            of = over[over.strategy.isin(strategies) & (over["query"] == query)].over_best
            paper.put_range(f"rebuilds{name}{query.title()}", of, "{:.2f}".format)
            of = time[time.strategy.isin(strategies) & (time["query"] == query)].over_least
            paper.put_range(f"rebuildsTime{name}{query.title()}", of, "{:.2f}".format)
    if paper.out:
        draw_rebuilds(over, paper.figures())


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
            cells.append(
                f"{best.volume} {SHORT.get(best.strategy, best.strategy)}{'$^=$' if ties else ''} "
                f"{times(base / best.a_pair)}"
            )
        body.append(cells)
    paper.table(name, "r" + "l" * len(columns), [""] + [f"{c:g}" for c in columns], body)
    of_margins = [gain for strategy, _, gain, _, _ in won if strategy == "margins"]
    paper.put_text(**{f"{short}Fields": len(won), f"{short}Margins": len(of_margins)})
    if of_margins:
        paper.put_range(f"{short}MarginsGain", of_margins)
    small = [s for s, _, _, at, line in won if short == "motion" and at <= 0.03 and line <= 3]
    paper.put_text(**{f"{short}FieldsSmall": len(small), f"{short}MarginsSmall": small.count("margins")})
    paper.put_text(
        **{
            f"{short}Volumes": listed(
                f"{escape(v)} ({sum(w[1] == v for w in won)})" for v in dict.fromkeys(w[1] for w in won)
            ),
            f"{short}Winners": listed(
                f"\\emph{{{escape(s)}}} ({sum(w[0] == s for w in won)})" for s in dict.fromkeys(w[0] for w in won)
            ),
        }
    )
    paper.have(name)


@part("workloads")
def write_workloads(paper, record):
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
    above = (
        " & ".join(
            [""] + [rf"\multicolumn{{{len(volumes)}}}{{c}}{{{escape(w)}}}" for w in dict.fromkeys(rows.workload)]
        )
        + r" \\"
    )
    heads = [(w, v) for w in dict.fromkeys(rows.workload) for v in dict.fromkeys(rows.volume)]
    paper.table("workloads", "l" + "r" * len(heads), ["ns a pair"] + [escape(v) for _, v in heads], lines, [above])
    lists = rows[rows.strategy.isin(law.LISTS)]
    if paper.kappa is not None and len(lists):
        off = off_by(law.predicted(lists, paper.kappa), lists)
        talk = off_by(alone(lists), lists)
        paper.put_percent(workloadsLawMost=off.max(), workloadsAloneMost=talk.max())
    else:
        paper.put_text(workloadsLawMost="--", workloadsAloneMost="--")
