# SPDX-License-Identifier: BSD-3-Clause
"""What wins where, strategies beside the best rebuilds, real workloads, and whole scenes."""

from bvlab_plots import records
from quotes.relation import measured
from quoting import Interval, claim, quotes

MEETING = ["obb", "rss"]
TIE = 1.1  # times this near to each other are the same


def variants_of(record, cell):
    """The median time of each variant in each cell: how many times as fast as recursive spheres, and over the least."""
    rows = records.read(record)
    records.wrong_answers(rows)
    rows = rows[rows.peer == ""].assign(ns=rows.time_ns / rows.pairs)
    middle = rows.groupby([*cell, "volume", "strategy"], as_index=False).ns.median()
    base = middle[(middle.volume == "sphere") & (middle.strategy == "recursive")].set_index(cell).ns
    middle = middle.set_index(cell)
    return middle.assign(gain=base / middle.ns, over=middle.ns / middle.ns.groupby(cell).min()).reset_index()


def win(rows, cell, wins):
    """Whether in each cell one of those that `wins` says is the fastest, or as fast as that."""
    return (rows[wins].groupby(cell).over.min().reindex(rows.groupby(cell).over.min().index) < TIE).all()


@quotes("winners-motion")
def over_motion(record):
    cell = ["step", "degrees"]
    rows = variants_of(record, cell)
    steps, degrees = sorted(rows.step.unique()), sorted(rows.degrees.unique())
    little = rows[(rows.step <= steps[-3]) & (rows.degrees <= degrees[-3])]
    much = rows[(rows.step == steps[-1]) | (rows.degrees == degrees[-1])]
    best = little[little.over == 1]
    won = {name: best[best.strategy == name] for name in ("margins", "adaptive")}
    claim(win(much, cell, much.strategy.isin(["recursive-both", "adaptive"])), "recursion over both nodes, or adaptive by it, wins where much moves")
    claim(win(rows, cell, rows.volume.isin(MEETING)), "oriented boxes or rectangle swept spheres win, or are within a tenth, in every motion")
    aabb = rows[rows.volume == "aabb"].groupby(cell).over.min()
    claim((aabb > 1.5).all(), "boxes along the axes are far from winning in any motion")
    return {"aabb": Interval(aabb), "step": f"{steps[-3]:g}", "degrees": f"{degrees[-3]:g}", "margins": len(won["margins"]), "adaptive": len(won["adaptive"]),
            "little": len(best), "gain": Interval([*won["margins"].gain, *won["adaptive"].gain]), "much_step": f"{steps[-1]:g}", "much_degrees": f"{degrees[-1]:g}"}


@quotes("winners-scene")
def over_scene(record):
    cell = ["polygons", "side"]
    rows = variants_of(record, cell)
    far = rows.side == rows.side.max()
    claim((rows[far & (rows.volume == "sphere")].groupby(cell).over.min() <= 1.2).all(), "spheres are within a fifth where bodies are far apart")
    claim(win(rows[~far], cell, rows[~far].volume.isin(MEETING)), "oriented boxes or rectangle swept spheres win, or are within a tenth, wherever bodies meet")
    aabb = rows[~far & (rows.volume == "aabb")].groupby(cell).over.min()
    claim((aabb > 1.5).all(), "boxes along the axes are far from winning where bodies meet")
    return {"far": rows.side.max(), "aabb": Interval(aabb)}


