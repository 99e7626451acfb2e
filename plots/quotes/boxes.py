# SPDX-License-Identifier: BSD-3-Clause
"""Box intersection: ours beside peers, against displacement, and what the published figures say."""

import pandas as pd

import boxes_fast
import records
from quotes.names import PEERS, called
from quoting import RESULTS, Interval, claim, quotes, short, stated

WORKS = [boxes_fast.SCRATCH, "drift", "still", "teleport"]
SETS = {"triangles": "triangles of a bunny"}
COUNTS = {1e4: "10k", 2e5: "200k", 1e6: "1M"}
SEEDS = ["hybrid", "hash", "sweep1", "sweep2", "sweep3", "sweep4"]  # what was published
SWEEPS = [method for method in SEEDS if method.startswith("sweep")]


@quotes(["boxes-fast", "boxes-triangles", "boxes-fast-large", "boxes-million"], RESULTS,
        "| set | boxes | pairs | from scratch | all move 2% | nothing moves | teleports |")
def beside_peers(*folders):
    lines = boxes_fast.table(boxes_fast.read(folders))
    lines = lines[lines.method == "blocks"]
    rows = []
    for (count, name), group in lines.groupby(["count", "set"], sort=False):
        ratios = group.set_index("work").ratio
        cells = [f"{ratios[work]:.{0 if ratios[work] >= 50 else 1}f}" if work in ratios else "" for work in WORKS]
        rows.append([SETS.get(name, name), COUNTS[count], short(group.pairs.iloc[0]), *cells])
    return {"rows": rows}


@quotes("boxes-fast", RESULTS, "Times as fast as the best of {peers}, on one thread",
        "{adjacent:s} of the adjacent cubes touch while they stand still")
def peers(record):
    rows = boxes_fast.read([record])
    still = rows[(rows.set == "adjacent") & (rows.motion == "still")]
    return {"adjacent": still.overlaps.median(), "peers": called([peer for peer in PEERS if peer in set(rows.peer)], PEERS)}


@quotes("boxes-first-call", RESULTS,
        "On [the first call](record/boxes-first-call), with one set of boxes and memory that was not touched before, `blocks` is "
        "{ratio:.1f} times as fast as the best of {peers}, least with the {pairs:s} pairs of `{set}`")
