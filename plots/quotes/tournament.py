# SPDX-License-Identifier: BSD-3-Clause
"""`recommended` beside all libraries in one program, each side by configurations that were fixed beforehand.

A ratio is the mean over seeds of a pair's time with the other library, over the same with ours; a seed's time is the
median of its repetitions. Intervals: 95 % by bootstrap, which draws seeds with replacement, the same ones for both sides
since both play the same trace, and for each seed its repetitions with replacement. Another library whose answers differ
from the exact ones stays in, with their number.
"""
from functools import cache

import numpy as np
import pandas as pd

from bvlab_plots import records
from quotes.beside import libraries_of as libraries
from quoting import Interval, claim, quotes, two_digits

OURS = "recommended"
PLACES = ["work", "polygons"]
DRAWS = 1000


def read(record):
    """Rows with the time of a pair in the steady state, `ns`, and in the slowest of a hundred frames, `tail_ns`."""
    rows = records.right(record)
    return rows.assign(ns=rows.later_ns / rows.later_pairs, tail_ns=rows.p99_ns / (rows.pairs / rows.frames))


def at(rows, place, method):
    """The rows of a method in a cell."""
    return rows[(rows[PLACES] == pd.Series(dict(zip(PLACES, place)))).all(axis=1) & (rows.method == method)]


def times(rows, place, method):
    """Nanoseconds: a row for each seed, a column for each repetition."""
    return at(rows, place, method).groupby(["seed", "repetition"]).ns.mean().unstack().dropna(axis=1)


def differences(rows, place, method):
    """How many answers differ, over all seeds: whether a pair touches, or one of its contacts, is an answer."""
    part = at(rows, place, method)
    return int(part.groupby("seed").differing.max().sum()) if "differing" in part else 0


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


def tournament(rows, ours, theirs):
    """One row a cell: who is the fastest of `theirs`, how many times as long as ours that takes, and how many of its
    answers differ."""
    lines = []
    for place in rows[PLACES].drop_duplicates().itertuples(index=False, name=None):
        table = times(rows, place, ours)
        others = {method: t for method in theirs if (t := times(rows, place, method)).size}
        if not table.size or not others:
            continue
        fastest = min(others, key=lambda method: mean_time(others[method].to_numpy()))
        lines.append((*place, fastest, *ratio(others[fastest], table), differences(rows, place, fastest)))
    return pd.DataFrame(lines, columns=[*PLACES, "fastest", "ratio", "low", "high", "differing"])


@cache
def beside_all(record):
    """`recommended` beside the fastest of all configurations of other libraries, those that keep answers among them."""
    rows = read(record)
    return tournament(rows, OURS, libraries(rows)).set_index(PLACES)


SHOWN = ["recommended", "wide, from the roots", "OPCODE", "OPCODE, coherent", "PhysX", "FCL, obb", "Coal, obb"]


@quotes("tournament-peers")
def scenes(record):
    """Scene by method: microseconds per pair, mean and the 99th percentile of frames; and the lead over the fastest library."""
    rows = read(record)
    middle = rows.groupby([*PLACES, "method", "seed"])[["ns", "tail_ns"]].median().groupby([*PLACES, "method"]).mean() / 1e3
    beside = beside_all(record)
    lines, last = [], None
    for place, line in beside.iterrows():
        texts = []
        for name in SHOWN:
            key, mark = (*place, name), "*" if differences(rows, place, name) else ""
            mean_and_tail = (two_digits(float(f"{middle[column][key]:.1e}")) for column in ("ns", "tail_ns") if key in middle.index)
            texts.append(", ".join(mean_and_tail) + mark)
        lead = f"{line.ratio:.1f} ({line.low:.1f} to {line.high:.1f})" + ("*" if line.differing else "")
        lines.append(["" if place[0] == last else place[0], str(place[1]), *texts, lead])
        last = place[0]
    claim(set(libraries(rows)) == {"OPCODE", "OPCODE, coherent", "PhysX", "FCL, obb", "Coal, obb", "Coal, obbrss"}, "the libraries are OPCODE, PhysX, FCL and Coal")
    claim((rows.alone != "no").all(), "the rows were timed alone")
    claim((beside.low > 1).all(), "recommended is faster than every library in every scene")
    wrong = set(rows[rows.differing > 0].work)
    claim(all(work.startswith("contacts") for work in wrong), "only contacts differ")
    tails = middle.tail_ns.unstack("method")
    behind = tails[OURS] >= tails[libraries(rows)].min(axis=1)
    claim(set(behind[behind].index.get_level_values("polygons")) == {8000}, "a library has a lower 99th percentile than recommended for 8000 polygons alone")
    contacts = rows.work.str.startswith("contacts")
    claim(rows[contacts].frames.max() < 100 < rows[~contacts].frames.min(), "runs for contacts alone have less than a hundred frames")
    mean = middle.ns.unstack("method")
    roots = "wide, from the roots"
    built = rows[rows.polygons == 8000].groupby(["method", *PLACES]).build_ns.median() / 1e6
    return {"build": Interval(built[OURS]), "build_opcode": Interval(built["OPCODE"]), "build_physx": Interval(built["PhysX"]), "rows": lines, "lead": Interval(beside.ratio), "seeds": rows.seed.nunique(), "repetitions": rows.repetition.nunique(),
            "cells": len(beside), "roots_faster": int((mean[roots] < mean[OURS]).sum()), "roots_most": 100 * (mean[OURS] / mean[roots] - 1).max(), "roots_tails": int((tails[roots] < tails[OURS]).sum()), "tails_behind": int(behind.sum()),
            "contact_frames": rows[contacts].frames.max()}
