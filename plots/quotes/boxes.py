# SPDX-License-Identifier: BSD-3-Clause
"""Box intersection: ours beside peers, against displacement, and what the published figures say."""

import tomllib

import numpy as np
import pandas as pd

from bvlab_plots import records
from quoting import ALL, Interval, at_most, claim, quotes, short

# Peers as text has them.
PEERS = {"cgal": "CGAL (cutoff 10)", "cgal-1000": "CGAL (cutoff 1000)", "fcl-tree": "FCL's tree", "embree": "Embree",
         "bullet-dbvt": "Bullet's `btDbvt`", "physx-abp": "PhysX's ABP"}
SCRATCH = "from scratch"
WORKS = [SCRATCH, "drift", "still", "teleport"]
SEEDS = ["hybrid", "hash", "sweep1", "sweep2", "sweep3", "sweep4"]  # what was published
SWEEPS = [method for method in SEEDS if method.startswith("sweep")]


def fast(record):
    """The rows of one thread whose pairs are right."""
    rows = records.read(record)
    return rows[~records.wrong_answers(rows) & (rows.threads == 1)]


def over_best_peer(group, work):
    """The fastest peer's time on a set over that of `blocks`; None where no peer was played."""
    here = group[group.motion == ("drift" if work == SCRATCH else work)]
    ours = here[(here.method == "blocks") & (here.coherent == ("off" if work == SCRATCH else "on"))].frame_ns.median()
    peers = here[here.peer != ""].groupby("peer")[["frame_ns", "first_ns"]].median()
    time = peers.frame_ns
    if work == SCRATCH:
        # What a peer that keeps something needs for a first frame, too, is from scratch.
        time = np.minimum(time.where(time.index.str.startswith("cgal"), np.inf), peers.first_ns)
    return time.min() / ours if len(peers) else None


@quotes("boxes-fast")
def boxes_beside_peers(record):
    rows = []
    for name, group in fast(record).groupby("set", sort=False):
        ratios = [over_best_peer(group, work) for work in WORKS]
        cells = ["" if ratio is None else f"{ratio:.{0 if ratio >= 50 else 1}f}" for ratio in ratios]
        rows.append([name, short(group[(group.motion == "drift") & (group.method == "blocks")].overlaps.median()), *cells])
    return {"rows": rows}


@quotes("boxes-fast")
def peers(record):
    rows = fast(record)
    still = rows[(rows.set == "adjacent") & (rows.motion == "still")]
    played = {motion: part.groupby(["peer", "set"]).frames.min().unstack("peer") for motion, part in rows.groupby("motion")}
    teleport = played["teleport"]
    given_up, drift = teleport < rows.frames.max(), played["drift"] < rows.frames.max()
    claim(set(drift.columns[drift.any()]) == {"bullet-dbvt"}, "in drift Bullet's tree alone is given up")
    claim(given_up["fcl-tree"].all() and (teleport["fcl-tree"] == 2).all(), "FCL's tree is given up after two frames wherever boxes teleport")
    claim(set(given_up.columns[given_up.any()]) == {"fcl-tree", "bullet-dbvt"}, "FCL's tree and Bullet's alone are given up")
    return {"adjacent": still.overlaps.median(), "peers": [name for peer, name in PEERS.items() if peer in set(rows.peer)], "frames": rows.frames.max(), "given_up": int(given_up["bullet-dbvt"].sum()),
            "given_up_drift": int(drift["bullet-dbvt"].sum()), "sets": len(given_up)}


@quotes(ALL)
def box_references(folder):
    """What the pairs of each record of boxes are compared with, by its definition."""
    found = {}
    for path in sorted(folder.glob("*/definition.toml")):
        definition = tomllib.loads(path.read_text())
        if definition.get("kind") == "boxes":
            found.setdefault(definition["parameters"]["reference"], []).append(path.parent.name)
    claim(set(found) == {"cgal-1000", "auto"}, "references of boxes are CGAL and auto")
    claim(found["auto"] == ["boxes-changes"], "auto is the reference in the record of changing boxes alone")
    return {"said": f"`auto` in that of changing boxes and CGAL in the {len(found['cgal-1000'])} others"}


