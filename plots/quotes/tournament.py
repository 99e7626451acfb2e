# SPDX-License-Identifier: BSD-3-Clause
"""`recommended` beside all libraries in one program, each side by configurations that were fixed beforehand."""

from functools import cache

from bvlab_plots import records
from bvlab_scripts import tournament
from quoting import Interval, claim, quotes, two_digits

OURS = "recommended"


def written(line):
    return f"{line.ratio:.1f} ({line.low:.1f} to {line.high:.1f})"


def libraries(rows):
    """The methods of other libraries."""
    return list(dict.fromkeys(rows[rows.peer != ""].method))


@cache
def beside_all(record):
    """`recommended` beside the fastest of all configurations of other libraries, those that keep answers among them."""
    rows = tournament.read(record)
    return tournament.tournament(rows, OURS, libraries(rows)).set_index(tournament.PLACES)


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
    return {"touching": Interval(touching), "five": int((touching >= 5).sum()), "cells": len(touching), "roots": Interval(roots),
            "contacts": Interval(contacts), "physx": len(physx), "places": len(us), "slab": len(rule) - len(other), "chosen": len(rule), "oriented": len(other), "oriented_in": oriented,
            **{f"lead_{short}": Interval(lead.get_group(work)) for short, work in (("five", "5 degrees"), ("near", "near"), ("contacts", "contacts, near"))},
            "roots_faster": int((us["wide, from the roots"] < us.recommended).sum()), "coal": int(wrong["Coal, obb"]), "opcode": int(wrong["OPCODE"]), "physx_wrong": int(wrong["PhysX"]), "seeds": rows.seed.nunique(),
            "repetitions": rows.repetition.nunique()}
