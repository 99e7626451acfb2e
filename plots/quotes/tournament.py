# SPDX-License-Identifier: BSD-3-Clause
"""The fair tournament: ours by lanes, others with the same flags and as shipped, each side by configurations fixed beforehand."""

from functools import cache

from bvlab_plots import provenance, records
from bvlab_scripts import tournament
from quoting import Interval, claim, quotes, two_digits

SOURCE, SHIPPED, EIGHT, ONE = "from-source", "as-shipped", "eight-lanes", "one-lane"
OURS = "recommended"


def called(method, program):
    return f"{method}, {program}"


@cache
def cells(record):
    """By what is compared a table of cells: times, ratios and intervals."""
    rows = tournament.read(record)

    def beside(ours, theirs, column="ns"):
        return tournament.tournament(rows, ours, theirs, column).set_index(tournament.PLACES)
    fresh = [called(name, SOURCE) for name in ("OPCODE", "PhysX", "FCL, obb", "Coal, obb")]
    scalar = [called("OPCODE", ONE)]  # the one library that has our flags there
    return rows, {
        "sixteen": beside(called(OURS, SOURCE), fresh), "eight": beside(called(OURS, EIGHT), fresh),
        "one": beside(called(OURS, ONE), scalar), "roots": beside(called("wide, from the roots", SOURCE), fresh),
        "roots, one": beside(called("wide, from the roots", ONE), scalar),
        "oriented, one": beside(called("oriented boxes, from the roots", ONE), scalar), "one, native": beside(called(OURS, ONE), [called("OPCODE", SOURCE)]),
        "one, physx": beside(called(OURS, ONE), [called("PhysX", SOURCE)]),
        "coherent": beside(called(OURS, SOURCE), [called("OPCODE, coherent", SOURCE)]),
        "one, coherent": beside(called(OURS, ONE), [called("OPCODE, coherent", ONE)]),
        "fcl": beside(called("FCL, obb", SOURCE), [called("FCL, obb", SHIPPED)]),
        "cold": beside(called(OURS, SOURCE), fresh, "cold_ns"), "tail": beside(called(OURS, SOURCE), fresh, "tail_ns")}


def written(line):
    return f"{line.ratio:.1f} ({line.low:.1f} to {line.high:.1f})"


@quotes("tournament")
def tournament_table(record):
    _, found = cells(record)
    lines, last = [], None
    for place, line in found["sixteen"].iterrows():
        lines.append(["" if place[0] == last else place[0], str(place[1]),
                      *(f"{found[lanes].loc[place].ours_ns / 1e3:.2f}" for lanes in ("sixteen", "eight", "one")),
                      tournament.named(line).replace(f", {SOURCE}", ""), f"{line.fastest_ns / 1e3:.2f}", written(line),
                      written(found["one"].loc[place]),
                      *(f"{found[column].loc[place].ratio:.1f}" for column in ("cold", "tail"))])
        last = place[0]
    return {"rows": lines}


def beside_opcode(rows, column):
    """What slab-boxes from the roots count with one lane, over OPCODE's count, of each cell."""
    sums = rows.groupby(["method", *tournament.PLACES])[column].sum()
    return sums[called("wide, from the roots", ONE)] / sums[called("OPCODE", ONE)]