@quotes("boxes-displacement")
def displacement(record):
    rows = records.right(record)
    time = rows[rows.frame_ns > 0].groupby(["method", "coherent", "set", "displacement"]).frame_ns.median()
    over = time["blocks", "on"] / time["blocks", "off"]
    over = over[over >= 0.9]  # where it starts over
    worst = over.idxmax()
    sap = time["sap", "on"]["random", 1e-5] / time["blocks", "on"]["random", 1e-5]
    claim(sap < 0.9, "incremental sweep and prune is faster where many overlap and hardly move")
    there = rows[(rows.set == "random") & (rows.displacement == 1e-5)]
    return {"others": 2 * (there.overlaps / there.boxes).median(), "over": Interval(over), "worst": worst[0], "at": 100 * worst[1], "sap": 100 * (1 - sap)}


def by_radix(folder):
    """The rows of a record with times, but for those of methods that sort by comparisons; `blocks` sorts in one way, so its second row is a repetition."""
    rows = records.right(folder)
    return rows[(rows.frame_ns > 0) & ((rows.sort != "comparison") | (rows.method == "blocks"))]


FIGURES = ["boxes-figure-3", "boxes-figures-4-5"]


def of_figures(folders):
    """Times of what was published, by set, coherence, number of boxes and method; and those from scratch, a column a method."""
    rows = pd.concat([by_radix(folder) for folder in folders])
    times = rows[rows.method.isin(SEEDS)].groupby(["set", "coherent", "boxes", "method"]).frame_ns.median().sort_index()
    return times, times.xs("off", level="coherent").unstack("method")


@quotes(FIGURES)
def published(*folders):
    times, scratch = of_figures(folders)

    def first_from(name, method, within=1.02):
        """The number of boxes from which on no other method is faster."""
        of_set = scratch.loc[name]
        behind = of_set.index[of_set[method] > within * of_set.min(axis=1)]
        return of_set.index[of_set.index > (behind.max() if len(behind) else 0)].min()
    dense, packed = (first_from(name, "hybrid") for name in ("random", "sphere-packed"))
    few = scratch.loc["random"][lambda table: table.index < dense]
    claim((few.idxmin(axis=1) == "sweep1").all(), "SWEEP1 is best on few random boxes")
    sparse = first_from("sphere-sparse", "hybrid")
    adjacent = scratch.loc["adjacent"]
    hash_from = first_from("adjacent", "hash")
    small = adjacent[adjacent.index < hash_from]
    claim((small.idxmin(axis=1) == "sweep1").all(), "SWEEP1 is best on few adjacent cubes")
    claim(small.drop(columns="sweep1").loc[small.index.max()].idxmin() == "hash", "HASH2 is next on adjacent cubes")
    worst = scratch.loc["random"].idxmax(axis=1)
    worst_from = worst.index[worst == "sweep3"].min()
    claim((worst[worst.index >= worst_from] == "sweep3").all(), "SWEEP3 is worst on the random set from a size on")
    claim(not scratch.isna().any(axis=None), "every method has a time at every size")
    coherent = times.xs("on", level="coherent").unstack("method")[SWEEPS].loc["sphere-sparse"]
    hybrid = scratch.loc["sphere-sparse"].hybrid
    ratio = coherent.min(axis=1) / hybrid
    claim((ratio[ratio.index >= sparse] >= 0.97).all(), "no coherent sweep overtakes HYBRID")
    compared = records.read(folders[1])
    compared = compared[(compared.sort == "comparison") & (compared.frame_ns > 0) & compared.method.isin(SWEEPS) & (compared.set == "adjacent")]
    compared = compared.groupby(["boxes", "method", "coherent"]).frame_ns.median().unstack()
    compared = 1 - compared["on"] / compared["off"]
    claim(compared.median() < 0.33, "with a comparison sort, too, coherence saves less than a third in the median")
    both = times.unstack("coherent").dropna()
    both = both[both.index.get_level_values("method").isin(SWEEPS) & (both.index.get_level_values("set") == "adjacent")]
    left = both["on"] / both["off"]
    return {"random_from": dense, "packed_from": packed, "worst_from": worst_from, "sparse_from": sparse, "adjacent_to": small.index.max(),
            **(scratch.loc["sphere-packed", 50000][["sweep4", "hybrid"]] / 1e6),
            "compared": 100 * compared.median(), "compared_least": 100 * compared.min(), "compared_most": 100 * compared.max(),
            "saved": 100 * (1 - left.median()), "saved_least": 100 * (1 - left.max()), "saved_most": 100 * (1 - left.min())}