@quotes("best-rebuilds")
def best_rebuilds(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    middle = rows.groupby(["query", "degrees", "strategy"])[["n_v", "best_tests", "time_ns", "later_ns"]].median()
    tests, time = (middle.n_v / middle.best_tests).unstack(), middle.later_ns.unstack()
    price = (middle.time_ns / middle.n_v).unstack()
    adaptive = time.adaptive / time.min(axis=1)
    violent = adaptive.index.get_level_values("degrees") >= 15
    claim((tests["recursive"] > 0.999).all(), "recursion makes no fewer tests than a list with the best rebuilds")
    least = tests.index.get_level_values("degrees") == tests.index.get_level_values("degrees").min()
    return {**{f"raise_{query}": Interval(tests["raise"][query]) for query in ("contacts", "touching")},
            **{f"cost_{query}": Interval(tests["by-cost"][query]) for query in ("contacts", "touching")},
            "longer": (time["raise"] / time["by-cost"]).max(), "rules": Interval(tests[["separation-list", "deferred"]].stack()),
            "recursion": Interval(tests["recursive"]), "both": Interval(tests["recursive-both"]), "margins": Interval(tests.margins[least]),
            "price": Interval(price.margins / price["separation-list"]),
            "violent": Interval(adaptive[violent]), "elsewhere": Interval(adaptive[~violent])}


@quotes("coherence")
def strategies_adaptive(record):
    rows, _ = measured(record)
    cell = ["motion", "motion_model", "mesh", "volume", "query"]
    time = rows.set_index([*cell, "strategy"]).time_ns.unstack()
    ratio = time.adaptive / time.drop(columns="adaptive").min(axis=1)
    one = ratio.index.get_level_values("motion_model").str.startswith("one")
    claim(rows.frames.max() == 100, "runs of a hundred frames")
    near = ratio[one] <= TIE
    claim(near.mean() < 0.8, "where one body moves at a time adaptive is often not within a tenth")
    return {"all": ratio[~one].median(), "one": ratio[one].median(), "one_near": 100 * near.mean(), "one_cells": len(near), "one_worst": ratio[one].max()}


# What tells one cell of a record from another, beside the seed; repetitions are of one cell.
CELLS = {"best-rebuilds": ["motion", "query"], "workloads": ["workload", "volume"], "winners-motion": ["step", "degrees", "volume"],
         "winners-scene": ["polygons", "side", "volume"], "narrow-phase-strategies": ["work", "polygons"], "short-runs": ["motion", "moving", "volume"],
         "sweep": ["persistence", "step", "degrees", "mesh", "polygons", "side", "freedoms", "volume"],
         "coherence": ["motion", "motion_model", "mesh", "volume", "query"]}


@quotes(CELLS)
def adaptive_beside(*found):
    """`adaptive` over the fastest of the other strategies, with the same volume and seed: medians of repetitions."""
    lines = []
    for record, cell in zip(found, CELLS.values()):
        rows = records.read(record)
        records.wrong_answers(rows)
        time = rows.groupby([*cell, *(["seed"] if "seed" in rows else []), "strategy"]).time_ns.median().unstack()
        ratio = time.adaptive / time.drop(columns="adaptive").min(axis=1)
        parts = [(record.name, ratio)]
        if "moving" in cell or "motion_model" in cell:
            one = ratio.index.get_level_values("moving") == 1 if "moving" in cell else ratio.index.get_level_values("motion_model").str.startswith("one")
            parts = [(f"{record.name}, all move", ratio[~one]), (f"{record.name}, one of nine moves", ratio[one])]
        lines += [[f"[{name}](../record/{record.name})", str(len(of)), f"{of.median():.2f}", f"{of.max():.2f}", f"{100 * (of <= 1.1).mean():.0f} %"]
                  for name, of in parts]
    found_by_name = {record.name: (record, cell) for record, cell in zip(found, CELLS.values())}
    record, cell = found_by_name["narrow-phase-strategies"]
    rows = records.read(record)
    time = rows.groupby([*cell, "seed", "strategy"]).time_ns.median().unstack()
    claim({"recursive-both", "raise"} < set(time), "recursive-both and raise are in narrow-phase-strategies")
    without = {name: set(records.read(found_by_name[name][0]).strategy) for name in ("sweep", "coherence")}
    claim("recursive-both" not in without["sweep"] | without["coherence"] and "raise" not in without["sweep"], "what sweep and coherence do not contain")
    return {"rows": lines, "fewer": (time.adaptive / time.drop(columns=["adaptive", "recursive-both", "raise"]).min(axis=1)).median()}


@quotes("workloads")
def workloads(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    rows = rows[rows.volume == "obb"]
    ns = (rows.time_ns / rows.pairs).groupby([rows.workload, rows.strategy]).median()
    planner = ns["planner"]
    return {"planner_recursive": planner["recursive"], "planner_cost": planner["by-cost"], "planner_margins": planner["margins"],
            "planner_adaptive": planner["adaptive"], "pile": list(ns["pile"][["recursive", "by-cost", "margins", "adaptive"]])}


MOVING = [(1, 5, "all move, 5 degrees"), (1, 0.1, "all move, a tenth of a degree"), (0.1, 5, "a tenth moves, 5 degrees"),
          (0.1, 0.1, "a tenth moves, a tenth of a degree"), (0.01, 5, "one in a hundred, 5 degrees"),
          (0.01, 0.1, "one in a hundred, a tenth of a degree")]


PIPELINES = ["fcl-world", "fcl-world-moved", "bullet-world"]


@quotes("worlds")
def worlds(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    each = rows.time_ns / (rows.frames - 1) / 1e6
    middle = each.groupby([rows[name] for name in ("objects", "moving", "degrees", "variant")]).median()

    def cells(objects, moving, degrees):
        scene = middle[objects, moving, degrees]
        return [f"{scene['recommended']:.2g}", *(f"{ratio:.{0 if ratio >= 20 else 1}f}"
                                                 for ratio in (scene[peer] / scene["recommended"] for peer in PIPELINES))]
    return {"rows": [[name, *(text for objects in (1000, 10000) for text in cells(objects, moving, degrees))]
                     for moving, degrees, name in MOVING]}


@quotes("worlds")
def worlds_answers(record):
    rows = records.read(record)
    wrong = rows[records.wrong_answers(rows)]
    claim(set(wrong.peer) <= {"bullet-world"}, "FCL's answers and ours differ for none")
    worst = wrong.loc[wrong.differing.idxmax()]
    # Of all frames but the first; ours count what is near.
    scene = ["objects", "moving", "degrees"]
    near = rows[(rows.peer == "") & (rows[scene] == worst[scene]).all(axis=1)].near / (rows.frames - 1)
    claim(set(rows[rows.configuration == "recommended"].volume) == {"slab-box"}, "recommended is one configuration of slab-boxes in worlds")
    ours = rows[(rows.peer == "") & (rows.moving > 0)].groupby(["objects", "moving", "degrees", "variant"]).time_ns.median().unstack()
    claim((ours.recommended == ours.min(axis=1)).all(), "recommended is the fastest of our variants in worlds")
    return {"variants": ours.shape[1], "frames": rows.frames.max(), "repetitions": rows.repetition.nunique(), "differing": worst.differing / worst.frames, "near": near.max()}


@quotes("worlds-threads")
def on_threads(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    ours = rows[rows.peer == ""]
    time = ours.groupby([ours.configuration.ne(""), "objects", "degrees", "threads"]).time_ns.median().unstack()
    gain = time[1] / time[2]
    return {name + size: Interval(gain[recommended][objects]) for name, recommended in (("", True), ("binary_", False))
            for size, objects in (("small", 1000), ("large", 10000))}
