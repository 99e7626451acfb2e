# SPDX-License-Identifier: BSD-3-Clause
"""What was published as it was: the talk's tree and prices, the motions of boxes."""

import pandas as pd

from bvlab_scripts import nine_bunnies
from bvlab_plots import records
from quotes.boxes import by_radix
from quoting import Interval, at_most, claim, quotes

PRICES = [2, 10]  # of a pair of triangles, in tests of volumes
BETWEEN = 5


def speedups(rows, price):
    """Of each list over recursion, where a pair of triangles costs as much as `price` tests of volumes, mean over seeds: one
    row a build, reading and density."""
    cost = (rows.n_v + price * rows.n_p).groupby([rows[name] for name in ("build", "reading", "density", "seed", "strategy")])
    wide = cost.mean().unstack()
    return wide[nine_bunnies.LISTS].rdiv(wide[nine_bunnies.BASE], axis=0).groupby(level=["build", "reading", "density"]).mean()


@quotes("talk")
def talk(record):
    rows = records.right(record)
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
    rows = records.right(record)
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


STEPS = ["still", "down", "up", "mixed"]
TWO_RUNS = ["up_up", "up_still", "up_down", "up_mixed", "still_up", "still_still"]


def sums_of_steps(record):
    """Sums over seeds: one row a build, reading and density. The front does not depend on the strategy."""
    rows = records.read(record, needs=["step_up_runs", "two_up_up_runs"])
    rows = rows[rows.strategy == "recursive"]
    claim(all((rows[f"step_{step}_tests"] - rows[f"step_{step}_again"] == rows[f"step_{step}_entries"] - rows[f"step_{step}_runs"]).all()
              for step in ("still", "down")), "a list that never shrinks saves n - 1 tests in each still step and each step down")
    return rows.groupby(["build", "reading", "density"]).sum(numeric_only=True)


@quotes("talk")
def steps(record):
    """What a list saves in each kind of step, in units of its entries."""
    sums = sums_of_steps(record)
    runs = sum(sums[f"step_{step}_runs"] for step in STEPS)

    def saved(step, by):
        return (sums[f"step_{step}_tests"] - sums[f"step_{step}_{by}"]) / sums[f"step_{step}_entries"]
    shrinking, never = ({step: saved(step, by) for step in STEPS} for by in ("raised", "again"))
    claim((shrinking["up"] < 0).all() and (shrinking["down"] > shrinking["still"]).all() and (shrinking["still"] > 0).all(),
          "a list that may shrink saves most in steps down, less in still ones, and loses in steps up")
    claim((never["up"].abs() < 0.25).all(), "a list that never shrinks gains and loses less than a quarter of its entries in steps up")
    claim(all((never[step] > shrinking[step]).all() for step in STEPS), "in every kind of step, the list that never shrinks makes fewer tests")
    claim((never["mixed"] > 0).all(), "a list that never shrinks saves tests in mixed steps, too")
    no_growth = sums.step_up_runs + sums.step_still_runs
    return {**{f"shrinking_{step}": Interval(shrinking[step]) for step in STEPS}, **{f"never_{step}": Interval(never[step]) for step in ("up", "mixed")},
            "share_mixed": Interval(100 * sums.step_mixed_runs / runs),
            "right": Interval(100 * sums.step_up_runs / no_growth), "cells": len(sums)}


@quotes("talk")
def two_runs(record):
    """After two runs without growth: how often which, and what a rebuild in the next run costs beside the list."""
    sums = sums_of_steps(record)
    every = sums.index.get_level_values("reading").str.startswith("all")
    rebuilt = {two: sums[f"two_{two}_rebuilt"] / sums[f"two_{two}_kept"] for two in TWO_RUNS}
    # The list that is kept makes about n tests in each later run; one that is rebuilt by 2n - 1 tests makes n.
    later = {two: (sums[f"two_{two}_rebuilt"] - sums[f"two_{two}_kept"])
             / (sums[f"two_{two}_kept"] - (sums[f"two_{two}_rebuilt"] + sums[f"two_{two}_runs"]) / 2) for two in TWO_RUNS}
    runs = sum(sums[f"two_{two}_runs"] for two in TWO_RUNS)
    claim((rebuilt["up_up"] < 1).all(), "after (up, up) a rebuild takes fewer tests than the list does in the same run")
    claim((rebuilt["up_still"][every] < 1).all() and (rebuilt["up_still"][~every] > 1).all() and (rebuilt["still_up"] > 1).all(),
          "after (up, still) it does so where all bodies move, and not where one does, and after (still, up) nowhere")
    claim(all((later[two] < 1).all() for two in ("up_up", "up_still", "still_up")), "after these, a rebuild pays by the second run")
    claim((later["still_still"] > 1).all() and (rebuilt["still_still"] > 1.3).all(), "after (still, still) a rebuild does not pay by the second run")
    return {**{two: Interval(100 * sums[f"two_{two}_runs"] / runs) for two in TWO_RUNS},
            **{f"{two}_rebuilt": Interval(rebuilt[two]) for two in TWO_RUNS}, "every_rebuilt": Interval(rebuilt["up_still"][every]),
            "one_rebuilt": Interval(rebuilt["up_still"][~every]), "still_later": Interval(later["still_still"])}


