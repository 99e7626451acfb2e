# SPDX-License-Identifier: BSD-3-Clause
"""Ours beside other libraries in each cell of a record: how many times as fast, with intervals.

usage: plots/script tournament RECORD

Records of the narrow phase (a cell is a kind of motion and a mesh) and of boxes (a set, a number and a motion). Where
several builds ran it, a method is told from itself by its program: "recommended, one-lane".

Each side is one configuration that was fixed before the runs. A ratio is the mean over seeds of a pair's time with the
other library, over the same with ours; a seed's time is the median of its repetitions. Intervals: 95 % by bootstrap,
which draws seeds with replacement, the same ones for both sides since both play the same trace, and for each seed its
repetitions with replacement. Another library whose answers differ from the exact ones stays in, with their number.
"""

import argparse

import numpy as np
import pandas as pd

from bvlab_plots import records

PLACES = ["work", "polygons"]
BOX_PLACES = ["set", "count", "motion"]
DRAWS = 1000


def read(record):
    """Rows with the times of a pair, or of a frame of boxes: `ns` in the steady state, `cold_ns` in the first frame,
    `tail_ns` in the slowest of a hundred frames, where that was measured."""
    rows = records.read(record, needs=["method"])
    records.wrong_answers(rows)  # of ours none may be
    if "set" in rows:
        rows = rows[rows.frame_ns > 0]
        rows = rows.assign(ns=rows.frame_ns, cold_ns=rows.first_ns, tail_ns=rows.get("p99_ns", np.nan))
    else:
        each = rows.pairs / rows.frames
        rows = rows.assign(ns=rows.later_ns / rows.later_pairs, cold_ns=rows.first_ns / each,
                           tail_ns=rows.get("p99_ns", np.nan) / each)
    if "program" in rows:
        rows = rows.assign(method=rows.method + ", " + rows.program)
    return rows


def places_of(rows):
    """The columns that tell cells apart."""
    return BOX_PLACES if "set" in rows else PLACES


def times(rows, place, method, column="ns"):
    """Nanoseconds: a row for each seed, a column for each repetition."""
    names = places_of(rows)
    part = rows[(rows[names] == pd.Series(dict(zip(names, place)))).all(axis=1) & (rows.method == method)]
    return part.groupby(["seed", "repetition"])[column].mean().unstack().dropna(axis=1)


def differences(rows, place, method):
    """How many answers differ, over all seeds: whether a pair touches, or one of its contacts, is an answer."""
    names = places_of(rows)
    part = rows[(rows[names] == pd.Series(dict(zip(names, place)))).all(axis=1) & (rows.method == method)]
    if "differing" not in part:
        return 0
    return int(part.groupby("seed").differing.max().sum())


def named(line):
    """The fastest of the others, with the number of its differing answers where there are any."""
    return f"{line.fastest} ({line.differing} differ)" if line.differing else line.fastest


def mean_time(table):
    return np.median(table, axis=-1).mean(axis=-1)


def drawn(table, seeds, random):
    """Resampled by these seeds, shape (draws, seeds), and by repetitions of their own: a mean time for each draw."""
    repetitions = random.integers(table.shape[1], size=(*seeds.shape, table.shape[1]))
    return mean_time(table[seeds[..., None], repetitions])


def ratio(theirs, ours):
    """How many times as long theirs takes, and the ends of the interval; over the seeds that both have."""
    both = ours.index.intersection(theirs.index)
    theirs, ours = theirs.loc[both].to_numpy(), ours.loc[both].to_numpy()
    random = np.random.default_rng(1)
    seeds = random.integers(len(ours), size=(DRAWS, len(ours)))
    low, high = np.percentile(drawn(theirs, seeds, random) / drawn(ours, seeds, random), [2.5, 97.5])
    return mean_time(theirs) / mean_time(ours), low, high


def tournament(rows, ours, theirs, column="ns"):
    """One row a cell: our nanoseconds, who is the fastest of `theirs`, how many times as long that takes, and how many of
    its answers differ."""
    lines, names = [], places_of(rows)
    for place in rows[names].drop_duplicates().itertuples(index=False, name=None):
        table = times(rows, place, ours, column)
        others = {method: t for method in theirs if (t := times(rows, place, method, column)).size}
        if not table.size or not others:
            continue
        mean = {method: mean_time(t.to_numpy()) for method, t in others.items()}
        fastest = min(mean, key=mean.get)
        lines.append((*place, mean_time(table.to_numpy()), fastest, mean[fastest], *ratio(others[fastest], table),
                      differences(rows, place, fastest)))
    return pd.DataFrame(lines, columns=[*names, "ours_ns", "fastest", "fastest_ns", "ratio", "low", "high", "differing"])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("record")
    rows = read(parser.parse_args().record)
    peers = list(dict.fromkeys(rows[rows.peer != ""].method))
    coherent = [method for method in peers if "coherent" in method]
    fresh = [method for method in peers if method not in coherent]
    measures = {"ns": "steady state", "cold_ns": "first frame", "tail_ns": "the slowest frame in a hundred"}
    for ours in dict.fromkeys(rows[rows.peer == ""].method):
        for column, name in measures.items():
            for theirs in (fresh, coherent):
                table = tournament(rows, ours, theirs, column)
                if len(table) and rows[column].notna().any():
                    print(f"{ours}, beside {', '.join(theirs)}; {name}:")
                    print(table.round(2).to_string(index=False), "\n")

