# SPDX-License-Identifier: BSD-3-Clause
"""The narrow phase beside OPCODE and FCL, each side by one configuration fixed beforehand."""

from functools import cache

import numpy as np

import records
import tournament
from quoting import README, RESULTS, Interval, claim, quotes

FRESH, COHERENT = ["OPCODE", "FCL, obb"], ["OPCODE, coherent"]


@cache
def recommended_beside(record):
    """The rows of the record, and `recommended` beside those that start from the roots and beside those that are coherent."""
    rows = tournament.read(record)
    return rows, cells(rows, "recommended", FRESH), cells(rows, "recommended", COHERENT)


def cells(rows, ours, theirs):
    return tournament.tournament(rows, ours, theirs).set_index(tournament.PLACES)


@quotes("narrow-phase", RESULTS,
        "| motion | polygons | from the roots (us) | the fastest of FCL and OPCODE | times as long (95 %) | recommended (us) | "
        "OPCODE's coherence: times as long (95 %) |")
def table(record):
    rows, recommended, coherent = recommended_beside(record)
    fresh = cells(rows, "wide, from the roots", FRESH)
    lines, last = [], None
    for place, line in fresh.iterrows():
        beside = coherent.loc[place] if place in coherent.index else None
        lines.append(["" if place[0] == last else place[0], str(place[1]), f"{line.ours_ns / 1e3:.2f}", line.fastest,
                      f"{line.ratio:.1f} ({line.low:.1f} to {line.high:.1f})", f"{recommended.loc[place].ours_ns / 1e3:.2f}",
                      "" if beside is None else f"{beside.ratio:.1f} ({beside.low:.1f} to {beside.high:.1f})"])
        last = place[0]
    claim((fresh.low > 1).all() and (recommended.low > 1).all(), "ours is faster than the fastest of FCL and OPCODE in every cell")
    claim((coherent.low > 1).all(), "recommended is faster than OPCODE with its coherence in every cell")
    return {"rows": lines}


@quotes("narrow-phase", RESULTS,
        "Whether two bunnies touch `recommended` says in {us:.2f} us, {fresh:.1f} times as fast as the fastest of FCL and OPCODE from the roots and "
        "{coherent:.1f} times as fast as OPCODE with its coherence; all contacts it finds {contacts:.1f} times as fast as the fastest of them")
def headline(record):
    _, fresh, coherent = recommended_beside(record)
    contacts = fresh.index.get_level_values("work").str.startswith("contacts")
    return {"us": Interval(fresh[~contacts].ours_ns / 1e3), "fresh": Interval(fresh[~contacts].ratio),
            "coherent": Interval(coherent.ratio), "contacts": Interval(fresh[contacts].ratio)}


headline.also(README,
              "`--recommended` says in {us:.2f} us whether two bunnies touch, {fresh:.1f} times as fast as the fastest of OPCODE and FCL, and "
              "{coherent:.1f} times as fast as OPCODE with its temporal coherence")


@quotes("memory", RESULTS,
        "{objects:d} bunnies, {near:d} pairs near each other, hold {wide:.0f} MB of the heap as wide trees in the bodies' own frames "
        "({wide_body:.1f} KB a body and {wide_pair:.1f} a near pair), {margins:.0f} with margins ({margins_body:.1f} and {margins_pair:.1f}), and "
        "{binary:.0f} as binary oriented boxes posed into the world, {binary_body:.0f} KB a body")
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