@quotes("tournament")
def tournament_headline(record):
    rows, found = cells(record)
    claim(rows.seed.nunique() >= 5 and rows.repetition.nunique() >= 5, "five seeds and five repetitions")
    claim((found["sixteen"].low > 1).all(), "sixteen lanes are faster than the fastest peer in every cell")
    claim((found["one"].low > 1).all(), "with one lane recommended is faster than OPCODE with the same flags in every cell")
    claim((found["one, coherent"].ratio > 1).all() and len(found["one, coherent"]) == 8, "with one lane recommended is faster than OPCODE's coherent mode in every cell of touching")
    contacts = rows.work.str.startswith("contacts")
    claim(rows[contacts].frames.max() < 100 < rows[~contacts].frames.min(), "runs for contacts alone have less than a hundred frames")
    ours = rows[rows.method.str.startswith(f"{OURS}, ")]
    claim(set(ours.volume) <= {"slab-box", "obb"}, "recommended takes slab-boxes or oriented boxes")
    names = [name for name in dict.fromkeys(method.split(",")[0] for method in libraries(rows))]
    chosen = ours.groupby(["program", *tournament.PLACES, "seed"])[["volume", "strategy"]].first()
    other = (chosen.loc[SOURCE] != chosen.loc[ONE]).any(axis=1)
    slower = found["one, physx"].ratio < 1
    claim(set(slower[slower].index.get_level_values("work")) <= {"5 degrees", "near", "contacts, near"}, "PhysX is faster than one lane where motion is not coherent")
    wrong = rows[rows.differing > 0].groupby("peer").differing.max()
    claim(set(wrong.index) == {"coal-obb", "opcode", "physx"} and set(rows[rows.differing > 0].work) == {"contacts, near"}, "Coal, OPCODE and PhysX differ, in contacts alone")
    return {"libraries": names, "other_choice": int(other.sum()), "choices": len(other), "one_physx": Interval(found["one, physx"].ratio), "one_physx_faster": int(slower.sum()),
            "coal_wrong": int(wrong["coal-obb"]), "opcode_wrong": int(wrong["opcode"]), "physx_wrong": int(wrong["physx"]), "processor": provenance.processor_of(provenance.machine_of(record)), "coherent": Interval(beside_all(record).ratio), "contact_frames": rows[contacts].frames.max(), "rows": len(rows), "shared": int((rows.alone == "no").sum()),
            "repetitions": rows.repetition.nunique(), "cells": len(found["one"]), "roots_one_slower": int((found["roots, one"].ratio < 1).sum()),
            "oriented_one_slower": int((found["oriented, one"].ratio < 1).sum()),
            "tests": Interval(beside_opcode(rows, "n_v")), "triangles": Interval(beside_opcode(rows, "n_p")), "one_native": Interval(found["one, native"].ratio),
            **{key: Interval(found[name].ratio) for key, name in (("one_coherent", "one, coherent"), ("sixteen", "sixteen"), ("eight", "eight"), ("one", "one"),
                                                                   ("roots", "roots"), ("roots_one", "roots, one"), ("oriented_one", "oriented, one"))},
            "width": Interval(found["one"].ours_ns / found["sixteen"].ours_ns), "fcl": Interval(1 / found["fcl"].ratio)}


@quotes("tournament-roots")
def tournament_roots(record):
    """One lane from the roots, over OPCODE with the same flags, on more seeds than `tournament` has."""
    rows = tournament.read(record)
    claim(rows.program.nunique() == 1 and rows.program.iloc[0] == ONE, "all rows are of the one-lane build")
    claim((rows[rows.peer == ""].differing == 0).all(), "answers of ours agree")
    found = {name: tournament.tournament(rows, called(f"{name}, from the roots", ONE), [called("OPCODE", ONE)]) for name in ("wide", "oriented boxes")}
    slab, oriented = found["wide"], found["oriented boxes"]
    return {"seeds": rows.seed.nunique(), "cells": len(slab), "slab": Interval(slab.ratio), "oriented": Interval(oriented.ratio),
            "slab_below": int((slab.high < 1).sum()), "oriented_below": int((oriented.high < 1).sum())}


def libraries(rows):
    """The methods of other libraries, those compiled from source with our flags where several programs ran them."""
    rows = rows[rows.peer != ""]
    if "program" in rows:
        rows = rows[rows.program == SOURCE]
    return list(dict.fromkeys(rows.method))


@cache
def beside_all(record):
    """`recommended` beside the fastest of all configurations of other libraries, those that keep answers among them."""
    rows = tournament.read(record)
    ours = called(OURS, SOURCE) if "program" in rows else OURS
    return tournament.tournament(rows, ours, libraries(rows)).set_index(tournament.PLACES)


SHOWN = ["recommended", "wide, from the roots", "OPCODE", "OPCODE, coherent", "PhysX", "FCL, obb", "Coal, obb"]


@quotes("tournament-peers")
def scenes(record):
    """Scene by method: microseconds per pair, mean and the 99th percentile of frames; and the lead over the fastest library."""
    rows = tournament.read(record)
    middle = rows.groupby([*tournament.PLACES, "method", "seed"])[["ns", "tail_ns"]].median().groupby([*tournament.PLACES, "method"]).mean() / 1e3
    beside = beside_all(record)
    lines, last = [], None
    for place, line in beside.iterrows():
        texts = []
        for name in SHOWN:
            key, mark = (*place, name), "*" if tournament.differences(rows, place, name) else ""
            mean_and_tail = (two_digits(float(f"{middle[column][key]:.1e}")) for column in ("ns", "tail_ns") if key in middle.index)
            texts.append(", ".join(mean_and_tail) + mark)
        lines.append(["" if place[0] == last else place[0], str(place[1]), *texts, written(line) + ("*" if line.differing else "")])
        last = place[0]
    claim(set(libraries(rows)) == {"OPCODE", "OPCODE, coherent", "PhysX", "FCL, obb", "Coal, obb", "Coal, obbrss"}, "the libraries are OPCODE, PhysX, FCL and Coal")
    claim((rows.alone != "no").all(), "the rows were timed alone")
    claim((beside.low > 1).all(), "recommended is faster than every library in every scene")
    wrong = set(rows[rows.differing > 0].work)
    claim(all(work.startswith("contacts") for work in wrong), "only contacts differ")
    tails = middle.tail_ns.unstack("method")
    claim((tails[OURS] < tails[libraries(rows)].min(axis=1)).all(), "recommended has a lower 99th percentile than every library")
    contacts = rows.work.str.startswith("contacts")
    claim(rows[contacts].frames.max() < 100 < rows[~contacts].frames.min(), "runs for contacts alone have less than a hundred frames")
    mean = middle.ns.unstack("method")
    roots = "wide, from the roots"
    built = rows[rows.polygons == 8000].groupby(["method", *tournament.PLACES]).build_ns.median() / 1e6
    return {"build": Interval(built[OURS]), "build_opcode": Interval(built["OPCODE"]), "build_physx": Interval(built["PhysX"]), "rows": lines, "lead": Interval(beside.ratio), "seeds": rows.seed.nunique(), "repetitions": rows.repetition.nunique(),
            "cells": len(beside), "roots_faster": int((mean[roots] < mean[OURS]).sum()), "roots_most": 100 * (mean[OURS] / mean[roots] - 1).max(), "roots_tails": int((tails[roots] < tails[OURS]).sum()),
            "contact_frames": rows[contacts].frames.max()}


