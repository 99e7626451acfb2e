# SPDX-License-Identifier: BSD-3-Clause
"""The law on heaps of meshes as Bullet's simulation moves them: tests and time, beside opponents, with intervals.

usage: plots/script law-bullet RECORD

What is predicted from what is said in experiments/definitions/law-bullet.md, whose hypotheses are numbered in what is
printed. Sources, opponents and intervals are those of law_unseen.py.
"""

import argparse

import numpy as np
import pandas as pd

from bvlab_scripts import law_unseen
from bvlab_plots import records
from bvlab_plots.hypotheses import print_hypotheses
from bvlab_scripts.law_unseen import LAST, LAW, OTHERS, PREFIX, SAME
from bvlab_plots.refused import Refused

COSTS = ["n_u", "n_v", "n_p"]


def read(record):
    """As law_unseen.read, a mesh being the setting."""
    return law_unseen.read(record, setting=("mesh",))


def unit_costs(rows):
    """Nanoseconds of a posing, a test of volumes and one of triangles: least squares of shares."""
    shares = rows[COSTS].to_numpy(float) / rows.time_ns.to_numpy()[:, None]
    return np.maximum(np.linalg.lstsq(shares, np.ones(len(rows)), rcond=None)[0], 0)


def raw(record):
    """Counts and times of the prefix and of what follows, one row a run and strategy."""
    rows = records.read(record)
    if rows.time_ns.isna().any():
        raise Refused(f"{record}: holds counts alone, no times")
    keys = ["mesh", "seed", "query", "volume", "strategy"]
    rows = rows.groupby([*keys, "frames"], sort=False)[[*COSTS, "time_ns"]].median().reset_index()
    short, long = (rows[rows.frames == length].set_index(keys) for length in sorted(rows.frames.unique()))
    return short, long


def times(record, runs, said):
    """Speedups in time, measured and predicted: one row a cell of `runs`, in its order."""
    short, long = raw(record)
    later = long.time_ns - short.time_ns
    costs = {key: unit_costs(part) for key, part in short.reset_index().groupby(["query", "volume"])}
    found = []
    for row, tests_saved in zip(runs.measured.itertuples(), said[PREFIX][LAW]):
        place = (row.mesh, row.seed, row.query, row.volume)
        own, base = short.loc[(*place, row.strategy)], short.loc[(*place, "recursive")]
        cost = costs[row.query, row.volume]
        by_list = own[COSTS].to_numpy(float).copy()
        by_list[1] = base.n_v / tests_saved
        found.append((later[(*place, "recursive")] / later[(*place, row.strategy)],
                      base[COSTS].to_numpy(float) @ cost / (by_list @ cost), base.time_ns / own.time_ns))
    return pd.DataFrame(found, columns=["measured", LAW, LAST]).assign(**{SAME: 1.0})


def off(predicted, measured):
    return np.abs(predicted / measured - 1)


def print_tables(record, runs, said):
    rows = runs.measured
    seeds = rows.seed.to_numpy()
    timed = times(record, runs, said)
    print(f"{len(rows)} cells, {rows.seed.nunique()} seeds; errors in %, 95 % intervals over seeds: median, 95 % of cells")
    for source, predictors in said.items():
        for name, values in predictors.items():
            print(f"  tests  {source:14} {name:28}", runs.line(values))
    known = (timed.measured > 0) & np.isfinite(timed.measured)
    print(f"  times of {(~known).sum()} cells are left out: shorter in the longer run")
    for name in (LAW, LAST, SAME):
        print(f"  time   {PREFIX:14} {name:28}",
              law_unseen.shown(law_unseen.middle_and_most(off(timed[name], timed.measured)[known].to_numpy(), seeds[known])))
    print_hypotheses(hypotheses(runs, said, timed[known]))


def hypotheses(runs, said, timed):
    def middle(name, source=PREFIX):
        return runs.off(said[source][name])
    in_time = 100 * np.median(off(timed[LAW], timed.measured))
    named = law_unseen.choices(runs, {LAW: said[PREFIX][LAW]})[LAW]
    right = 100 * (named <= 1.1).mean()
    return [("1", middle(LAW) > 20, f"{middle(LAW):.1f}"),
            ("2", middle(LAST) > max(20, middle(LAW)), f"{middle(LAST):.1f}"),
            ("3", middle(LAST, OTHERS) <= 10, f"{middle(LAST, OTHERS):.1f}; by the law {middle(LAW, OTHERS):.1f}"),
            ("4", in_time < middle(LAW), f"{in_time:.1f} in time"),
            ("5", right < 90, f"{right:.1f} %")]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("record")
    record = parser.parse_args().record
    fit, runs = law_unseen.fit_of_coherence(), read(record)
    print_tables(record, runs, law_unseen.all_predictions(runs, fit))

