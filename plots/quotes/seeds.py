# SPDX-License-Identifier: BSD-3-Clause
"""What was published as it was: the talk's tree and prices, the motions of boxes."""

import numpy as np

from bvlab_scripts import nine_bunnies
from bvlab_scripts.nine_bunnies import BASE
from bvlab_plots import provenance, records
from quoting import Interval, at_most, claim, quotes

PRICES = [2, 10]  # of a pair of triangles, in tests of volumes
BETWEEN = 5


def speedups(rows, price):
    """Of each list over recursion, by cost, mean over seeds: one row a build, reading and density."""
    return nine_bunnies.saved_by_cost(rows, price).groupby(level=["build", "reading", "density"]).mean()


@quotes("talk")
def talk(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    tests, low, high = (speedups(rows, price) for price in (0, *PRICES))
    published = nine_bunnies.PUBLISHED.mean()

    def of(table, readings, build="bottom-up"):
        return table.loc[build].loc[readings]
    one = ["one body, one freedom", "one body, all freedoms"]
    priced = [of(table, one) for table in (low, high)]
    every = [of(table, ["all bodies, all freedoms"]) for table in (low, high)]
    rejecting = [of(table, ["one body, one freedom, rejecting"]) for table in (low, high)]
    claim(all((table.deferred > table["separation-list"]).all() for table in priced), "deferring pays where one body moves")
    trees = [table.loc["top-down-principal"] / table.loc["bottom-up"] for table in (low, high)]

    def both(tables, name):
        return Interval([value for table in tables for value in table[name]])
    time = rows.groupby(["build", "reading", "density", "seed", "strategy"]).time_ns.median().unstack()
    reached = ((time.recursive / time["separation-list"] >= 1.40) & (time.recursive / time.deferred >= 1.84)).sum()
    claim(reached == 0, "no run with the talk's tree reaches both published speedups in time")
    claim(rows.seed.nunique() == 5, "five seeds")

    def both_reached(table):
        cells = of(table, one)
        return int(((cells["separation-list"] >= 1.40) & (cells.deferred >= 1.84)).sum())
    middle = speedups(rows, BETWEEN)
    claim(both_reached(tests) == 3 and both_reached(low) == 1, "both published speedups come out in three of four cells in tests, and in one at the lowest price")
    claim(both_reached(middle) == both_reached(high) == 0, "at five tests and more neither cell reaches both")
    talks = time.xs("bottom-up", level="build")
    return {"best_list": (talks.recursive / talks["separation-list"]).max(), "best_deferred": (talks.recursive / talks.deferred).max(),
            "low": PRICES[0], "high": PRICES[1], "between": BETWEEN, "cells": len(of(tests, one)),
            **{f"reached_{name}": both_reached(table) for name, table in (("tests", tests), ("low", low), ("high", high))},
            "list": both(priced, "separation-list"), "deferred": both(priced, "deferred"),
            "published_list": published["recursive"] / published["separation-list"],
            "published_deferred": published["recursive"] / published["deferred"],
            "list_tests": Interval(of(tests, one)["separation-list"]), "deferred_tests": Interval(of(tests, one).deferred),
            "tree": at_most(100 * max((ratio - 1).abs().to_numpy().max() for ratio in trees), 1),
            "every_list": both(every, "separation-list"), "every_deferred": both(every, "deferred"),
            "reject_list": both(rejecting, "separation-list"), "reject_deferred": both(rejecting, "deferred")}


@quotes("boxes-motions")
def boxes_motions(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    rows = rows[(rows.peer == "") & (rows.frame_ns > 0)]
    cell = ["set", "boxes", "motion", "method"]
    wide = rows.groupby([*cell, "coherent"]).frame_ns.median().unstack("coherent")
    saved = (wide["on"] / wide["off"]).dropna().reset_index(name="left")
    sweeps = saved[saved.method.str.startswith("sweep")].left
    claim(sweeps.median() > 0.9, "coherence saves sweeps next to nothing after radix sort")
    claim(rows.set.nunique() == 2 and set(rows.set) == {"adjacent", "sphere-sparse"}, "adjacent cubes and the sparse sphere")
    by_motion = wide.drop("blocks", level="method").stack().unstack("motion")
    apart = by_motion.max(axis=1) / by_motion.min(axis=1)
    fastest = by_motion.groupby(["set", "boxes", "coherent"]).idxmin().applymap(lambda place: place[2])
    changed = fastest.nunique(axis=1) > 1
    claim(changed.sum() == 2 and apart.idxmax()[2] == "sweep3", "the motion changes which method is fastest in two cases, and SWEEP3's time most")
    return {"apart": apart.max(), "apart_method": apart.idxmax()[2].upper(), "changed": int(changed.sum()), "cases": len(changed), "sweeps": Interval(sweeps), "middle": sweeps.median(), "blocks": Interval(saved[saved.method == "blocks"].left)}


@quotes("boxes-motions-packed")
def boxes_motions_packed(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    rows = rows[(rows.peer == "") & (rows.frame_ns > 0)]
    time = rows.groupby(["set", "boxes", "method", "coherent", "motion"]).frame_ns.median().unstack("coherent")
    published = time.drop("blocks", level="method")
    by_motion = published["off"].unstack("motion")
    fastest = by_motion.groupby(["set", "boxes"]).idxmin().applymap(lambda place: place[2])
    claim((fastest.nunique(axis=1) > 1).sum() == 1 and set(fastest.loc[fastest.nunique(axis=1) > 1].iloc[0]) == {"hybrid", "sweep1"},
          "the fastest published method depends on the motion in one case, where it is HYBRID or SWEEP1")
    over = time["on"].xs("blocks", level="method") / time["off"].xs("blocks", level="method")
    worst = rows[rows.method == "blocks"].groupby(["set", "boxes", "motion", "coherent"])[["p99_ns", "frame_ns"]].median().unstack("coherent")
    begins = worst.p99_ns["on"] / worst.frame_ns["off"]
    begins = begins[over > 1.1]
    claim(len(begins) == 3 and begins.min() > 5, "the slowest frame of following costs as much as many from scratch, where following costs more")
    return {"dear": len(begins), "cells": len(over), "begins": Interval(begins), "apart": by_motion.max(axis=1).div(by_motion.min(axis=1)).max(), "left": Interval(published["on"] / published["off"]),
            "blocks": Interval(over), "frames": rows.frames.iloc[0]}


def unit_costs(rows):
    """C_u, C_v, C_p in nanoseconds: those by which recursions' times are off least, in squares of shares; none below 0."""
    rows = rows[rows.strategy == BASE]
    shares = rows[["n_u", "n_v", "n_p"]].to_numpy(float) / rows.time_ns.to_numpy()[:, None]
    costs, used = np.zeros(3), [0, 1, 2]
    while used:
        found = np.linalg.lstsq(shares[:, used], np.ones(len(rows)), rcond=None)[0]
        if (found >= 0).all():
            costs[used] = found
            break
        del used[int(np.argmin(found))]
    return costs


def prices(rows):
    """C_p over C_v by four regressions: of recursions alone or of all strategies, of shares of the time or of the time."""
    found = [np.divide(*unit_costs(rows.assign(strategy=BASE) if every else rows)[[2, 1]]) for every in (False, True)]
    for part in (rows[rows.strategy == BASE], rows):
        costs = np.linalg.lstsq(part[["n_u", "n_v", "n_p"]].to_numpy(float), part.time_ns.to_numpy(float), rcond=None)[0]
        found.append(costs[2] / costs[1])
    return found


@quotes("talk-scalar")
def talk_scalar(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    one, every = ["one body, one freedom", "one body, all freedoms"], ["all bodies, all freedoms"]
    cell = ["program", "reading", "density"]
    found = {}
    for name, measure in (("time", "time_ns"), ("tests", "n_v")):
        table = rows.groupby([*cell, "seed", "strategy"])[measure].median().unstack("strategy")
        found[name] = table.rdiv(table.recursive, axis=0).groupby(level=cell).mean()
    dear = {program: Interval(prices(rows[rows.program == program])) for program in set(rows.program)}
    claim(dear["unoptimised"].least < dear["optimised"].most / 1.5, "a price depends on the build, and on the regression")

    reached = found["time"].loc["unoptimised"].loc[one]
    runs = rows.groupby([*cell, "seed", "strategy"]).time_ns.median().unstack("strategy")
    runs = runs.rdiv(runs.recursive, axis=0)
    both = (runs["separation-list"] >= 1.40) & (runs.deferred >= 1.84)
    claim(reached["separation-list"].max() >= 1.40 and reached.deferred.max() < 1.84, "unoptimised code reaches the list's speedup, not deferring's")

    def of(what, program, readings, name):
        return Interval(found[what].loc[program].loc[readings][name])
    rejecting = ["one body, one freedom, rejecting"]
    return {"both": int(both.loc["unoptimised"].sum()), "runs": len(both.loc["unoptimised"]), "processor": provenance.processor_of(provenance.machine_of(record)),
            "reject_list": of("time", "unoptimised", rejecting, "separation-list"), "reject_deferred": of("time", "unoptimised", rejecting, "deferred"),
            "reached": int((reached["separation-list"] >= 1.40).sum()), "cells": len(reached), "plain": dear["unoptimised"], "optimised": dear["optimised"],
            "plain_list": of("time", "unoptimised", one, "separation-list"), "list": of("time", "optimised", one, "separation-list"),
            "plain_deferred": of("time", "unoptimised", one, "deferred"), "deferred": of("time", "optimised", one, "deferred"),
            "tests_list": of("tests", "optimised", one, "separation-list"), "tests_deferred": of("tests", "optimised", one, "deferred"),
            "every_list": of("time", "unoptimised", every, "separation-list"), "every_deferred": of("time", "unoptimised", every, "deferred")}


def left_by_coherence(record):
    """Time with coherence over that without, one a program, sort, set, number, motion and sweep."""
    rows = records.read(record)
    records.wrong_answers(rows)
    rows = rows[(rows.frame_ns > 0) & rows.method.str.startswith("sweep")]
    wide = rows.groupby(["program", "sort", "set", "boxes", "motion", "method", "coherent"]).frame_ns.median().unstack("coherent")
    return (wide["on"] / wide["off"]).dropna()


@quotes("boxes-sorts")
def boxes_sorts(record):
    left = left_by_coherence(record)
    found = {}
    for name, program, sort in (("plain", "unoptimised", "comparison"), ("optimised", "optimised", "comparison"),
                                ("plain_radix", "unoptimised", "radix"), ("radix", "optimised", "radix")):
        values = left.loc[program].loc[sort]
        found[name], found[f"{name}_middle"] = Interval(values), values.median()
    third = left[left <= 2 / 3]
    claim(set(third.index.droplevel(["set", "boxes", "motion", "method"])) == {("optimised", "comparison")} and set(third.index.get_level_values("boxes")) == {1000},
          "sweeps save a third only after a comparison sort of a thousand boxes in optimised code")
    claim(max(found["optimised_middle"], found["plain_middle"]) < 0.9 < min(found["plain_radix_middle"], found["radix_middle"]),
          "after a comparison sort coherence saves sweeps more than after a radix sort")
    return {**found, "saved": 100 * (1 - left.min()), "third": len(third), "cells": len(left.loc["optimised"].loc["comparison"])}
