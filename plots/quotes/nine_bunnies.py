# SPDX-License-Identifier: BSD-3-Clause
"""The nine bunnies: what lists save, by what "moving randomly" means."""

from bvlab_scripts import nine_bunnies
from quoting import Interval, claim, quotes

READINGS = {
    "one body, one freedom": "one body a step, in one degree of freedom",
    "one body, all freedoms": "one body a step, in all",
    "all bodies, one freedom": "all bodies, each in one degree of freedom",
    "all bodies, all freedoms": "all bodies, in all",
    "one body, one freedom, rejecting": "one body, one degree, moves into contact rejected",
    "all bodies, all freedoms, rejecting": "all bodies, all degrees, rejected",
}
SHORT = dict(zip(READINGS.values(), ("one body, one freedom", "one body, all", "all bodies, one", "all bodies, all", "one, one, rejected",
                                     "all, all, rejected")))
MEASURES = {"n_v": "tests", "time_ns": "time"}


def saved(record):
    """What each list saves, mean over seeds: one row a reading and density, columns (measure, strategy)."""
    runs = nine_bunnies.read(record)
    return runs, {what: nine_bunnies.mean_speedups(runs, what) for what in MEASURES}


@quotes("nine-bunnies")
def nine_bunnies_table(record):
    _, means = saved(record)
    rows, last = [], None
    for reading, density in means["n_v"].index:
        cells = [", ".join(f"{means[what].loc[(reading, density), name]:.2f}" for what in MEASURES)
                 for name in nine_bunnies.LISTS]
        rows.append(["" if reading == last else READINGS.get(reading, reading), density, *cells])
        last = reading
    short = [[row[0] and SHORT[row[0]], *row[1:]] for row in rows]
    return {"rows": rows, "short_rows": short}


@quotes("nine-bunnies")
def speedups(record):
    runs, means = saved(record)
    tests, time = means["n_v"], means["time_ns"]
    passing = [reading for reading in READINGS if "rejecting" not in reading]
    moves_one, moves_all = ([reading for reading in passing if reading.startswith(bodies)] for bodies in ("one", "all"))
    one, every, one_time, every_time = tests.loc[moves_one], tests.loc[moves_all], time.loc[moves_one], time.loc[moves_all]
    claim((one.deferred > one["separation-list"]).all(), "deferring pays where one body moves in a step")
    claim((every.deferred < 1.01 * every["separation-list"]).all(), "deferring saves no more tests where all bodies move")
    claim((time < tests).loc[passing[:3]].all(axis=None), "time follows less than N_v")
    deferring = time.deferred / time["separation-list"]
    claim((deferring.loc[passing[:3]] > 1.03).all() and ((deferring.loc[passing[3:]] - 1).abs() < 0.03).all(),
          "in time deferring is better, but where all bodies move in all freedoms it makes no difference")
    rejected = time.loc[["all bodies, all freedoms, rejecting"]]
    refused = tests.loc[["all bodies, all freedoms, rejecting"]]
    claim(all((table.deferred < table["separation-list"]).all() for table in (rejected, refused)),
          "deferring is not better, in time or tests, where all bodies move and moves are rejected")
    saved_triangles = nine_bunnies.mean_speedups(runs, "n_p").loc[one.index, nine_bunnies.LISTS]
    claim((saved_triangles < one[nine_bunnies.LISTS]).all(axis=None), "lists save fewer triangle tests than volume tests where one body moves in a step")
    claim(runs.seed.nunique() == 10, "ten runs")
    return {"published_list": nine_bunnies.SPEEDUPS["separation-list"], "published_deferred": nine_bunnies.SPEEDUPS["deferred"],
            "list": Interval(one["separation-list"]), "deferred": Interval(one.deferred),
            "every_list": Interval(every["separation-list"]), "every_deferred": Interval(every.deferred),
            "triangles": Interval(saved_triangles.to_numpy().ravel()),
            "every_list_time": Interval(every_time["separation-list"]), "every_deferred_time": Interval(every_time.deferred),
            "one_list_time": Interval(one_time["separation-list"]), "one_deferred_time": Interval(one_time.deferred),
            "frames": runs.frames.iloc[0]}


@quotes("nine-bunnies")
def each_run(record):
    """In how many runs a list is worth what was published, and in how many it loses."""
    runs = nine_bunnies.read(record)
    time, tests = (nine_bunnies.speedups(runs, what) for what in ("time_ns", "n_v"))
    each = nine_bunnies.PUBLISHED[nine_bunnies.LISTS].rdiv(nine_bunnies.PUBLISHED[nine_bunnies.BASE], axis=0)

    def reached(table):
        return (table[nine_bunnies.LISTS] >= nine_bunnies.SPEEDUPS.round(2)).all(axis=1).sum()
    claim(reached(time) == 0, "no run reaches both published speedups in time")
    return {"runs": len(time), "time_reached": reached(time), "tests_reached": reached(tests),
            "list_loses": (time["separation-list"] < 1).sum(), "deferred_loses": (time.deferred < 1).sum(),
            "list_loses_tests": (tests["separation-list"] < 1).sum(), "deferred_loses_tests": (tests.deferred < 1).sum(),
            "best_list": time["separation-list"].max(), "best_deferred": time.deferred.max(),
            "list_each": Interval(each["separation-list"]), "deferred_each": Interval(each["deferred"])}