def first_call(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    rows = rows[rows.threads == 1]
    time = rows.groupby(["set", "boxes", "peer"]).first_ns.median().unstack()
    ratio = time.drop(columns="").min(axis=1) / time[""]
    least = ratio.idxmin()
    pairs = rows.groupby(["set", "boxes"]).overlaps.median()[least]
    return {"ratio": Interval(ratio), "pairs": short(pairs), "set": least[0], "peers": called([p for p in PEERS if p in set(rows.peer)], PEERS)}


@quotes("boxes-peers", RESULTS,
        "Where nothing moves Bullet's `btDbvt` is the best peer in {best:d} of the {sets:d} sets of [every method and "
        "peer](record/boxes-peers), of 1000 boxes, where ours is {times:.1f} times as fast as it.")
def every_peer(record):
    rows = records.read(record)
    missing = set(rows[records.wrong_answers(rows)].peer)
    claim(missing == {"fcl-sap", "fcl-interval", "ode-hash"}, "FCL's SaP and IntervalTree and ODE's hash space miss pairs")
    still = rows[(rows.motion == "still") & (rows.threads == 1)]
    still = still.groupby(["set", "variant", "coherent", "peer"]).frame_ns.median()
    theirs = still.reset_index()[lambda part: part.peer != ""].pivot_table(index="set", columns="peer", values="frame_ns")
    ours = still.xs(("blocks", "on"), level=("variant", "coherent")).droplevel("peer")
    return {"best": (theirs.idxmin(axis=1) == "bullet-dbvt").sum(), "sets": len(theirs),
            "times": Interval(theirs["bullet-dbvt"] / ours)}


@quotes("boxes-displacement", RESULTS,
        "then costs {over:.2f} of what never having looked costs (the most on `{worst}` at {at:.0f} % displacement). Where boxes "
        "overlap thirty others and move a hundred-thousandth of their size incremental sweep and prune is faster, by {sap:.0f} %.")
def displacement(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    time = rows[rows.frame_ns > 0].groupby(["method", "coherent", "set", "displacement"]).frame_ns.median()
    over = time["blocks", "on"] / time["blocks", "off"]
    over = over[over >= 0.9]  # where it starts over
    worst = over.idxmax()
    sap = time["sap", "on"]["random", 1e-5] / time["blocks", "on"]["random", 1e-5]
    claim(sap < 0.9, "incremental sweep and prune is faster where many overlap and hardly move")
    return {"over": Interval(over), "worst": worst[0], "at": 100 * worst[1], "sap": 100 * (1 - sap)}


stated(RESULTS, "numbers of figures, and what the definition sets", "Koziara and Bićanić's Figures [3](record/boxes-figure-3), "
       "[4](record/boxes-figure-4) and [5](record/boxes-figure-5)", "of 1000 boxes", "**Boxes** (10 000 [beside the best peers]", "[200 000](record/boxes-fast-large)",
       "(from 200 000 on CGAL and FCL's tree alone)", "not from 200 000 boxes on")


@quotes(["boxes-figure-3", "boxes-figure-4", "boxes-figure-5"], RESULTS,
        "HYBRID is best of their methods where boxes overlap much, from {dense_from:d} on, and on the sparse sphere from "
        "{sparse_from:d} on, where no coherent sweep overtakes it; SWEEP1, then HASH2, is best on adjacent cubes, up to "
        "{adjacent_to:d}, and HASH2 beyond.",
        "SWEEP4 falls behind HYBRID on the packed sphere well before 50 000 ({sweep4:.0f} ms against {hybrid:.0f} there), and coherence "
        "saves a sweep nothing like a third ({saved:.0f} % in the median)")
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
    dense = max(first_from(name, "hybrid") for name in ("random", "sphere-packed"))
    sparse = first_from("sphere-sparse", "hybrid")
    adjacent = scratch.loc["adjacent"]
    hash_from = first_from("adjacent", "hash")
    small = adjacent[adjacent.index < hash_from]
    claim((small.idxmin(axis=1) == "sweep1").all(), "SWEEP1 is best on few adjacent cubes")
    claim(small.drop(columns="sweep1").loc[small.index.max()].idxmin() == "hash", "HASH2 is next on adjacent cubes")
    claim(scratch.loc["random"].iloc[-1].idxmax() == "sweep3", "SWEEP3 is worst on the random set")
    coherent = times.xs("on", level="coherent").unstack("method")[SWEEPS].loc["sphere-sparse"]
    hybrid = scratch.loc["sphere-sparse"].hybrid
    ratio = coherent.min(axis=1) / hybrid
    claim((ratio[ratio.index >= sparse] >= 0.97).all(), "no coherent sweep overtakes HYBRID")
    both = times.unstack("coherent").dropna()
    both = both[both.index.get_level_values("method").isin(SWEEPS)]
    return {"dense_from": dense, "sparse_from": sparse, "adjacent_to": small.index.max(),
            **(scratch.loc["sphere-packed", 50000][["sweep4", "hybrid"]] / 1e6),
            "saved": 100 * max(0, 1 - (both["on"] / both["off"]).median())}


stated(RESULTS, "the size of which times follow", "well before 50 000")
stated(RESULTS, "pairs of eight bytes in a page of 4096", "a page for every 512 pairs")


@quotes("boxes-million", RESULTS, "Two threads take {threads:.1f} of the wall time of one")
def threads(record):
    rows = records.read(record)
    time = rows[rows.method == "blocks"].groupby(["threads", "set", "motion", "coherent"]).wall_ns.median()
    return {"threads": Interval(time[2] / time[1])}
