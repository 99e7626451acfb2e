# SPDX-License-Identifier: BSD-3-Clause
"""The narrow phase beside OPCODE, FCL and Coal, each side by one configuration fixed beforehand."""

from functools import cache

import numpy as np

from bvlab_plots import records
from bvlab_scripts import tournament
from quoting import Interval, claim, quotes

FRESH, COHERENT = ["OPCODE", "FCL, obb", "Coal, obb", "Coal, obbrss"], ["OPCODE, coherent"]


@cache
def recommended_beside(record):
    """The rows of the record, and `recommended` beside those that start from the roots and beside those that are coherent."""
    rows = tournament.read(record)
    return rows, cells(rows, "recommended", FRESH), cells(rows, "recommended", COHERENT)


def cells(rows, ours, theirs):
    return tournament.tournament(rows, ours, theirs).set_index(tournament.PLACES)


@quotes("narrow-phase")
def narrow_phase_table(record):
    rows, recommended, coherent = recommended_beside(record)
    fresh = cells(rows, "wide, from the roots", FRESH)
    lines, last = [], None
    for place, line in fresh.iterrows():
        beside = coherent.loc[place] if place in coherent.index else None
        lines.append(["" if place[0] == last else place[0], str(place[1]), f"{line.ours_ns / 1e3:.2f}", tournament.named(line),
                      f"{line.ratio:.1f} ({line.low:.1f} to {line.high:.1f})", f"{recommended.loc[place].ours_ns / 1e3:.2f}",
                      "" if beside is None else f"{beside.ratio:.1f} ({beside.low:.1f} to {beside.high:.1f})"])
        last = place[0]
    claim((fresh.low > 1).all() and (recommended.low > 1).all(), "ours is faster than the fastest of OPCODE, FCL and Coal in every cell")
    claim((coherent.low > 1).all(), "recommended is faster than OPCODE with its coherence in every cell")
    claim((fresh.fastest == "OPCODE").all(), "OPCODE is the fastest of them in every cell")
    return {"rows": lines}


@quotes("narrow-phase")
def narrow_phase_headline(record):
    rows, fresh, coherent = recommended_beside(record)
    contacts = fresh.index.get_level_values("work").str.startswith("contacts")
    roots = cells(rows, "wide, from the roots", FRESH)
    over = fresh.ours_ns / roots.ours_ns
    slow = fresh.index.get_level_values("work").isin(["planner", "slow"])
    claim((over[slow] < 0.5).all() and (over[~slow] > 0.75).all(), "keeping answers pays where little moves")
    claim(set(rows[rows.method == "recommended"].volume) == {"slab-box", "obb"}, "recommended is the rule in narrow-phase")
    claim((rows.alone == "yes").all(), "all rows of narrow-phase were timed alone")
    wrong = rows[(rows.peer != "") & (rows.differing > 0)]
    coal = wrong.method.isin(["Coal, obb", "Coal, obbrss"])
    claim((coal | (wrong.method == "OPCODE")).all() and wrong.work.str.startswith("contacts").all(), "only contacts of OPCODE and Coal differ")
    claim((rows[rows.peer == ""].differing == 0).all(), "ours agree with the reference in every frame")
    fcl = tournament.tournament(rows, "recommended", ["FCL, obb"]).set_index(tournament.PLACES).ratio
    return {"us": Interval(fresh[~contacts].ours_ns / 1e3), "fresh": Interval(fresh[~contacts].ratio),
            "coherent": Interval(coherent.ratio), "contacts": Interval(fresh[contacts].ratio),
            "contacts_fcl": Interval(fcl[contacts]), "over_most": over[~slow].max(), "over_slow": Interval(over[slow]),
            "wrong_cells": (fresh[contacts].differing > 0).sum(), "cells": contacts.sum(), "roots": Interval(roots[~contacts].ratio),
            "wrong_rows": int((~coal).sum()), "wrong_coal": int(coal.sum()), "contact_rows": ((rows.method == "OPCODE") & rows.work.str.startswith("contacts")).sum()}


@quotes("memory")
def memory(record):
    rows = records.read(record)
    crowded = rows[rows.room == rows.room.min()].set_index(["tree", "strategy"])

    def a_body_and_a_pair(tree, strategy):
        """By the line through the two rooms, in kilobytes."""
        two = rows[(rows.tree == tree) & (rows.strategy == strategy)].sort_values("near")
        pair = np.diff(two.bytes)[0] / np.diff(two.near)[0]
        return (two.bytes.iloc[0] - pair * two.near.iloc[0]) / two.objects.iloc[0] / 1e3, pair / 1e3
    (body, pair), (kept_body, kept_pair) = (a_body_and_a_pair("wide", strategy) for strategy in ("recursive", "margins"))
    held = crowded.bytes / 1e6
    return {"objects": crowded.objects.iloc[0], "near": crowded.near.iloc[0], "wide": held["wide", "recursive"], "wide_body": body,
            "wide_pair": pair, "margins": held["wide", "margins"], "margins_body": kept_body, "margins_pair": kept_pair,
            "binary": held["binary", "recursive"], "binary_body": 1e3 * held["binary", "recursive"] / crowded.objects.iloc[0]}