# Those in which `blocks` plays the same frames with coherence and without; those of changing boxes are of `auto`: see boxes_changes.
FOLLOWED = ["boxes-fast", "boxes-displacement", "boxes-motions", "boxes-figures-4-5"]


@quotes(FOLLOWED)
def boxes_slowest(*folders):
    """What following costs where it does not pay, and how its slowest frames compare."""
    over, drift = [], None
    for folder in folders:
        rows = by_radix(folder)
        rows = rows[(rows.peer == "") & (rows.method == "blocks") & (rows.threads <= 1)]
        keys = [key for key in ("set", "boxes", "motion", "displacement") if key in rows]
        time = rows.groupby([*keys, "coherent"])[["frame_ns", "p99_ns"]].median().unstack("coherent")
        ratio = (time.frame_ns["on"] / time.frame_ns["off"]).dropna()
        at = dict(zip(ratio.index.names, ratio.idxmax() if isinstance(ratio.idxmax(), tuple) else (ratio.idxmax(),)))
        where = rows[(rows[list(at)] == pd.Series(at)).all(axis=1)].iloc[0]
        over.append((ratio.max(), folder.name, where.set, where.boxes, rows.frames.max(), where.motion))
        if folder.name == "boxes-fast":
            drift = time.xs("drift", level="motion")
    (most, most_record, name, boxes, frames, motion), (fast, _, fast_name, _, fast_frames, fast_motion) = max(over), over[0]
    claim(fast_frames < 100, "the 99th percentile of boxes-fast is the slowest frame")
    tail = drift.p99_ns["on"] / drift.frame_ns["on"]
    beside = drift.p99_ns["on"] / drift.p99_ns["off"]
    lead = drift.frame_ns["off"] / drift.frame_ns["on"]
    claim((lead > 1.1).mean() > 0.6, "in drift tracking pays on most sets")
    all_rows = records.read(folders[0])
    all_rows = all_rows[(all_rows.motion == "drift") & (all_rows.frame_ns > 0) & (all_rows.threads <= 1)]
    tails = all_rows.groupby(["set", "peer"]).p99_ns.median().unstack()
    ours = all_rows[(all_rows.method == "blocks") & (all_rows.coherent == "on")].groupby("set").p99_ns.median()
    peers = tails.drop(columns="").min(axis=1) / ours
    claim((beside >= 0.9).all(), "in drift the slowest frames of following are hardly ever faster than starting over's")
    return {"most": most, "set": name, "boxes": boxes, "frames": frames, "fast": fast, "fast_set": fast_name, "fast_frames": fast_frames, "record": most_record, "motion": motion, "fast_motion": fast_motion, "tail": Interval(tail), "beside": Interval(beside), "lead": Interval(lead), "peers": Interval(peers)}