@quotes("closest-features")
def closest_counts(record):
    """How vertices looked at grow with the number of faces and with motion."""
    rows = records.read(record)
    looked = (rows.n_v / rows.pairs).groupby([rows.variant, rows.degrees, rows.mesh]).median()
    slow, fast = rows.degrees.min(), rows.degrees.max()

    def grown(name, degrees):
        return looked[name, degrees, "icosphere:2000"] / looked[name, degrees, "icosphere:80"]
    coherent = [grown(name, slow) for name in ("gjk-coherent", "v-clip")]
    claim(max(coherent) < 1.25 and grown("gjk", slow) > 25, "from 80 to 2000 faces, coherent walks grow little in slow motion, and a scan by as much as the faces")
    return {"slow": slow, "fast": fast, "scan": grown("gjk", slow), "coherent": Interval(coherent),
            "coherent_fast": Interval([grown(name, fast) for name in ("gjk-coherent", "v-clip")])}


@quotes(["boxes-figure-3", "boxes-figures-4-5", "boxes-fast", "worlds"])
def box_statements(*folders):
    *figures, fast, worlds = folders
    rows = pd.concat([by_radix(folder) for folder in figures])
    rows = rows[(rows.coherent != "on") & (rows.peer == "")]
    each = rows.assign(each=rows.bytes / (rows.boxes + rows.overlaps))
    linear = each[each.set.isin(["adjacent", "sphere-sparse"])].groupby(["method", "set", "boxes"]).each.median()
    growth = linear.groupby(["method", "set"]).agg(lambda group: group.iloc[-1] / group.iloc[1])
    claim((growth < 1.3).all(), "the memory for each box or pair does not grow with the number of boxes")
    time = rows[rows.method.isin(["hash", "hybrid"])].groupby(["set", "boxes", "method"]).frame_ns.median().unstack()
    beside = time.hash / time.hybrid
    claim((beside["random"].iloc[1:].diff().dropna() > 0).all() and abs(beside["adjacent"].iloc[-1] - beside["adjacent"].iloc[0]) < 0.1,
          "HASH2 falls behind HYBRID as lists lengthen, and not on adjacent cubes")
    largest = time.loc["random"].index.max()
    pairs = rows[rows.boxes == largest].groupby("set").overlaps.median() / largest
    claim(beside["sphere-packed"].index.max() == largest and pairs["random"] > 2 * pairs["sphere-packed"],
          "the random set is more over-packed than the sphere")
    claim(beside["random"].iloc[-1] > 1.1 * beside["sphere-packed"].iloc[-1] > 1.3, "HASH2 falls behind HYBRID on the packed sphere, and farther on the random set")
    boxes = records.read(fast)
    cgal = boxes[boxes.peer.isin(["cgal", "cgal-1000"]) & (boxes.frame_ns > 0)].groupby(["set", "motion", "peer"]).frame_ns.median().unstack()
    cgal = cgal.cgal / cgal["cgal-1000"]
    claim((cgal > 1).mean() > 0.9, "the larger cutoff is faster nearly everywhere")
    bodies = records.read(worlds)
    bodies = (bodies.near / bodies.touching).groupby(bodies.objects).median()
    claim(bodies.max() < 1.05 * bodies.min(), "pairs of boxes are as many times those that touch among a thousand bodies as among ten thousand")
    return {"hybrid": Interval(linear["hybrid"]), "hash": Interval(linear["hash"]),
            "sweeps": Interval(linear[[name.startswith("sweep") for name in linear.index.get_level_values("method")]]),
            "random_least": beside["random"].iloc[0], "random_most": beside["random"].iloc[-1],
            "adjacent_least": beside["adjacent"].iloc[-1], "adjacent_most": beside["adjacent"].iloc[0],
            "packed_most": beside["sphere-packed"].iloc[-1], "largest": int(largest), "random_pairs": pairs["random"], "packed_pairs": pairs["sphere-packed"],
            "cutoff": Interval(cgal), "cutoff_middle": cgal.median(), "over": Interval(bodies)}
