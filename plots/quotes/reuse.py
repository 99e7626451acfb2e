# SPDX-License-Identifier: BSD-3-Clause
"""What reuse of a front is worth, as a function of coherence and fan-out."""

from bvlab_scripts import fan_outs
from quoting import Interval, claim, quotes

NAMES = {"separation-list": "list", "deferred": "deferred", "raise": "raise", "margins": "margins"}
FAN_OUTS = (2, 4, 8, 16)
WORDS = dict(zip(FAN_OUTS, ("two", "four", "eight", "sixteen")))


def savings(cells, what, name, motion):
    return fan_outs.savings(cells, what, name).xs(motion, level="motion")


@quotes("fan-outs")
def reuse(record):
    cells = fan_outs.read(record)
    rest = fan_outs.at_rest(cells)
    rows = fan_outs.all_rows(record)
    claim((rows.alone == "yes").all(), "the times of fan-outs are of rows that were alone")
    claim({41, 42} < {*rows.seed}, "seeds 41 and 42, those of the earlier records, are among those of fan-outs")
    found = {word: Interval(rest.xs(fan_out, level="fan_out")) for fan_out, word in WORDS.items()}
    for name, short in NAMES.items():
        for what, measure in (("n_v", ""), ("time_ns", "_time")):
            values = savings(cells, what, name, fan_outs.SLOW)
            for fan_out in (2, 16):
                found[f"{short}_{WORDS[fan_out]}{measure}"] = Interval(values.xs(fan_out, level="fan_out"))
    lists = [savings(cells, "n_v", name, motion) for name in ("separation-list", "deferred") for motion in fan_outs.FAST]
    raised = [savings(cells, "n_v", "raise", motion) for motion in fan_outs.FAST]
    claim(all((values < 1).all() for values in lists), "in tests lists lose everywhere from 5 degrees per frame on")
    time = cells.time_ns.unstack("strategy")
    fastest = time.idxmin(axis=1)
    slow = fastest.xs(fan_outs.SLOW, level="motion")
    claim((slow == "margins").all(), "margins are the fastest strategy in every cell at 0.03 degrees")
    fast = fastest[fastest.index.get_level_values("motion").isin(fan_outs.FAST)]
    besides = fast[fast != "recursive"]
    claim(set(zip(besides.index.get_level_values("volume"), besides.index.get_level_values("fan_out"))) == {("sphere", 2)},
          "what recursion is not fastest for from 5 degrees on are lists on binary sphere trees")
    faster = [part[part > 1] for part in (fan_outs.savings(cells, "time_ns", name) for name in fan_outs.KEEPING)]
    faster = {name: part[part.index.get_level_values("motion").isin(fan_outs.FAST)] for name, part in zip(fan_outs.KEEPING, faster)}
    claim(len(faster["raise"]) == len(faster["margins"]) == 0, "raise and margins never gain time from 5 degrees on")
    gaining = faster["separation-list"].index.union(faster["deferred"].index)
    claim(set(gaining) == set(besides.index), "from 5 degrees on, a list gains time where recursion is not the fastest, and nowhere else")
    middle, middle_time = (table.xs("0.003 / 0.3", level="motion") for table in (fastest, time))
    claim(set(middle) <= {"separation-list", "deferred", "margins"}, "at 0.3 degrees lists or margins are fastest")
    triangles = savings(cells, "n_p", "margins", fan_outs.SLOW)
    claim((triangles < savings(cells, "n_v", "margins", fan_outs.SLOW)).all(), "margins save fewer triangle tests than volume tests at 0.03 degrees")
    for fan_out in (2, 16):
        found[f"margins_triangles_{WORDS[fan_out]}"] = Interval(triangles.xs(fan_out, level="fan_out"))
    middle_triangles = savings(cells, "n_p", "margins", "0.003 / 0.3")
    claim((middle_triangles > 1).all(), "margins save triangle tests at 0.3 degrees, too")
    found["middle_triangles"], found["middle_triangles_median"] = Interval(middle_triangles), middle_triangles.median()
    found["list_triangles"] = Interval([v for name in ("separation-list", "deferred") for v in fan_outs.savings(cells, "n_p", name)])
    change = savings(cells, "n_v", "margins", fan_outs.SLOW).unstack("fan_out")
    change = change[16] / change[2]
    alike = fan_outs.within_a_third(change)
    claim((change > 1).all() and alike.mean() < 0.75, "margins save more at fan-out 16 than at 2, within a third in less than three of four cells")
    failing = [number for number, holds, _ in fan_outs.judged(cells) if not holds]
    claim(failing == [4], "of the hypotheses the fourth alone fails")
    others = [volume for volume in dict.fromkeys(rows.volume) if volume != "sphere"]
    survival_of = [100 * fan_outs.survival(record, [volume])[3] for volume in others]
    claim(100 * fan_outs.survival(record, ["sphere"])[3] > max(survival_of), "at 5 degrees fronts of spheres survive best")
    gain = fan_outs.savings(cells, "time_ns", "deferred").xs(fan_outs.SLOW, level="motion")
    claim((gain.xs(2, level="fan_out") > 1).all(), "deferring pays in time on binary trees")
    recursion = cells.xs("recursive", level="strategy")
    return {**found, "fast_lists": Interval([v for values in lists for v in values]), "fast_raise": Interval([v for values in raised for v in values]),
            "middle_margins": Interval(savings(cells, "n_v", "margins", "0.003 / 0.3")),
            "middle_margins_time": Interval(savings(cells, "time_ns", "margins", "0.003 / 0.3")),
            "recursive_fast": (fast == "recursive").sum(), "fast_cells": len(fast),
            "alike": int(alike.sum()), "unlike": int((change > 4 / 3).sum()), "alike_cells": len(alike), "change": Interval(change), "holding": 7 - len(failing), "seeds": rows.seed.nunique(),
            "list_wins_fast": len(besides), "list_best_fast": max(part.max() for part in faster.values()),
            "middle_lists": int((middle != "margins").sum()), "middle_margins_best": int((middle == "margins").sum()), "middle_cells": len(middle),
            "middle_lose": int((middle_time.margins > middle_time.recursive).sum()),
            "survival_spheres": 100 * fan_outs.survival(record, ["sphere"])[3], "survival_others": Interval(survival_of),
            "repetitions": rows.repetition.nunique(),
            **{f"recursion_{WORDS[fan_out]}": Interval(relative) for fan_out, relative in recursion_beside_binary(recursion).items()},
            **{f"survival_{i}": 100 * share for i, share in enumerate(fan_outs.survival(record))}}


