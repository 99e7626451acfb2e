# SPDX-License-Identifier: BSD-3-Clause
"""Strategies beside the best rebuilds and beside `adaptive`, and whole scenes."""

from bvlab_plots import records
from quoting import Interval, claim, quotes


@quotes("best-rebuilds")
def best_rebuilds(record):
    rows = records.right(record)
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


# What tells one cell of a record from another, beside the seed; repetitions are of one cell.
CELLS = {"best-rebuilds": ["motion", "query"], "coherence": ["motion", "motion_model", "mesh", "volume", "query"]}


@quotes(CELLS)
def adaptive_beside(*found):
    """`adaptive` over the fastest of the other strategies, with the same volume and seed: medians of repetitions."""
    lines = []
    for record, cell in zip(found, CELLS.values()):
        rows = records.right(record)
        time = rows.groupby([*cell, *(["seed"] if "seed" in rows else []), "strategy"]).time_ns.median().unstack()
        ratio = time.adaptive / time.drop(columns="adaptive").min(axis=1)
        parts = [(record.name, ratio)]
        if "motion_model" in cell:
            one = ratio.index.get_level_values("motion_model").str.startswith("one")
            parts = [(f"{record.name}, all move", ratio[~one]), (f"{record.name}, one of nine moves", ratio[one])]
        lines += [[f"[{name}](../record/{record.name})", str(len(of)), f"{of.median():.2f}", f"{of.max():.2f}", f"{100 * (of <= 1.1).mean():.0f} %"]
                  for name, of in parts]
    return {"rows": lines}


MOVING = [(1, 5, "all move, 5 degrees"), (1, 0.1, "all move, a tenth of a degree"), (0.1, 5, "a tenth moves, 5 degrees"),
          (0.1, 0.1, "a tenth moves, a tenth of a degree"), (0.01, 5, "one in a hundred, 5 degrees"),
          (0.01, 0.1, "one in a hundred, a tenth of a degree")]
PIPELINES = ["fcl-world", "fcl-world-moved", "bullet-world"]


@quotes("worlds")
def worlds(record):
    rows = records.right(record)
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
