# SPDX-License-Identifier: BSD-3-Clause
"""Motions that others made, and boxes of which some move: `recommended` and `auto` beside the libraries."""

from functools import cache

import numpy as np
import pandas as pd
from bvlab_plots import records
from quoting import Interval, at_most, claim, quotes

NEAR = 1.1  # times the best of ours
PLANNED = ["bugtrap", "abstract", "env-rob"]  # scenes of others without a path: our planner's (experiments/definitions/real-motions.md)


def with_us(rows):
    """The rows with the time of a pair in us, over all frames but the first."""
    return rows.assign(us=rows.later_ns / rows.later_pairs / 1e3)


@cache
def motions(record):
    """By motion: us per pair of `recommended`, over the best of ours, and over the fastest library."""
    rows = records.read(record)
    claim((rows.differing[rows.peer == ""] == 0).all(), "answers of ours agree")
    rows = with_us(rows)
    median = rows.groupby(["motion", "method", "peer"]).us.median().reset_index()
    ours, theirs = median[median.peer == ""].groupby("motion").us.min(), median[median.peer != ""]
    us = median[median.method == "recommended"].set_index("motion").us
    fastest = theirs.loc[theirs.groupby("motion").us.idxmin()].set_index("motion")
    return rows, pd.DataFrame({"us": us, "over_ours": us / ours, "peer": fastest.method, "peer_us": fastest.us, "times": fastest.us / us})


@quotes("real-motions")
def real_motions(record):
    rows, found = motions(record)
    near = found[found.over_ours <= NEAR]
    peers = rows[rows.peer != ""]
    differ = peers.groupby(["method", "motion"]).differing.max().groupby("method").sum()
    claim(len(found) == 14, "fourteen motions are in the record")
    claim(set(differ.index[differ > 0]) == {"Bullet", "PhysX", "OPCODE", "OPCODE, coherent"}, "answers of Bullet, PhysX and OPCODE differ")
    claim((found.times > 1).all(), "no library is faster on any motion")
    claim(found.times.idxmin() == "kuka (unseen)" and found.peer["kuka (unseen)"] == "OPCODE, coherent", "OPCODE comes nearest, on kuka")
    timed = rows.pivot_table(index=["motion", "repetition"], columns="method", values="us")
    leads = (timed[list(peers.method.unique())].min(axis=1) / timed.recommended).unstack("repetition")
    names = [name.split()[0] for name in found.index]
    claim(set(PLANNED) < set(names), "the motions of our planner are in the record")
    return {"others": len(found) - len(PLANNED), "planned": len(PLANNED), "count": len(found), "least": found.us.min(), "most": found.us.max(), "times": Interval(found.times), "libraries": peers.method.str.split(",").str[0].nunique(),
            "near": len(near), "beside": Interval(near.over_ours), "worst": found.over_ours.max(), "worst_at": found.over_ours.idxmax().split()[0],
            "five": int((found.times >= 5).sum()), "five_each": int((leads >= 5).all(axis=1).sum()), "slowest_at": found.times.idxmin().split()[0], "bullet": int(differ["Bullet"]), "physx": int(differ["PhysX"]),
            "opcode": int(differ["OPCODE"])}


@quotes("real-motions")
def real_motions_table(record):
    _, found = motions(record)
    return {"rows": [[motion.replace("(unseen)", "(unseen at first)"), f"{line.us:.2f}", f"{line.over_ours:.2f}", line.peer, f"{line.peer_us:.2f}", f"{line.times:.1f}"]
                     for motion, line in found.iterrows()]}