@quotes(FIGURES)
def deviations(*folders):
    """What the published figures say and these do not."""
    _, scratch = of_figures(folders)
    spread = {name: scratch.loc[name][SWEEPS].max(axis=1) / scratch.loc[name][SWEEPS].min(axis=1) for name in ("random", "sphere-packed", "sphere-sparse")}
    random, packed, adjacent, sparse = (scratch.loc[name] for name in ("random", "sphere-packed", "adjacent", "sphere-sparse"))
    large = adjacent[adjacent.index >= 1e4]
    claim((random.iloc[-3:].idxmax(axis=1) == "sweep3").all(), "SWEEP3 is the slowest on large random sets")
    claim((spread["random"].iloc[-3:] > 1.9).all(), "the sweeps differ by a factor of two on large random sets")
    claim(all((large.hybrid < large[method].fillna(np.inf)).all() for method in ("sweep2", "sweep3")),
          "HYBRID beats SWEEP2 and SWEEP3 on many adjacent cubes")
    behind = sparse.sweep1 / sparse.hybrid
    claim((behind[behind.index >= 1e5] > 1.1).all() and (behind[behind.index < 1e5] < 1.05).all(),
          "SWEEP1 keeps up with HYBRID on the sparse sphere up to 50 653 boxes, and not beyond")
    claim((adjacent[["hybrid", "sweep3"]].min(axis=1) > adjacent.min(axis=1)).all(), "HYBRID and SWEEP3 are outperformed on adjacent cubes")
    four = packed.sweep4 / packed.hybrid
    claim((four[four.index <= 5000] < 1.1).all() and (four[four.index > 5000] > 1.1).all(), "SWEEP4 is near HYBRID on the packed sphere up to 5000 boxes, and not beyond")
    hash_random = random.hash / random.min(axis=1)
    return {"random_spread": Interval(spread["random"]), "packed_spread": Interval(spread["sphere-packed"]),
            "sparse_spread": Interval(spread["sphere-sparse"]), "hash_random": Interval(hash_random), "four": Interval(four),
            "adjacent_hybrid": Interval(adjacent.hybrid / adjacent.min(axis=1)), "adjacent_four": Interval(adjacent.sweep4 / adjacent.min(axis=1)),
            "sparse_one": Interval(behind)}


@quotes(FIGURES)
def exponents(*folders):
    """How times grow with the number of boxes: least squares of logarithms, from the largest three sizes."""
    lines, logarithms = [], {1: [], 3: []}

    def exponent(last):
        return np.polyfit(np.log(last.index.to_numpy(float)), np.log(last.to_numpy(float)), 1)[0]
    for folder in folders:
        rows = by_radix(folder)
        rows = rows[(rows.coherent != "on") & rows.method.isin([*SEEDS, "blocks"])]
        for name, group in rows.groupby("set", sort=False):
            time = group.groupby(["boxes", "method"]).frame_ns.min().unstack()[[*SEEDS, "blocks"]]
            pairs = group.groupby("boxes").overlaps.median()
            cells = [f"{exponent(values.iloc[-3:]):.2f}" for values in [pairs, *(time[method].dropna() for method in time)]]
            sizes = pairs.index.to_series().iloc[-3:]
            for power in logarithms:
                logarithms[power].append(exponent(sizes * np.log(sizes) ** power))
            lines.append([name, *cells])
    packed = ("random", "sphere-packed")
    claim(all(abs(float(line[1]) - (2 if line[0] in packed else 1)) < 0.1 for line in lines),
          "pairs grow as the square on over-packed sets")
    linear = [line for line in lines if line[0] not in packed]
    return {"rows": lines, "hybrid": Interval([line[2] for line in linear]), "blocks": Interval([line[-1] for line in linear]),
            "log": Interval(logarithms[1][-2:]), "log_cubed": Interval(logarithms[3][-2:])}


def changing(record):
    """Rows of `auto` by set, motion and how it follows; rows of the rivals; and the fastest rival's time by set and motion,
    told and not ("")."""
    rows = records.read(record)
    claim((rows.differing[rows.method == "auto"] == 0).all(), "the list of auto with coherence is that of auto without")
    rivals = rows[rows.method != "auto"]
    fastest = rivals[rivals.frame_ns > 0].groupby(["set", "motion", "coherent"]).frame_ns.min().unstack()
    claim(set(fastest) == {"", "told"}, "rivals find the movers or are told")
    return rows[rows.method == "auto"].set_index(["set", "motion", "coherent"]), rivals, fastest


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
    timed = rivals.frame_ns > 0
    untimed = rivals[~timed]
    claim(((untimed.frames == 2) | (untimed.frames == rivals.frames.max())).all(), "rivals without a time ended in the second frame, of their first play or of another")
    return {"rival_rows": len(rivals), "untimed": len(untimed), "stopped": int((timed & (rivals.frames < rivals.frames.max())).sum()), "later_play": int((untimed.frames > 2).sum()), "cases": len(on), "few": Interval(few), "worst": at_most(on.max()), "beside": Interval(beside), "told": Interval(told), "untold": untold.max(),
            "latest": at_most(late.max()), "moving": Interval(moving), "first": Interval((abp / first["on"]).dropna()),
            "sap": wrong.groupby(["set", "motion"]).ngroups}
