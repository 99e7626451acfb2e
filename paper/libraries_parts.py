# SPDX-License-Identifier: BSD-3-Clause
"""The paper's parts on hierarchies beside other libraries."""

import numpy as np
import records
import tournament
from quotes import tournament as fair
from sheet import duration, escape, listed, medians, part, percent, read_right, times


def fixed_for(query):
    """One variant for a query, whatever the motion and density."""
    return "rss recursive-both" if query == "distance" else "obb recursive-both"


@part("hierarchies")
def write_hierarchies(paper, record):
    rows = read_right(record)
    rows = rows[~rows.wrong_answer].assign(
        a_pair=rows.later_ns / rows.later_pairs, all_frames=rows.time_ns / rows.pairs
    )
    cell = ["work", "motion", "density"]
    middle = rows.groupby([*cell, "query", "polygons", "variant", "peer"], sort=False, as_index=False)[
        ["a_pair", "all_frames"]
    ].median()
    densities = list(dict.fromkeys(middle.density))
    table, gains = {}, []
    for key, group in middle.groupby([*cell, "query"], sort=False):
        ours, peers = group[group.peer == ""], group[group.peer != ""]
        best, first = ours.loc[ours.a_pair.idxmin()], peers.all_frames.min() / ours.all_frames.min()
        fixed = ours[ours.variant == fixed_for(key[3])].a_pair.min()
        gain = dict(
            work=key[0],
            motion=key[1],
            density=key[2],
            query=key[3],
            fixed=peers.a_pair.min() / fixed,
            best=peers.a_pair.min() / best.a_pair,
            all_frames=first,
            variant=best.variant,
        )
        gains.append(gain)
        table.setdefault(key[:2], {})[key[2]] = gain
    lines = [
        [escape(work), {"5 degrees": "fast", "a tenth of a degree": "slow"}.get(motion, escape(motion))]
        + [times(of[d][what]) for what in ("fixed", "best") for d in densities]
        for (work, motion), of in table.items()
    ]
    paper.table(
        "hierarchies",
        "ll" + "r" * 2 * len(densities),
        ["query, polygons", ""] + [d[:5] + "." if len(d) > 6 else d for d in densities] * 2,
        lines,
        [
            r" & & \multicolumn{%d}{c}{one configuration} & \multicolumn{%d}{c@{}}{best of %d} \\"
            % (len(densities), len(densities), middle[middle.peer == ""].variant.nunique())
        ],
    )
    paper.put_range("librariesFixed", [g["fixed"] for g in gains])
    paper.put_range("librariesBest", [g["best"] for g in gains])
    largest = max((g for g in gains if g["query"] == "distance"), key=lambda g: g["best"])
    paper.put_times(firstLater=largest["best"], firstAll=largest["all_frames"])
    of_cell = rows[rows.peer == ""].groupby([*cell, "variant"]).time_ns
    apart = of_cell.max() / of_cell.min() - 1
    paper.put_percent(0, repetitionsApart=apart.median(), repetitionsTail=apart.quantile(0.95))
    slow = [g for g in gains if g["motion"] != gains[0]["motion"]]
    paper.shell_best = sum(g["variant"].startswith("shell") for g in gains)
    paper.put_text(slowCells=len(slow), slowMargins=sum(g["variant"].endswith("margins") for g in slow))
    paper.put_text(
        librariesRepetitions=rows.repetition.nunique(),
        librariesLosses=sum(g["fixed"] < 1 for g in gains),
        librariesCells=len(gains),
        shellBest=paper.shell_best,
    )
    sparse = middle[(middle.density == "sparse") & (middle["query"] == "contacts")].groupby("work").a_pair.min()
    paper.put("librariesSparse", sparse.max(), duration(sparse.max()))


def two_lines(name):
    """A column's name broken at its first comma, so that the table is no wider than its numbers."""
    first, comma, rest = name.partition(", ")
    return rf"\shortstack[r]{{{escape(first)},\\{escape(rest)}}}" if comma else escape(first)


@part("narrow-phase")
def write_narrow_phase(paper, record):
    """Whatever methods the record has, by work and size."""
    rows = read_right(record)
    name = "method" if "method" in rows else "variant"
    rows = rows[~rows.wrong_answer].assign(a_pair=rows.later_ns / rows.later_pairs)
    methods = list(dict.fromkeys(rows[name]))
    middle = rows.groupby(["work", "polygons", name], sort=False).a_pair.median()
    lines = []
    for work, polygons in dict.fromkeys(zip(rows.work, rows.polygons)):
        of = {m: middle.get((work, polygons, m), np.nan) for m in methods}
        lines.append(
            [escape(work), str(polygons)] + ["--" if np.isnan(of[m]) else f"{of[m] / 1e3:.2f}" for m in methods]
        )
    paper.table("narrow-phase", "lr" + "r" * len(methods), ["work", "polygons"] + [two_lines(m) for m in methods], lines)
    paper.text("narrow-phase-text", tournament_text(tournament.read(record)))