@quotes("real-motions")
def real_motions_bounds(record):
    """What a pair costs whatever it does, and a test, fitted to motions of one pair; and tests where the lead is below five."""
    rows, found = motions(record)
    rows = rows.assign(volumes=rows.n_v / rows.pairs, tests=(rows.n_v + rows.n_p) / rows.pairs)
    each = rows.groupby(["method", "motion"])[["us", "volumes", "tests"]].median()
    single = each.loc["recommended"].drop("kuka (unseen)")
    alone = rows[rows.motion != "kuka (unseen)"]
    claim((alone.pairs == alone.frames).all(), "one pair per frame but on kuka")
    terms = np.column_stack([np.ones(len(single)), single.tests])
    fixed, price = np.linalg.lstsq(terms / single.us.to_numpy()[:, None], np.ones(len(single)), rcond=None)[0]
    off = terms @ [fixed, price] / single.us
    few = ["easy (seen)", "env-rob (unseen)", "abstract (unseen)"]
    low = found.index[found.times < 5]
    claim(set(low) == {*few, "kuka (unseen)", "spirelli (unseen)"}, "the motions on which the lead is below five")
    ours, theirs = single.volumes["spirelli (unseen)"], each.loc["FCL, obb"].volumes["spirelli (unseen)"]
    claim(found.peer["spirelli (unseen)"] == "FCL, obb" and ours > theirs, "on spirelli FCL is the fastest library and makes fewer tests")
    return {"fixed": fixed, "price": 1e3 * price, "off": max(off.max(), 1 / off.min()), "few": [f"{single.tests[name]:.0f}" for name in few],
            "share": Interval(100 * fixed / single.us[few]), "spirelli": ours, "spirelli_fcl": theirs}


def changing(record):
    """Rows of `auto` by set, motion and how it follows; rows of the rivals; and the fastest rival's time by set and motion,
    told and not ("")."""
    rows = records.read(record)
    claim((rows.differing[rows.method == "auto"] == 0).all(), "the list of auto with coherence is that of auto without")
    rivals = rows[rows.method != "auto"]
    fastest = rivals[rivals.frame_ns > 0].groupby(["set", "motion", "coherent"]).frame_ns.min().unstack()
    claim(set(fastest) == {"", "told"}, "rivals find the movers or are told")
    return rows[rows.method == "auto"].set_index(["set", "motion", "coherent"]), rivals, fastest


def stopped(rivals):
    """Rows of rivals: all, those without a time, and those that ended before the last frame and have one."""
    timed = rivals.frame_ns > 0
    return {"rival_rows": len(rivals), "untimed": int((~timed).sum()), "stopped": int((timed & (rivals.frames < rivals.frames.max())).sum())}


ALL_MOVE = ["drift", "reverse", "jitter"]


@quotes("boxes-changes")
def boxes_changes(record):
    auto, rivals, fastest = changing(record)
    mean, tail, first = auto.frame_ns.unstack(), auto.p99_ns.unstack(), auto.first_ns.unstack()
    on, late = mean["on"] / mean["off"], tail["on"] / tail["off"]
    motion = on.index.get_level_values("motion")
    few = on[motion.isin(["few", "same", "rare"])]
    beside, told = (mean["on"] / fastest[""]).dropna(), (mean["told"] / fastest["told"]).dropna()
    untold = (mean["on"] / fastest["told"]).dropna()
    moving = (fastest[""] / mean["on"])[motion.isin(ALL_MOVE)]
    abp = rivals[(rivals.method == "physx-abp") & (rivals.coherent == "")].set_index(["set", "motion"]).first_ns
    wrong = rivals[rivals.differing > 0]
    claim(len(on) == len(beside) == len(told) == 28, "all cases of the definition are in the record, and rivals in each")
    claim(set(wrong.method) == {"physx-sap"}, "the pairs of PhysX's SAP alone differ")
    claim(set(untold.index[untold > 1].get_level_values("motion")) == {"rare"}, "a rival that is told is faster where few boxes move alone")
    claim((told < 1).all(), "no rival that is told is faster than auto that is told")
    claim((on <= 1.05).all() and (beside <= 1).all(), "in the mean following costs at most 1.05 of starting over, and no rival is faster")
    claim((late < 1.055).all(), "the 99th percentile of following is at most 1.06 of starting over's")
    untimed = rivals[~(rivals.frame_ns > 0)]
    claim(((untimed.frames == 2) | (untimed.frames == rivals.frames.max())).all(), "rivals without a time ended in the second frame, of their first play or of another")
    return {**stopped(rivals), "later_play": int((untimed.frames > 2).sum()), "cases": len(on), "few": Interval(few), "worst": at_most(on.max()), "beside": Interval(beside), "told": Interval(told), "untold": untold.max(),
            "latest": at_most(late.max()), "moving": Interval(moving), "first": Interval((abp / first["on"]).dropna()),
            "sap": wrong.groupby(["set", "motion"]).ngroups}
