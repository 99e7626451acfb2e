# SPDX-License-Identifier: BSD-3-Clause
"""The nine bunnies: what lists save, by what "moving randomly" means."""

import nine_bunnies
from quoting import README, RESULTS, Interval, claim, quotes, stated

READINGS = {
    "one body, one freedom": "one body a step, in one degree of freedom",
    "one body, all freedoms": "one body a step, in all",
    "all bodies, one freedom": "all bodies, each in one degree of freedom",
    "all bodies, all freedoms": "all bodies, in all",
    "one body, one freedom, rejecting": "one body, one degree, moves into contact rejected",
    "all bodies, all freedoms, rejecting": "all bodies, all degrees, rejected",
}
MEASURES = {"n_v": "tests", "time_ns": "time"}


def saved(record):
    """What each list saves, mean over seeds: one row a reading and density, columns (measure, strategy)."""
    runs = nine_bunnies.read(record)
    return runs, {what: nine_bunnies.speedups(runs, what).groupby(level=["reading", "density"], sort=False).mean()
                  for what in MEASURES}


@quotes("nine-bunnies", RESULTS, '| "moving randomly" means | density | list: N<sub>v</sub>, time | deferred: N<sub>v</sub>, time |')
def table(record):
    _, means = saved(record)
    rows, last = [], None
    for reading, density in means["n_v"].index:
        cells = [", ".join(f"{means[what].loc[(reading, density), name]:.2f}" for what in MEASURES)
                 for name in nine_bunnies.LISTS]
        rows.append(["" if reading == last else READINGS.get(reading, reading), density, *cells])
        last = reading
    return {"rows": rows}


@quotes("nine-bunnies", RESULTS,
        "Published: {published_list:.2f} times as fast with the list, {published_deferred:.2f} deferred. What is saved here",
        "where one body moves a step: {list:.1f} with the list and {deferred:.2f} deferred")
def speedups(record):
    runs, means = saved(record)
    tests = means["n_v"]
    passing = [reading for reading in READINGS if "rejecting" not in reading]
    one = tests.loc[[reading for reading in passing if reading.startswith("one")]]
    every = tests.loc[[reading for reading in passing if reading.startswith("all")]]
    published = nine_bunnies.PUBLISHED.mean()
    claim((one.deferred > one["separation-list"]).all(), "deferring pays where one body moves a step")
    claim((every.deferred < 1.01 * every["separation-list"]).all(), "deferring saves no more tests where all bodies move")
    claim((means["time_ns"] < tests).loc[passing[:3]].all(axis=None), "time follows less than N_v")
    claim(runs.seed.nunique() == 10, "ten runs")
    return {"published_list": published["recursive"] / published["separation-list"],
            "published_deferred": published["recursive"] / published["deferred"],
            "list": Interval(one["separation-list"]), "deferred": Interval(one.deferred),
            "frames": runs.frames.iloc[0]}


speedups.also(README,
              "ten runs of {frames:d} frames: whether a separation list helps",
              "lines are the published speedups ({published_list:.2f} and {published_deferred:.2f}, in time)",
              "The talk's speedups ({published_list:.2f} and {published_deferred:.2f}) come out, in volume tests, where one body "
              "moves a step: {list:.1f} with the list and {deferred:.2f} deferred.")
stated(README, "a definition's", "Nine bunnies of 500 polygons")
stated(README, "a version", "Debian 12", "C++20")
stated(README, "the program's numbering and dimensions", "page in 3D", "(0,1) (0,2) ... (1,2) ...")
stated(README, "what is demanded", "the column `differing` must be 0")