def recursion_beside_binary(recursion):
    """By fan-out, the median over cells of a recursion's time on binary trees over its time there, one a motion."""
    table = recursion.time_ns.unstack("fan_out")
    return {fan_out: (table[2] / table[fan_out]).groupby("motion").median() for fan_out in (4, 8, 16)}


def ratio(value):
    return f"{value:.2f}" if value < 9.95 else f"{value:.0f}"


@quotes("fan-outs")
def reuse_table(record):
    """A row for each motion and strategy: savings in tests and in time, medians over volumes and frames of comparison."""
    cells = fan_outs.read(record)
    lines = []
    for motion in fan_outs.MOTIONS:
        for name in fan_outs.KEEPING:
            tests, time = (savings(cells, what, name, motion).groupby("fan_out").median() for what in ("n_v", "time_ns"))
            lines.append([fan_outs.LABELS[motion] if name == fan_outs.KEEPING[0] else "", name,
                          *(f"{ratio(tests[fan_out])}, {ratio(time[fan_out])}" for fan_out in FAN_OUTS)])
    return {"rows": lines}


COUNTED = {"recursive": "recursion", "separation-list": "list", "margins": "margins"}


@quotes("fan-outs")
def counts(record):
    """The terms of the cost per pair and frame in world coordinates, medians over volumes."""
    cells = fan_outs.read(record).xs("world", level="frame")
    lines = []
    for motion in fan_outs.MOTIONS:
        for name, shown in COUNTED.items():
            found = cells.xs((motion, name), level=("motion", "strategy"))
            numbers = [found[term].div(found.pairs).groupby("fan_out").median()[fan_out] for fan_out in (2, 16) for term in ("n_u", "n_v", "n_p")]
            lines.append([fan_outs.LABELS[motion] if name == "recursive" else "", shown, *(f"{n:.0f}" if n >= 9.5 else f"{n:.1f}" for n in numbers)])
    return {"rows": lines}


