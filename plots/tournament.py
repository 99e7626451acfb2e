#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Ours beside other libraries in each cell of the narrow-phase record: how many times as fast, with intervals.

usage: tournament.py RECORD

Each side is one configuration that was fixed before the runs. A ratio is the mean over seeds of a pair's time with the
other library, over the same with ours; a seed's time is the median of its repetitions. Intervals: 95 % by bootstrap,
which draws seeds with replacement, the same ones for both sides since both play the same trace, and for each seed its
repetitions with replacement.
"""

import argparse

import numpy as np
import pandas as pd

import records

PLACES = ["work", "polygons"]
DRAWS = 1000


def read(record):
    rows = records.read(record)
    wrong = records.wrong_answers(rows)
    records.say_left_out(rows[wrong].method, "where their answers differ")
    return rows[~wrong].assign(ns=rows.later_ns / rows.later_pairs)


def times(rows, place, method):
    """Nanoseconds a pair: a row for each seed, a column for each repetition."""
    part = rows[(rows[PLACES] == pd.Series(dict(zip(PLACES, place)))).all(axis=1) & (rows.method == method)]
    return part.pivot_table(index="seed", columns="repetition", values="ns").dropna(axis=1)


def mean_time(table):
    return np.median(table, axis=-1).mean(axis=-1)


def drawn(table, seeds, random):
    """Resampled by these seeds, shape (draws, seeds), and by repetitions of their own: a mean time for each draw."""
    repetitions = random.integers(table.shape[1], size=(*seeds.shape, table.shape[1]))
    return mean_time(table[seeds[..., None], repetitions])


def ratio(theirs, ours):
    """How many times as long theirs takes, and the ends of the interval; over the seeds on which both answer rightly."""
    both = ours.index.intersection(theirs.index)
    theirs, ours = theirs.loc[both].to_numpy(), ours.loc[both].to_numpy()
    random = np.random.default_rng(1)
    seeds = random.integers(len(ours), size=(DRAWS, len(ours)))
    low, high = np.percentile(drawn(theirs, seeds, random) / drawn(ours, seeds, random), [2.5, 97.5])
    return mean_time(theirs) / mean_time(ours), low, high


def tournament(rows, ours, theirs):
    """One row a cell: our nanoseconds a pair, who is the fastest of `theirs`, and how many times as long that takes."""
    lines = []
    for place in rows[PLACES].drop_duplicates().itertuples(index=False, name=None):
        table = times(rows, place, ours)
        others = {method: t for method in theirs if (t := times(rows, place, method)).size}
        if not table.size or not others:
            continue
        mean = {method: mean_time(t.to_numpy()) for method, t in others.items()}
        fastest = min(mean, key=mean.get)
        lines.append((*place, mean_time(table.to_numpy()), fastest, mean[fastest], *ratio(others[fastest], table)))
    return pd.DataFrame(lines, columns=[*PLACES, "ours_ns", "fastest", "fastest_ns", "ratio", "low", "high"])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("record")
    rows = read(parser.parse_args().record)
    peers = list(dict.fromkeys(rows[rows.peer != ""].method))
    coherent = [method for method in peers if "coherent" in method]
    for ours in dict.fromkeys(rows[rows.peer == ""].method):
        fresh = [method for method in peers if method not in coherent]
        print(f"{ours}, beside {', '.join(fresh)}:")
        print(tournament(rows, ours, fresh).round(2).to_string(index=False))
        if coherent:
            print(f"\n{ours}, beside {', '.join(coherent)}:")
            print(tournament(rows, ours, coherent).round(2).to_string(index=False))
        print()


if __name__ == "__main__":
    main()
