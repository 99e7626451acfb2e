# SPDX-License-Identifier: BSD-3-Clause
"""Hierarchies beside other libraries', and convex bodies."""

from functools import cache

import pandas as pd

from bvlab_plots import records
from quoting import Interval, claim, quotes

PLACES = ["query", "polygons", "density", "motion"]  # what tells one trace from another
DENSITIES = ["interlocked", "dense", "sparse"]
TIE = 1.05  # times this near to each other are the same
MOTIONS = ["5 degrees", "a tenth of a degree"]


@cache
def measured(record):
    """The rows whose answers are right; the median time of a pair of each variant in each cell; and a row a cell: the best
    of ours, of ours without coherence, and of the peers, and how many times as fast."""
    rows = records.read(record)
    rows = rows[~records.wrong_answers(rows)]
    rows = rows.assign(us=rows.later_ns / rows.later_pairs / 1e3)
    middle = rows.groupby([*PLACES, "peer", "strategy", "variant"], sort=False, as_index=False).us.median()

    def best(part, name):
        return part.loc[part.groupby(PLACES, sort=False).us.idxmin()].set_index(PLACES)[["variant", "us"]].add_prefix(name + " ")
    ours = middle[middle.peer == ""]
    table = pd.concat([best(ours[ours.strategy == "recursive"], "recursive"), best(ours, "best"), best(middle[middle.peer != ""], "peer")], axis=1)
    for name in ("recursive", "best"):
        table[f"{name}: times faster"] = table["peer us"] / table[f"{name} us"]
    return rows, middle, table.reset_index()


@quotes("hierarchies")
def hierarchies_beside_peers(record):
    _, _, best = measured(record)
    cells = best.set_index(["query", "motion", "polygons", "density"])

    def times(query, motion, polygons, what):
        return ", ".join(f"{cells.loc[(query, motion, polygons, density), f'{what}: times faster']:.1f}"
                         for density in DENSITIES)
    return {"rows": [[f"{query}, {motion}" + (" a frame" if (query, motion) == ("touching", "5 degrees") else "")]
                     + [times(query, motion, polygons, what) for polygons in (500, 8000) for what in ("recursive", "best")]
                     for query in dict.fromkeys(best["query"]) for motion in MOTIONS]}


@quotes("hierarchies")
def best_of_ours(record):
    rows, middle, best = measured(record)
    ours = middle[middle.peer == ""]
    claim(set(middle.peer) - {""} == {"fcl-obb", "fcl-obbrss", "fcl-kios"}, "FCL's OBB, OBBRSS and kIOS trees")
    claim(ours.variant.str.split().str[0].nunique() == 8 and ours.strategy.nunique() == 3, "eight volumes, three strategies")
    name = best["best variant"]
    much = (best.motion == "5 degrees") & (best["query"] != "distance") & (best.density != "sparse")
    little = (best.motion != "5 degrees") & (best["query"] == "touching")
    both = ["obb recursive-both", "rss recursive-both"]
    boxes, distances = name[much].isin(both), name[best["query"] == "distance"]
    claim(boxes.mean() > 0.7, "boxes and rectangles, both descended, mostly, where much moves and bodies are near each other")
    claim("fcl-obb" not in set(middle[middle["query"] == "distance"].peer), "FCL has no tree of oriented boxes for distances")
    claim(distances.str.startswith("rss").mean() > 0.7, "rectangle swept spheres for distances")
    claim(name[(best["query"] == "touching") & (best.density == "sparse") & (best.motion == "5 degrees")].str.startswith("sphere").all(),
          "spheres where most pairs are far apart and much moves")
    with_first = (rows.time_ns / rows.pairs).groupby([rows[place] for place in PLACES] + [rows.peer, rows.variant]).median()
    ours_first, theirs_first = (with_first[(with_first.index.get_level_values("peer") == "") == mine].groupby(level=PLACES).min()
                                for mine in (True, False))
    leads = best.set_index(PLACES)["best: times faster"]
    leads = leads[leads >= 30].sort_values(ascending=False)
    leads_first = (theirs_first / ours_first)[leads.index]
    claim((leads_first < leads).all(), "the largest leads shrink with the first frames")
    return {"variants": ours.variant.nunique(), "recursive": ours[ours.strategy == "recursive"].variant.nunique(),
            "repetitions": rows.repetition.nunique(), "leads": [f"{lead:.1f}" for lead in leads], "leads_first": [f"{lead:.1f}" for lead in leads_first],
            "much": int(boxes.sum()), "much_cells": int(much.sum()), "distance_rss": int(distances.str.startswith("rss").sum()), "distances": len(distances),
            "margins": name[little].str.endswith("margins").sum(), "asked": little.sum(),
            "shells": name.str.startswith("shell").sum(), "cells": len(name)}


@quotes("closest-features")
def closest_features(record):
    rows = records.read(record)
    wrong = records.wrong_answers(rows)
    claim(set(rows[wrong].variant) <= {"fcl-gjk"}, "the distances of FCL's GJK alone are off")
    rows = rows.assign(us=rows.later_ns / rows.later_pairs / 1e3)
    middle = rows.groupby(["variant", "mesh", "degrees"]).us.median()
    fcl = rows[rows.variant == "fcl-gjk"]
    claim(set(rows[rows.peer == ""].variant) == {"recursive", "separation-list"}, "recursion and the separation list are ours")
    claim(all(middle["gjk-coherent"].max() < middle[name].min() for name in ("recursive", "separation-list", "fcl-obbrss")), "GJK beats all hierarchies")
    return {"gjk": Interval(middle["gjk-coherent"]), "v_clip": Interval(middle["v-clip"]), "libccd": Interval(middle["libccd-gjk"]),
            "fcl": Interval(middle["fcl-gjk"]), "off": 100 * fcl.differing.sum() / fcl.pairs.sum(),
            "off_most": 100 * (fcl.groupby("mesh").differing.sum() / fcl.groupby("mesh").pairs.sum()).max(), "recursive": Interval(middle["recursive"]), "list": Interval(middle["separation-list"]), "obbrss": Interval(middle["fcl-obbrss"])}