def cycle(ratio, deferral):
    """What a list saves at rest: a rebuild, at recursion's cost, after every `deferral` runs without growth."""
    return (deferral + 1) * ratio / (ratio + deferral)


@quotes("fan-outs")
def cycles(record):
    """The counting argument beside the measured savings at rest, from each cell's own ratio of recursion to list."""
    cells = fan_outs.read(record)
    rest = fan_outs.at_rest(cells)
    found, off = {}, []
    for name, deferral in (("separation-list", 1), ("deferred", 2)):
        measured = fan_outs.savings(cells.xs("rest", level="motion", drop_level=False), "n_v", name)
        said = cycle(rest, deferral)
        off.append((measured / said - 1).abs().max())
        for fan_out, word in WORDS.items():
            found[f"{NAMES[name]}_{word}"] = Interval(measured.xs(fan_out, level="fan_out"))
    claim(max(off) < 0.02, "the counting argument gives what lists save at rest to two per cent")
    return {**found, "off": 100 * max(off), "rows": [
        [str(fan_out), f"{fan_out / (fan_out - 1):.2f}", *(f"{cycle(fan_out / (fan_out - 1), d):.2f}" for d in (1, 2)),
         *(format(found[f"{name}_{word}"], ".2f") for name in ("list", "deferred")), format(Interval(rest.xs(fan_out, level="fan_out")), ".2f")]
        for fan_out, word in WORDS.items()]}


LETTERS = {"separation-list": "S", "deferred": "D", "raise": "U"}
FAMILIES = {"recursion": ["recursive"], "a list": ["separation-list", "deferred", "raise"], "margins": ["margins"]}


@quotes("fan-outs")
def fastest(record):
    """By motion and family of strategies the configuration of the least time per pair, median over volumes."""
    cells = fan_outs.read(record)
    time = (cells.time_ns / cells.pairs).groupby(["motion", "strategy", "fan_out", "frame"]).median()
    lines, binary, frames, least = [], [], [], {}
    for motion in fan_outs.MOTIONS:
        line = [fan_outs.LABELS[motion]]
        for strategies in FAMILIES.values():
            part = time[motion][lambda values, strategies=strategies: values.index.get_level_values("strategy").isin(strategies)]
            strategy, fan_out, frame = part.idxmin()
            line.append(f"{part.min() / 1e3:.2f} ({LETTERS[strategy] + ', ' if len(strategies) > 1 else ''}{fan_out}, {frame})")
            least[motion, strategies[0]] = part.min() / 1e3
            binary += [fan_out == 2] * (len(strategies) > 1)
            if motion != "rest":  # where posed volumes are kept
                frames.append(frame)
        lines.append(line)
    claim(all(binary), "every best list is on a binary tree")
    claim({*frames} == {"body"}, "in motion every fastest configuration compares in a body's frame")
    slow, middle = ["rest", fan_outs.SLOW, "0.003 / 0.3"], "0.003 / 0.3"
    claim(all(least[motion, "separation-list"] < least[motion, "recursive"] for motion in slow),
          "a binary list beats recursion on any tree at rest and in slow motion")
    claim(all(least[motion, "margins"] < least[motion, "separation-list"] for motion in slow), "margins are faster than both at rest and up to 0.3 degrees")
    claim(all(least[motion, "recursive"] < least[motion, name] for motion in fan_outs.FAST for name in ("separation-list", "margins")),
          "recursion is the fastest family in fast motion")
    return {"rows": lines, "list_slow": least[fan_outs.SLOW, "separation-list"], "recursion_slow": least[fan_outs.SLOW, "recursive"],
            "margins_slow": least[fan_outs.SLOW, "margins"], "list_middle": least[middle, "separation-list"],
            "recursion_middle": least[middle, "recursive"], "margins_middle": least[middle, "margins"],
            "lead_middle": 100 * (least[middle, "separation-list"] / least[middle, "margins"] - 1)}
