# SPDX-License-Identifier: BSD-3-Clause
"""Motions that others made, and boxes of which some move: `recommended` and `auto` beside the libraries."""

from bvlab_plots import records
from quoting import Interval, at_most, claim, quotes

PLANNED = ["bugtrap", "abstract", "env-rob"]  # scenes of others without a path: our planner's (experiments/definitions/real-motions.md)


FIXED = "mixed, obb, margins"


@quotes("real-motions")
def real_motions(record):
    """By motion: us per pair of one configuration whose trees are made before, over the fastest library; and whole runs of `recommended`, builds and choice included."""
    rows = records.read(record)
    claim((rows.differing[rows.peer == ""] == 0).all(), "answers of ours agree")
    rows = rows.assign(us=rows.later_ns / rows.later_pairs / 1e3, whole=(rows.build_ns + rows.time_ns) / rows.pairs / 1e3)
    peers = rows[rows.peer != ""]
    middle = rows.groupby(["motion", "method"])[["us", "whole"]].median().unstack()
    libraries = list(peers.method.unique())
    us, whole = middle.us, middle.whole
    alone, fixed_run = us[libraries].min(axis=1) / us.recommended, whole[libraries].min(axis=1) / whole[FIXED]
    build = rows[rows.method == FIXED].groupby("motion").build_ns.median() / 1e6
    times, run = us[libraries].min(axis=1) / us[FIXED], whole[libraries].min(axis=1) / whole.recommended
    differ = peers.groupby(["method", "motion"]).differing.max().groupby("method").sum()
    claim(len(us) == 14, "fourteen motions are in the record")
    claim(set(differ.index[differ > 0]) == {"Bullet", "PhysX", "OPCODE", "OPCODE, coherent"}, "answers of Bullet, PhysX and OPCODE differ")
    claim((times > 1).all(), "no library is faster on any motion, frame by frame")
    names = [name.split()[0] for name in us.index]
    claim(set(PLANNED) < set(names), "the motions of our planner are in the record")
    table = [[motion.replace("(unseen)", "(unseen at first)"), f"{us[FIXED][motion]:.2f}", us[libraries].loc[motion].idxmin(), f"{us[libraries].loc[motion].min():.2f}",
              f"{times[motion]:.1f}", f"{whole.recommended[motion]:.2f}", whole[libraries].loc[motion].idxmin(), f"{run[motion]:.1f}"] for motion in us.index]
    return {"rows": table, "others": len(us) - len(PLANNED), "planned": len(PLANNED), "count": len(us), "times": Interval(times), "run": Interval(run),
            "libraries": peers.method.str.split(",").str[0].nunique(), "five": int((times >= 5).sum()), "slowest_at": times.idxmin().split()[0],
            "behind": int((run < 1).sum()), "alone": Interval(alone), "alone_behind": int((alone < 1).sum()), "fixed_run_behind": int((fixed_run < 1).sum()), "build": Interval(build), "frames": rows.frames.max(),
            "bullet": int(differ["Bullet"]), "physx": int(differ["PhysX"]), "opcode": int(differ["OPCODE"])}


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
