# SPDX-License-Identifier: BSD-3-Clause
"""Box intersection: ours beside peers, against displacement, and what the published figures say."""

import tomllib

import numpy as np
import pandas as pd

from bvlab_scripts import boxes_fast
from bvlab_plots import records
from quotes.names import PEERS, called
from quoting import ALL, Interval, at_most, claim, quotes, short

WORKS = [boxes_fast.SCRATCH, "drift", "still", "teleport"]
SETS = {"triangles": "triangles of a bunny"}
COUNTS = {1e4: "10k", 2e5: "200k", 1e6: "1M"}
SEEDS = ["hybrid", "hash", "sweep1", "sweep2", "sweep3", "sweep4"]  # what was published
SWEEPS = [method for method in SEEDS if method.startswith("sweep")]


@quotes(["boxes-fast", "boxes-triangles", "boxes-fast-large", "boxes-million"])
def boxes_beside_peers(*folders):
    lines = boxes_fast.table(boxes_fast.read(folders))
    lines = lines[lines.method == "blocks"]
    rows = []
    for (count, name), group in lines.groupby(["count", "set"], sort=False):
        ratios = group.set_index("work").ratio
        cells = [f"{ratios[work]:.{0 if ratios[work] >= 50 else 1}f}" if work in ratios else "" for work in WORKS]
        rows.append([SETS.get(name, name), COUNTS[count], short(group.pairs.iloc[0]), *cells])
    return {"rows": rows}


def peers_of(rows):
    """Those of a record that have a name in text, in the order of PEERS."""
    return called([peer for peer in PEERS if peer in set(rows.peer)], PEERS)


@quotes("boxes-fast")
def peers(record):
    rows = boxes_fast.read([record])
    still = rows[(rows.set == "adjacent") & (rows.motion == "still")]
    played = {motion: part.groupby(["peer", "set"]).frames.min().unstack("peer") for motion, part in rows.groupby("motion")}
    teleport = played["teleport"]
    given_up, drift = teleport < rows.frames.max(), played["drift"] < rows.frames.max()
    claim(set(drift.columns[drift.any()]) == {"bullet-dbvt"}, "in drift Bullet's tree alone is given up")
    claim(given_up["fcl-tree"].all() and (teleport["fcl-tree"] == 2).all(), "FCL's tree is given up after two frames wherever boxes teleport")
    claim(set(given_up.columns[given_up.any()]) == {"fcl-tree", "bullet-dbvt"}, "FCL's tree and Bullet's alone are given up")
    return {"adjacent": still.overlaps.median(), "peers": peers_of(rows), "frames": rows.frames.max(), "given_up": int(given_up["bullet-dbvt"].sum()),
            "given_up_drift": int(drift["bullet-dbvt"].sum()), "sets": len(given_up)}


@quotes("boxes-million")
def million_given_up(record):
    rows = records.read(record)
    stopped = rows[(rows.peer != "") & (rows.frames < rows.frames.max())]
    claim(set(stopped.peer) == {"fcl-tree"} and (stopped.frames == 2).all(), "with a million boxes FCL's tree alone is given up, after two frames")
    motions = {"drift": "drift", "still": "at rest"}
    claim(set(stopped.motion) == set(motions), "it is given up in drift and at rest")
    claim(all(set(part.motion) == set(motions) for _, part in stopped.groupby("set")), "in both on each such set")
    return {"frames": rows.frames.max(), "cells": " and ".join(f"`{name}`" for name in stopped.set.unique()) + " (drift and at rest)"}


@quotes(ALL)
def box_references(folder):
    """What the pairs of each record of boxes are compared with, by its definition."""
    found = {}
    for path in sorted(folder.glob("*/definition.toml")):
        definition = tomllib.loads(path.read_text())
        if definition.get("kind") == "boxes":
            found.setdefault(definition["parameters"]["reference"], []).append(path.parent.name)
    claim(set(found) == {"cgal-1000", "brute-force", "sweep3", "auto"}, "references of boxes are CGAL, brute force, SWEEP3 and auto")
    claim(set(found["auto"]) == {"boxes-changes", "boxes-changes-large"}, "auto is the reference in the records of changing boxes alone")
    count = {name: len(records) for name, records in found.items()}
    return {"said": f"CGAL in {count['cgal-1000']}, `sweep3` in {count['sweep3']}, brute force in {count['brute-force']}, and `auto` in the {count['auto']} of changing boxes"}


