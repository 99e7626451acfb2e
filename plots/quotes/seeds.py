# SPDX-License-Identifier: BSD-3-Clause
"""What was published as it was: the talk's tree and prices, the motions of boxes."""

from bvlab_scripts import nine_bunnies
from bvlab_plots import records
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