@part("tournament")
def write_tournament(paper, record):
    """Ours by lanes, over the fastest of FCL and OPCODE with the same flags."""
    found = fair.headline(record)
    for name in ("sixteen", "eight", "one"):
        paper.put_range(f"lanes{name.title()}", [found[name].least, found[name].most])
    paper.put_range("lanesWidth", [found["width"].least, found["width"].most])
    paper.put_range("fclFlags", [found["fcl"].least, found["fcl"].most], "{:.2f}".format)


def tournament_text(rows):
    """Beside the fastest peer, both from the roots, and our recommended configuration beside those with coherence."""
    peers = list(dict.fromkeys(rows[rows.peer != ""].method))
    parts = []
    for ours, names, what in (
        ("wide, from the roots", [m for m in peers if "coherent" not in m], "that starts from the roots"),
        ("recommended", [m for m in peers if "coherent" in m], "that uses coherence"),
    ):
        found = tournament.tournament(rows, ours, names) if names else []
        if len(found):
            parts.append(
                f"The fastest peer {what} takes {times(found.ratio.min())} to {times(found.ratio.max())} times as long "
                f"as ours; the interval lies above 1 in {(found.low > 1).sum()} and below in "
                f"{(found.high < 1).sum()} of {len(found)} rows."
            )
    return " ".join(parts)


def write_peers_cgal(paper):
    record = paper.record("peers-cgal")
    if not record:
        return
    rows = read_right(record)
    rows = rows.assign(a_pair=rows.time_ns / rows.pairs)
    middle = rows.groupby(["motion", "density", "variant"]).a_pair.median().unstack("variant")
    ours = [name for name in middle if "recursive" in name]
    if ours and "cgal" in middle:
        paper.put_range("cgalRigid", (middle["cgal"] / middle[ours[0]]).dropna())
        paper.put_text(cgalBeside=escape(ours[0]))
        paper.have("peers-cgal")


@part("tori")
def write_tori(paper, record):
    rows = read_right(record)
    rows = rows[~rows.wrong_answer].assign(a_frame=rows.time_ns / rows.frames)
    middle = rows.groupby(["query", "variant", "peer", "strategy"], sort=False, as_index=False)[
        ["a_frame", "n_v", "frames"]
    ].median()
    parts, lost, kept = [], [], 0
    for query, group in middle.groupby("query", sort=False):
        ours, peers = group[group.peer == ""], group[group.peer != ""]
        best, other = ours.loc[ours.a_frame.idxmin()], peers.loc[peers.a_frame.idxmin()]
        parts.append(
            f"{escape(query)} {duration(best.a_frame)} a frame ({escape(best.variant)}), "
            f"{escape(other.variant)} {duration(other.a_frame)}"
        )
        for volume in dict.fromkeys(v.split(" ")[0] for v in ours.variant):
            of = ours[ours.variant.str.startswith(volume + " ")]
            front = of[of.strategy.isin(["separation-list", "deferred", "margins"])].a_frame.min()
            kept += 1
            lost += (
                [f"{escape(volume)} ({escape(query)})"]
                if front < of[of.strategy.str.startswith("recursive")].a_frame.min()
                else []
            )
    paper.text(
        "tori",
        "; ".join(parts)
        + f". Keeping a front loses there in {kept - len(lost)} of {kept} pairs of volume and query"
        + (f"; it wins with {listed(lost)}" if lost else "")
        + ".",
    )


def microseconds(value):
    return f"{value:.0f}" if value >= 9.5 else f"{value:.1f}"


@part("closest-features")
def write_closest_features(paper, record):
    rows = records.read(record)
    rows = rows.assign(a_pair=rows.time_ns / rows.pairs)
    middle = medians(rows, ["mesh", "motion", "variant"], "a_pair")
    meshes = list(dict.fromkeys(middle.mesh))
    lines = []
    for variant in dict.fromkeys(middle.variant):
        line = [escape(variant)]
        for mesh in meshes:
            of = middle[(middle.variant == variant) & (middle.mesh == mesh)].a_pair / 1e3
            line.append(f"{microseconds(of.min())}--{microseconds(of.max())}" if len(of) else "--")
        lines.append(line)
    paper.table(
        "closest-features",
        "l" + "r" * len(meshes),
        [r"$\mu$s a pair"] + [escape(m.replace(":", " ")) for m in meshes],
        lines,
    )
    wrong = rows[(rows.peer != "") & (rows.differing > 0)].groupby("peer")[["differing", "pairs"]].sum()
    paper.text(
        "closest-features-text",
        " ".join(
            f"Of {escape(peer)}'s distances {percent(of.differing / of.pairs)} are off by more than the tolerance "
            "of the comparison."
            for peer, of in wrong.iterrows()
            if of.differing / of.pairs > 5e-4
        ),
    )
