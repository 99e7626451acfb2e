# SPDX-License-Identifier: BSD-3-Clause
"""The fair tournament: ours by lanes, others with the same flags and as shipped, each side by configurations fixed beforehand."""

from functools import cache

import tournament
from quoting import README, RESULTS, Interval, claim, quotes

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
    fresh = [called(name, SOURCE) for name in ("OPCODE", "FCL, obb")]
    return rows, {
        "sixteen": beside(called(OURS, SOURCE), fresh), "eight": beside(called(OURS, EIGHT), fresh),
        "one": beside(called(OURS, ONE), fresh), "roots": beside(called("wide, from the roots", SOURCE), fresh),
        "roots, one": beside(called("wide, from the roots", ONE), fresh),
        "coherent": beside(called(OURS, SOURCE), [called("OPCODE, coherent", SOURCE)]),
        "fcl": beside(called("FCL, obb", SOURCE), [called("FCL, obb", SHIPPED)]),
        "cold": beside(called(OURS, SOURCE), fresh, "cold_ns"), "tail": beside(called(OURS, SOURCE), fresh, "tail_ns")}


def written(line):
    return f"{line.ratio:.1f} ({line.low:.1f} to {line.high:.1f})"


@quotes("tournament", RESULTS,
        "| motion | polygons | us a pair: 16 lanes | 8 | 1 | fastest peer, our flags | us | times as long as 16 lanes (95 %) | as 1 lane | "
        "first frame | slowest of a hundred |")
def table(record):
    _, found = cells(record)
    lines, last = [], None
    for place, line in found["sixteen"].iterrows():
        lines.append(["" if place[0] == last else place[0], str(place[1]),
                      *(f"{found[lanes].loc[place].ours_ns / 1e3:.2f}" for lanes in ("sixteen", "eight", "one")),
                      line.fastest.removesuffix(f", {SOURCE}"), f"{line.fastest_ns / 1e3:.2f}", written(line),
                      written(found["one"].loc[place]),
                      *(f"{found[column].loc[place].ratio:.1f}" for column in ("cold", "tail"))])
        last = place[0]
    return {"rows": lines}


@quotes("tournament", RESULTS,
        "With sixteen lanes `recommended` is {sixteen:.1f} times as fast as the fastest of FCL and OPCODE compiled with the same flags, with eight {eight:.1f} "
        "times, and with one, the same program without vector registers, {one:.1f} times (from the roots {roots:.1f} and {roots_one:.1f})",
        "so width makes it {width:.1f} times as fast; without it OPCODE is faster from the roots, and `recommended` only where motion is coherent",
        "FCL compiled with our flags takes {fcl:.2f} of its time as Debian ships it")
def headline(record):
    rows, found = cells(record)
    claim(rows.seed.nunique() >= 5 and rows.repetition.nunique() >= 10, "five seeds and ten repetitions")
    claim((found["sixteen"].low > 1).all(), "sixteen lanes are faster than the fastest peer in every cell")
    claim((found["roots, one"].ratio < 1).all(), "with one lane OPCODE or FCL is faster from the roots")
    faster = set(found["one"].index[found["one"].ratio > 1].get_level_values("work"))
    claim(faster == {"planner", "slow"}, "with one lane recommended is faster where motion is coherent")
    return {"sixteen": Interval(found["sixteen"].ratio), "eight": Interval(found["eight"].ratio), "one": Interval(found["one"].ratio),
            "roots": Interval(found["roots"].ratio), "roots_one": Interval(found["roots, one"].ratio),
            "width": Interval(found["one"].ours_ns / found["sixteen"].ours_ns), "fcl": Interval(1 / found["fcl"].ratio)}


headline.also(README,
              "compiled with the same flags, it is {sixteen:.1f} times as fast as the faster of the two, and {one:.1f} times without vector registers")
