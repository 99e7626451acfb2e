# SPDX-License-Identifier: BSD-3-Clause
"""Hierarchies beside other libraries', the torus in its ring, builds and fits, tightness, posing, convex bodies."""

from functools import cache

from bvlab_scripts import hierarchies
from bvlab_plots import records
from quoting import Interval, claim, quotes

DENSITIES = ["interlocked", "dense", "sparse"]
TIE = 1.05  # times this near to each other are the same
MOTIONS = {"5 degrees": "5 degrees", "a tenth of a degree": "a tenth of a degree"}


@cache
def measured(record):
    """The median time of each variant in each cell, and the best of ours and theirs."""
    rows, middle, places = hierarchies.read(record)
    return rows, middle, hierarchies.best(middle, places).reset_index()


@quotes("hierarchies")
def hierarchies_beside_peers(record):
    _, _, best = measured(record)
    cells = best.set_index(["query", "motion", "polygons", "density"])

    def times(query, motion, polygons, what):
        return ", ".join(f"{cells.loc[(query, motion, polygons, density), f'{what}: times faster']:.1f}"
                         for density in DENSITIES)
    return {"rows": [[f"{query}, {MOTIONS[motion]}" + (" a frame" if (query, motion) == ("touching", "5 degrees") else "")]
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
    claim(name[much].isin(["obb recursive-both", "rss recursive-both"]).all(), "boxes and rectangles, both descended, where much moves and "
          "bodies are near each other")
    alone = (best.motion == "5 degrees") & (best["query"] != "distance") & (best.density == "sparse")
    claim(not name[alone].isin(["obb recursive-both", "rss recursive-both"]).any(), "neither boxes nor rectangles, both descended, where most pairs are far apart and much moves")
    claim("fcl-obb" not in set(middle[middle["query"] == "distance"].peer), "FCL has no tree of oriented boxes for distances")
    claim(name[best["query"] == "distance"].str.startswith("rss").mean() > 0.7, "rectangle swept spheres for distances")
    claim(name[(best["query"] == "touching") & (best.density == "sparse") & (best.motion == "5 degrees")].str.startswith("sphere").all(),
          "spheres where most pairs are far apart and much moves")
    with_first = (rows.time_ns / rows.pairs).groupby([rows[place] for place in hierarchies.PLACES] + [rows.peer, rows.variant]).median()
    ours_first, theirs_first = (with_first[(with_first.index.get_level_values("peer") == "") == mine].groupby(level=hierarchies.PLACES).min()
                                for mine in (True, False))
    leads = best.set_index(hierarchies.PLACES)["best: times faster"]
    leads = leads[leads >= 30].sort_values(ascending=False)
    leads_first = (theirs_first / ours_first)[leads.index]
    claim((leads_first < leads).all(), "the largest leads shrink with the first frames")
    sparse = rows[(rows["query"] != "distance") & (rows.density == "sparse") & (rows.variant == "sphere recursive")]
    contacts = rows[(rows["query"] == "contacts") & (rows.density == "sparse") & (rows.peer == "")]
    return {"variants": ours.variant.nunique(), "recursive": ours[ours.strategy == "recursive"].variant.nunique(),
            "repetitions": rows.repetition.nunique(), "leads": [f"{lead:.1f}" for lead in leads], "leads_first": [f"{lead:.1f}" for lead in leads_first],
            "much": int(much.sum()), "distance_rss": int(name[best["query"] == "distance"].str.startswith("rss").sum()), "distances": int((best["query"] == "distance").sum()),
            "shortest": contacts.later_ns.min() / 1e3,
            "margins": name[little].str.endswith("margins").sum(), "asked": little.sum(),
            "shells": name.str.startswith("shell").sum(), "cells": len(name),
            "roots": Interval(1e3 * sparse.groupby(["query", "polygons", "motion"]).us.median())}


@quotes("peers-cgal")
def cgal(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    time = rows.groupby(["density", "variant"]).time_ns.median().unstack()
    return {"cgal": Interval(time["cgal"] / time["sphere recursive"])}


@quotes("tori")
def tori(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    rows = rows.assign(us=rows.later_ns / rows.later_pairs / 1e3, tests=rows.n_v / rows.pairs)
    middle = rows.groupby(["query", "peer", "variant"])[["us", "tests"]].median()
    touching, contacts, distance = (middle.loc[(query, "")] for query in ("touching", "contacts", "distance"))
    claim(all(part.us["obb recursive-both"] < TIE * part.us.min() for part in (touching, contacts)),
          "oriented boxes, both descended, are fastest")
    time = touching.us.groupby([touching.index.str.split().str[0], touching.index.str.split().str[1]]).first().unstack()
    gain = time["separation-list"] / time[["recursive", "recursive-both"]].min(axis=1)
    claim(touching.us.idxmin() == "obb recursive-both", "for touching oriented boxes are fastest of all")
    roots = touching[touching.index.str.contains("recursive")].tests
    claim(roots.idxmin() == "kdop26 recursive-both", "26-DOPs make the fewest tests of what starts from the roots")
    claim(all(part.us[part.index.str.contains("recursive")].min() < TIE * part.us.min() for part in (contacts, distance)),
          "no front is fastest for contacts and distances")
    theirs = middle.drop("", level="peer")
    return {"frames": rows.frames.iloc[0], "touching": touching.us.min(), "touching_tests": touching.tests[touching.us.idxmin()],
            "kdop26_tests": touching.tests["kdop26 recursive-both"], "kdop26_us": touching.us["kdop26 recursive-both"],
            "fcl": theirs.loc["touching"].us.min(), "fcl_tests": theirs.loc["touching"].tests.loc["fcl-obb"].iloc[0],
            "contacts": contacts.us.min(), "contacts_tests": contacts.tests["obb recursive-both"],
            "contacts_recursive": contacts.tests["obb recursive"], "fcl_contacts": theirs.loc["contacts"].us.min(),
            "fcl_contacts_tests": theirs.loc["contacts"].tests.loc["fcl-obb"].iloc[0], "distance": distance.us.min(),
            "fcl_distance": theirs.loc["distance"].us.min(), "shell": gain["shell"], "kdop26": gain["kdop26"],
            "others": Interval(gain.drop(["shell", "kdop26"]))}


@quotes("fits")
def fits(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    values = rows.groupby(["build", "fit", "volume", "polygons", "query"])[["n_v", "build_ns"]].median()
    base = values.loc[("top-down-principal", "published")]

    def share(build, fit, what="n_v"):
        """Of what the base makes: the median over sizes and queries, for each volume."""
        return (values.loc[(build, fit)][what] / base[what]).groupby("volume").median()
    sah, bottom_up = share("top-down-surface-area", "published"), share("bottom-up", "published")
    claim(sah.idxmin() == "aabb", "the heuristic saves most with boxes along the axes")
    fitted = ["obb", "rss", "shell"]
    tight = share("top-down-principal", "tight")
    return {"sah_least": sah.min(), "sah_most": sah.max(), "clustering": Interval(bottom_up), **tight[fitted],
            "tight": list(share("bottom-up", "tight")[fitted]),
            "longer": list(share("top-down-principal", "tight", "build_ns")[fitted])}


@quotes("tightness")
def tightness(record):
    rows = records.read(record)
    rows = rows[(rows.mesh == "bunny:8000") & (rows.fit == "published")]
    published = rows.groupby(["level", "volume"])["mean"].mean().unstack("volume")
    leaves = published.index.max()
    claim(published.loc[0].idxmin() == "kdop26", "26-DOPs lose least at the top")
    claim(set(published.loc[leaves].nsmallest(2).index) == {"obb", "rss"}, "boxes and rectangles lose least at the leaves")
    claim(published.sphere[0] < published.sphere[leaves // 2] < published.sphere[leaves], "spheres lose more further down")
    return {"top": published.kdop26[0], "leaves": published.loc[leaves].min()}


@quotes("posing")
def posing(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    rows = rows.assign(share=100 * rows.dismissed / rows.pairs)
    middle = rows.groupby(["query", "side", "k", "policy"])[["n_v", "time_ns", "pose_ns", "share"]].median().unstack()
    asked = middle.drop("roots", level="query")
    time = (asked.time_ns.corners / asked.time_ns.realigned).dropna()
    sparse = time.index.get_level_values("side") == time.index.get_level_values("side").max()
    far, near = time[sparse], time[~sparse]
    claim((far < 0.85).all() and (near > 0.85).all(), "corners are much faster where bodies are sparse, and only there")
    cost = asked.pose_ns.corners / asked.pose_ns.realigned
    eighteen = cost.index.get_level_values("k") == 18
    claim(cost[eighteen].min() > cost[~eighteen].max(), "corners cost most over realignment with 18-DOPs")
    dense = middle.share.loc["roots"].xs(4, level="side")
    price = middle.pose_ns.loc["roots"]
    return {"saved": Interval(100 * (1 - (asked.n_v.corners / asked.n_v.realigned)).clip(lower=0)),
            "corners": Interval(asked.pose_ns.corners), "realigned": Interval(asked.pose_ns.realigned),
            "hull": Interval(dense["hull"]), "other": Interval(dense[["realigned", "corners"]].stack()),
            "price": Interval(price["hull"] / price["realigned"]), "price_corners": Interval(price["hull"] / price["corners"]),
            "cost": Interval(cost[~eighteen]), "cost_eighteen": Interval(cost[eighteen]), "far": Interval(far), "near": Interval(near)}


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