@quotes("boxes-first-call")
def first_call(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    rows = rows[rows.threads == 1]
    time = rows.groupby(["set", "boxes", "peer"]).first_ns.median().unstack()
    ratio = time.drop(columns="").min(axis=1) / time[""]
    least = ratio.idxmin()
    pairs = rows.groupby(["set", "boxes"]).overlaps.median()
    other = ratio[least[0]].drop(least[1]).idxmax()
    return {"ratio": Interval(ratio), "pairs": short(pairs[least]), "set": least[0], "peers": peers_of(rows), "other": ratio[least[0]][other],
            "other_pairs": short(pairs[least[0]][other])}


@quotes("boxes-peers")
def every_peer(record):
    rows = records.read(record)
    missing = set(rows[records.wrong_answers(rows)].peer)
    claim(missing == {"fcl-sap", "fcl-interval", "ode-hash"}, "FCL's SaP and IntervalTree and ODE's hash space alone differ")
    wrong = rows[rows.differing > 0].groupby("peer").set.unique()
    claim(all(set(wrong[peer]) == {"adjacent"} for peer in ("fcl-sap", "fcl-interval")), "FCL's managers differ on adjacent cubes alone")
    claim("adjacent" not in wrong["ode-hash"], "ODE's hash space differs elsewhere")
    still = rows[(rows.motion == "still") & (rows.threads == 1)]
    still = still.groupby(["set", "variant", "coherent", "peer"]).frame_ns.median()
    theirs = still.reset_index()[lambda part: part.peer != ""].pivot_table(index="set", columns="peer", values="frame_ns")
    ours = still.xs(("blocks", "on"), level=("variant", "coherent")).droplevel("peer")
    return {"best": (theirs.idxmin(axis=1) == "bullet-dbvt").sum(), "sets": len(theirs), "ode": sorted(wrong["ode-hash"]),
            "times": Interval(theirs["bullet-dbvt"] / ours)}


@quotes("boxes-displacement")
def displacement(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    time = rows[rows.frame_ns > 0].groupby(["method", "coherent", "set", "displacement"]).frame_ns.median()
    over = time["blocks", "on"] / time["blocks", "off"]
    over = over[over >= 0.9]  # where it starts over
    worst = over.idxmax()
    sap = time["sap", "on"]["random", 1e-5] / time["blocks", "on"]["random", 1e-5]
    claim(sap < 0.9, "incremental sweep and prune is faster where many overlap and hardly move")
    there = rows[(rows.set == "random") & (rows.displacement == 1e-5)]
    return {"others": 2 * (there.overlaps / there.boxes).median(), "over": Interval(over), "most": over.max(), "worst": worst[0], "at": 100 * worst[1], "sap": 100 * (1 - sap)}


@quotes(["boxes-figure-3", "boxes-figure-4", "boxes-figure-5"])
def published(*folders):
    def read(folder):
        rows = records.read(folder)
        records.wrong_answers(rows)
        rows = rows[(rows.frame_ns > 0) & rows.method.isin(SEEDS)]
        return rows.groupby(["set", "coherent", "boxes", "method"]).frame_ns.median()
    times = pd.concat([read(folder) for folder in folders]).sort_index()
    scratch = times.xs("off", level="coherent").unstack("method")

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
    claim((worst[worst.index >= worst_from] == "sweep3").all() and (worst[worst.index < worst_from] == "sweep2").all(),
          "SWEEP3 is worst on the random set from a size on, SWEEP2 below")
    claim(list(adjacent.index[adjacent.sweep3.isna()]) == [1000000] and not scratch.drop(columns="sweep3").isna().any(axis=None),
          "SWEEP3 alone has no time, at a million adjacent cubes")
    coherent = times.xs("on", level="coherent").unstack("method")[SWEEPS].loc["sphere-sparse"]
    hybrid = scratch.loc["sphere-sparse"].hybrid
    ratio = coherent.min(axis=1) / hybrid
    claim((ratio[ratio.index >= sparse] >= 0.97).all(), "no coherent sweep overtakes HYBRID")
    both = times.unstack("coherent").dropna()
    both = both[both.index.get_level_values("method").isin(SWEEPS) & (both.index.get_level_values("set") == "adjacent")]
    return {"random_from": dense, "packed_from": packed, "worst_from": worst_from, "sparse_from": sparse, "adjacent_to": small.index.max(),
            **(scratch.loc["sphere-packed", 50000][["sweep4", "hybrid"]] / 1e6),
            "saved": 100 * max(0, 1 - (both["on"] / both["off"]).median()), "saved_most": at_most(100 * (1 - (both["on"] / both["off"]).min()), 0)}


@quotes("boxes-million")
def threads(record):
    rows = records.read(record)
    time = rows[rows.method == "blocks"].groupby(["threads", "set", "motion", "coherent"]).wall_ns.median()
    left = (time[2] / time[1]).unstack("coherent")
    return {"off": Interval(left["off"]), "on": Interval(left["on"])}


# Those in which `blocks` plays the same frames with coherence and without; those of changing boxes are of `auto`, and told elsewhere.
FOLLOWED = ["boxes-fast", "boxes-fast-large", "boxes-million", "boxes-triangles", "boxes-displacement", "boxes-peers", "boxes-motions",
            "boxes-motions-packed", "boxes-figure-4", "boxes-figure-5", "boxes-exponents"]


@quotes(FOLLOWED)
def boxes_slowest(*folders):
    """What following costs where it does not pay, and how its slowest frames compare."""
    over, drift = [], None
    for folder in folders:
        rows = records.read(folder)
        records.wrong_answers(rows)
        rows = rows[(rows.peer == "") & (rows.frame_ns > 0) & (rows.method == "blocks") & (rows.threads <= 1)]
        keys = [key for key in ("set", "boxes", "motion", "displacement") if key in rows]
        time = rows.groupby([*keys, "coherent"])[["frame_ns", "p99_ns"]].median().unstack("coherent")
        ratio = (time.frame_ns["on"] / time.frame_ns["off"]).dropna()
        at = dict(zip(ratio.index.names, ratio.idxmax() if isinstance(ratio.idxmax(), tuple) else (ratio.idxmax(),)))
        where = rows[(rows[list(at)] == pd.Series(at)).all(axis=1)].iloc[0]
        over.append((ratio.max(), folder.name, where.set, where.boxes, rows.frames.max(), where.motion))
        if folder.name == "boxes-fast":
            drift = time.xs("drift", level="motion")
    (most, most_record, name, boxes, frames, motion), (fast, _, fast_name, _, fast_frames, fast_motion) = max(over), over[0]
    claim(frames < fast_frames, "the record in which tracking costs most has fewer frames")
    claim(fast_frames < 100, "the 99th percentile of boxes-fast is the slowest frame")
    tail = drift.p99_ns["on"] / drift.frame_ns["on"]
    beside = drift.p99_ns["on"] / drift.p99_ns["off"]
    lead = drift.frame_ns["off"] / drift.frame_ns["on"]
    claim((lead > 1.3).mean() > 0.6, "in drift tracking pays on most sets")
    all_rows = records.read(folders[0])
    all_rows = all_rows[(all_rows.motion == "drift") & (all_rows.frame_ns > 0) & (all_rows.threads <= 1)]
    tails = all_rows.groupby(["set", "peer"]).p99_ns.median().unstack()
    ours = all_rows[(all_rows.method == "blocks") & (all_rows.coherent == "on")].groupby("set").p99_ns.median()
    peers = tails.drop(columns="").min(axis=1) / ours
    claim((beside >= 0.9).all(), "in drift the slowest frames of following are hardly ever faster than starting over's")
    return {"most": most, "set": name, "boxes": boxes, "frames": frames, "fast": fast, "fast_set": fast_name, "fast_frames": fast_frames, "record": most_record, "motion": motion, "fast_motion": fast_motion, "tail": Interval(tail), "beside": Interval(beside), "lead": Interval(lead), "peers": Interval(peers)}


@quotes(["boxes-figure-3", "boxes-figure-4", "boxes-figure-5"])
def deviations(*folders):
    """What the published figures say and these do not."""
    def read(folder):
        rows = records.read(folder)
        rows = rows[(rows.frame_ns > 0) & rows.method.isin(SEEDS)]
        return rows.groupby(["set", "coherent", "boxes", "method"]).frame_ns.median()
    times = pd.concat([read(folder) for folder in folders]).sort_index()
    scratch = times.xs("off", level="coherent").unstack("method")
    spread = {name: scratch.loc[name][SWEEPS].max(axis=1) / scratch.loc[name][SWEEPS].min(axis=1) for name in ("random", "sphere-packed", "sphere-sparse")}
    random, packed, adjacent, sparse = (scratch.loc[name] for name in ("random", "sphere-packed", "adjacent", "sphere-sparse"))
    large = adjacent[adjacent.index >= 1e4]
    claim((random.iloc[-3:].idxmax(axis=1) == "sweep3").all(), "SWEEP3 is the slowest on large random sets")
    claim((spread["random"].iloc[-3:] > 1.9).all(), "the sweeps differ by a factor of two on large random sets")
    claim(all((large.hybrid < large[method].fillna(np.inf)).all() for method in ("sweep2", "sweep3")),
          "HYBRID beats SWEEP2 and SWEEP3 on many adjacent cubes")
    behind = sparse.sweep1 / sparse.hybrid
    claim((behind[behind.index >= 50000] > 1.1).all() and (behind[behind.index < 50000] < 1.05).all(),
          "SWEEP1 keeps up with HYBRID below 50 000 boxes on the sparse sphere, and not from there on")
    claim((large.hybrid < large.sweep4).all(), "HYBRID is faster than SWEEP4 on adjacent cubes from ten thousand on")
    claim((adjacent[["hybrid", "sweep3"]].min(axis=1) > adjacent.min(axis=1)).all(), "HYBRID and SWEEP3 are outperformed on adjacent cubes")
    claim((packed.sweep4 > packed.hybrid).all(), "SWEEP4 is slower than HYBRID on the packed sphere at every size")
    four = packed.sweep4 / packed.hybrid
    hash_random = random.hash / random.min(axis=1)
    return {"random_spread": Interval(spread["random"]), "packed_spread": Interval(spread["sphere-packed"]),
            "sparse_spread": Interval(spread["sphere-sparse"]), "hash_random": Interval(hash_random), "four": Interval(four),
            "adjacent_hybrid": Interval(adjacent.hybrid / adjacent.min(axis=1)), "adjacent_four": Interval(adjacent.sweep4 / adjacent.min(axis=1)),
            "adjacent_one": Interval(adjacent.sweep1 / adjacent.min(axis=1)), "sparse_one": Interval(sparse.sweep1 / sparse.hybrid),
            "most": int(adjacent.index.max()), "rank_four_large": Interval(large.sweep4 / large.hybrid)}


@quotes(["boxes-figure-3", "boxes-figure-4", "boxes-figure-5"])
def exponents(*folders):
    """How times grow with the number of boxes: least squares of logarithms, from the largest three sizes."""
    lines = []
    for folder in folders:
        rows = records.read(folder)
        rows = rows[(rows.frame_ns > 0) & (rows.coherent != "on") & rows.method.isin([*SEEDS, "blocks"])]
        for name, group in rows.groupby("set", sort=False):
            time = group.groupby(["boxes", "method"]).frame_ns.median().unstack()[[*SEEDS, "blocks"]]
            pairs = group.groupby("boxes").overlaps.median()
            cells = []
            for values in [pairs, *(time[method].dropna() for method in time)]:
                last = values.iloc[-3:]
                cells.append(f"{np.polyfit(np.log(last.index.to_numpy(float)), np.log(last.to_numpy(float)), 1)[0]:.2f}")
            lines.append([name, *cells])
    packed = ("random", "sphere-packed")
    claim(all(abs(float(line[1]) - (2 if line[0] in packed else 1)) < 0.1 for line in lines),
          "pairs grow as the square on over-packed sets")
    return {"rows": lines}


@quotes("boxes-exponents")
def powers(record):
    """t = a n^x k^y by least squares of logarithms over sizes and overlaps, for each method, from scratch and coherent."""
    rows = records.read(record)
    records.wrong_answers(rows)
    rows = rows[(rows.frame_ns > 0) & (rows.peer == "")]
    cells = rows.groupby(["method", "coherent", "set", "boxes"])[["frame_ns", "overlaps"]].median().reset_index()
    lines, off, found = [], [], {}
    for method, group in cells.groupby("method", sort=False):
        line = [f"`{method}`"]
        for coherent in ("off", "on"):
            here = group[group.coherent == coherent]
            known = np.column_stack([np.ones(len(here)), np.log(here.boxes), np.log(here.overlaps)])
            answer = np.linalg.lstsq(known, np.log(here.frame_ns), rcond=None)[0]
            found[method, coherent] = answer[1:]
            off.append(np.exp(np.abs(known @ answer - np.log(here.frame_ns)).max()))
            line += [f"{answer[1]:.2f}", f"{answer[2]:.2f}"]
        lines.append(line)
    lines.sort(key=lambda line: float(line[1]) + float(line[2]))
    sums = {key: sum(value) for key, value in found.items()}
    claim(min(value for key, value in sums.items() if key[0] in ("blocks", "auto")) < 1.2, "ours grow nearly as n + k does")
    overlapped = (2 * cells.overlaps / cells.boxes).groupby(cells.set).agg(["min", "max"]).sort_values("min")
    claim(list(overlapped.index) == ["uniform-1", "uniform-8", "uniform-64"], "three sets, of about 1, 8 and 64")
    few, some, many = (Interval(line) for line in overlapped.to_numpy())
    return {"few": few, "some": some, "many": many, "rows": lines, "off": max(off), "sums": Interval(pd.Series(sums)), "cells": len(cells) // len(found)}


@quotes("boxes-large-peers")
def large_peers(record):
    """Of each number of boxes and motion: the fastest library's frame over ours."""
    rows = records.read(record)
    claim((rows.differing == 0).all(), "all pair sets agree with CGAL's")
    ours = rows[rows.peer == ""].pivot_table(index=["count", "motion"], columns="coherent", values="frame_ns")
    theirs = rows[rows.peer != ""].pivot_table(index=["count", "motion"], columns="peer", values="frame_ns")
    lead = theirs.min(axis=1) / ours.min(axis=1)
    claim((ours.loc[:, "on"].xs("still", level="motion") < ours.loc[:, "off"].xs("still", level="motion")).all()
          and (ours.loc[:, "on"].xs("drift", level="motion") > ours.loc[:, "off"].xs("drift", level="motion")).all(),
          "in four frames coherence pays where nothing moves and not in drift")
    claim(set(theirs.xs("still", level="motion").idxmin(axis=1)) == {"bullet-dbvt"} and set(theirs.xs("drift", level="motion").idxmin(axis=1)) == {"fcl-tree"},
          "Bullet's tree is the fastest library at rest, FCL's in drift")
    first = rows[rows.peer == "bullet-dbvt"].first_ns / 1e9
    coherent = (ours["on"] / ours["off"]).xs("drift", level="motion")
    stopped = rows[(rows.peer != "") & (rows.frames < rows.frames.max())]
    return {"frames": rows.frames.max(), "still": Interval(lead.xs("still", level="motion")), "drift": Interval(lead.xs("drift", level="motion")),
            "coherent": Interval(coherent), "coherent_most": coherent.max(), "first": Interval(first), "stopped": len(stopped),
            "bullet_drift": Interval((theirs["bullet-dbvt"] / ours.min(axis=1)).xs("drift", level="motion").dropna())}