@quotes("tournament-peers")
def tournament_peers(record):
    """Every library from source in one program: microseconds per pair, later frames, medians of repetitions, means of seeds."""
    rows = records.read(record)
    claim((rows.alone != "no").all(), "the rows were timed alone")
    claim((rows[rows.peer == ""].differing == 0).all(), "answers of ours agree")
    rows = rows.assign(us=rows.later_ns / rows.later_pairs / 1e3)
    places = rows[["work", "polygons"]].drop_duplicates().itertuples(index=False, name=None)
    us = rows.groupby(["work", "polygons", "method", "seed"]).us.median().groupby(["work", "polygons", "method"]).mean().unstack()
    us = us.loc[list(places), list(rows.method.unique())]
    libraries = [method for method in us if not method.startswith(("recommended", "wide"))]
    times = us[libraries].min(axis=1) / us.recommended
    touching = times[~times.index.get_level_values("work").str.startswith("contacts")]
    roots = (us[libraries].min(axis=1) / us["wide, from the roots"])[touching.index]
    contacts = times.drop(touching.index)
    claim(set(us[libraries].idxmin(axis=1)) <= {"PhysX", "OPCODE, coherent"}, "PhysX or OPCODE's coherent mode is the fastest library")
    best = us[libraries].idxmin(axis=1)
    physx = best.index[best == "PhysX"]
    claim(set(best.drop(physx)) == {"OPCODE, coherent"}, "OPCODE's coherent mode is the fastest library where PhysX is not")
    rule = rows[rows.method == "recommended"].groupby(["work", "polygons", "seed"])[["volume", "fan_out"]].first()
    other = rule[rule.volume != "slab-box"]
    claim({*other.volume} == {"obb"} and {*other.fan_out} == {4} and {*rule.drop(other.index).fan_out} == {16}, "recommended takes slab-boxes or oriented boxes")
    oriented = [f"`{work}` with {polygons} polygons" for work, polygons in dict.fromkeys(other.index.droplevel("seed"))]
    claim(oriented, "it takes oriented boxes somewhere")
    lead = times.groupby("work")
    wrong = rows[rows.differing > 0].groupby("method").differing.max()
    claim(set(rows[rows.differing > 0].work) == {"contacts, near"} and set(wrong.index) == {"Coal, obb", "Coal, obbrss", "OPCODE", "PhysX"}, "Coal, OPCODE and PhysX differ, in contacts alone")
    lines, last = [], None
    for (work, polygons), line in us.iterrows():
        cells = [two_digits(line[method]) for method in ("recommended", "wide, from the roots", *libraries)]
        lines.append(["" if work == last else work, str(polygons), *cells, f"{times[work, polygons]:.1f}"])
        last = work
    return {"rows": lines, "touching": Interval(touching), "five": int((touching >= 5).sum()), "cells": len(touching), "roots": Interval(roots),
            "contacts": Interval(contacts), "physx": len(physx), "places": len(us), "slab": len(rule) - len(other), "chosen": len(rule), "oriented": len(other), "oriented_in": oriented,
            **{f"lead_{short}": Interval(lead.get_group(work)) for short, work in (("five", "5 degrees"), ("near", "near"), ("contacts", "contacts, near"))},
            "roots_faster": int((us["wide, from the roots"] < us.recommended).sum()), "coal": int(wrong["Coal, obb"]), "opcode": int(wrong["OPCODE"]), "physx_wrong": int(wrong["PhysX"]), "seeds": rows.seed.nunique(),
            "repetitions": rows.repetition.nunique()}
