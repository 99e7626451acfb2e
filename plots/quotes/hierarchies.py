# SPDX-License-Identifier: BSD-3-Clause
"""Hierarchies beside other libraries', the torus in its ring, builds and fits, tightness, posing, convex bodies."""

from functools import cache

import hierarchies
import records
from quoting import RESULTS, Interval, claim, quotes, stated

DENSITIES = ["interlocked", "dense", "sparse"]
TIE = 1.05  # times this near to each other are the same
MOTIONS = {"5 degrees": "5 degrees", "a tenth of a degree": "a tenth of a degree"}


@cache
def measured(record):
    """The median time of each variant in each cell, and the best of ours and theirs."""
    rows, middle, places = hierarchies.read(record)
    return rows, middle, hierarchies.best(middle, places).reset_index()


@quotes("hierarchies", RESULTS, "| | 500 polygons: recursive | best | 8000 polygons: recursive | best |")
def beside_peers(record):
    _, _, best = measured(record)
    cells = best.set_index(["query", "motion", "polygons", "density"])

    def times(query, motion, polygons, what):
        return ", ".join(f"{cells.loc[(query, motion, polygons, density), f'{what}: times faster']:.1f}"
                         for density in DENSITIES)
    return {"rows": [[f"{query}, {MOTIONS[motion]}" + (" a frame" if (query, motion) == ("touching", "5 degrees") else "")]
                     + [times(query, motion, polygons, what) for polygons in (500, 8000) for what in ("recursive", "best")]
                     for query in dict.fromkeys(best["query"]) for motion in MOTIONS]}


@quotes("hierarchies", RESULTS,
        '"Best" is the best of {variants:d} variants in each cell and "recursive" the best of {recursive:d}, selected and '
        "judged on the same runs, which flatters; each cell has {repetitions:d} repetitions, and first frames are left "
        "out ({most:.1f} is {most_with_first:.1f} with them). The sparse cells of contacts are short: the shortest takes "
        "{shortest:.0f} us in all.",
        "`margins` in {margins:d} of the {asked:d} cells where little moves and a yes or no is enough.",
        "Where most pairs are far apart what counts is the price of a pair that is dismissed at its roots, {roots:.1g} ns a "
        "pair and frame with spheres", "shells are best in {shells:d} of the {cells:d} cells.")
def best_of_ours(record):
    rows, middle, best = measured(record)
    ours = middle[middle.peer == ""]
    claim(set(middle.peer) - {""} == {"fcl-obb", "fcl-obbrss", "fcl-kios"}, "FCL's OBB, OBBRSS and kIOS trees")
    claim(ours.variant.str.split().str[0].nunique() == 8 and ours.strategy.nunique() == 3, "eight volumes, three strategies")
    name = best["best variant"]
    much = (best.motion == "5 degrees") & (best["query"] != "distance") & (best.density != "sparse")
    little = (best.motion != "5 degrees") & (best["query"] == "touching")
    claim(name[much].isin(["obb recursive-both", "rss recursive-both"]).mean() > 0.7, "boxes and rectangles, both descended, where "
          "much moves")
    claim(name[best["query"] == "distance"].str.startswith("rss").mean() > 0.7, "rectangle swept spheres for distances")
    claim(name[(best["query"] == "touching") & (best.density == "sparse") & (best.motion == "5 degrees")].str.startswith("sphere").all(),
          "spheres where most pairs are far apart and much moves")
    at = best["best: times faster"][best["query"] == "distance"].idxmax()
    cell = (rows[["query", "polygons", "density", "motion"]] == best.loc[at, ["query", "polygons", "density", "motion"]]).all(axis=1)
    with_first = (rows.time_ns / rows.pairs)[cell].groupby([rows.peer, rows.variant]).median()
    sparse = rows[(rows["query"] != "distance") & (rows.density == "sparse") & (rows.variant == "sphere recursive")]
    contacts = rows[(rows["query"] == "contacts") & (rows.density == "sparse") & (rows.peer == "")]
    return {"variants": ours.variant.nunique(), "recursive": ours[ours.strategy == "recursive"].variant.nunique(),
            "repetitions": rows.repetition.nunique(), "most": best["best: times faster"][at],
            "most_with_first": with_first.drop("", level=0).min() / with_first[""].min(),
            "shortest": contacts.later_ns.min() / 1e3,
            "margins": name[little].str.endswith("margins").sum(), "asked": little.sum(),
            "shells": name.str.startswith("shell").sum(), "cells": len(name),
            "roots": Interval(1e3 * sparse.groupby(["query", "polygons", "motion"]).us.median())}


@quotes("peers-cgal", RESULTS, "took {cgal:.2g} times as long as recursive spheres")
def cgal(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    time = rows.groupby(["density", "variant"]).time_ns.median().unstack()
    return {"cgal": Interval(time["cgal"] / time["sphere recursive"])}


@quotes("tori", RESULTS,
        "{frames:d} frames: touching takes {touching:.1f} us a frame with oriented boxes (`recursive-both`) and "
        "{least:.0f} volume tests with 26-DOPs, FCL's OBBs {fcl:.0f} us and {fcl_tests:.0f}; contacts {contacts:.1f} us and "
        "{contacts_tests:.0f} tests ({contacts_recursive:.0f} with `recursive`), FCL {fcl_contacts:.0f} us and "
        "{fcl_contacts_tests:.0f}; distances {distance:.0f} us, FCL's best {fcl_distance:.0f}. For touching the separation "
        "list takes {shell:.2f} of the recursion's time with shells and {kdop26:.2f} with 26-DOPs, {others:.2f} with other volumes")
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
    claim(all(part.us[part.index.str.contains("recursive")].min() < TIE * part.us.min() for part in (contacts, distance)),
          "no front is fastest for contacts and distances")
    theirs = middle.drop("", level="peer")
    return {"frames": rows.frames.iloc[0], "touching": touching.us.min(),
            "least": touching.tests[["kdop26 recursive", "kdop26 recursive-both"]].min(),
            "fcl": theirs.loc["touching"].us.min(), "fcl_tests": theirs.loc["touching"].tests.loc["fcl-obb"].iloc[0],
            "contacts": contacts.us.min(), "contacts_tests": contacts.tests["obb recursive-both"],
            "contacts_recursive": contacts.tests["obb recursive"], "fcl_contacts": theirs.loc["contacts"].us.min(),
            "fcl_contacts_tests": theirs.loc["contacts"].tests.loc["fcl-obb"].iloc[0], "distance": distance.us.min(),
            "fcl_distance": theirs.loc["distance"].us.min(), "shell": gain["shell"], "kdop26": gain["kdop26"],
            "others": Interval(gain.drop(["shell", "kdop26"]))}


stated(RESULTS, "what a definition sets", "On the bunny of 8000 polygons")
stated(RESULTS, "what the ring's definition sets", "1300 and 3200 triangles")


@quotes("fits", RESULTS,
        "the surface-area heuristic makes {sah_least:.2f} (boxes along the axes) to {sah_most:.2f} of the tests, clustering from "
        "below {clustering:.2f}. With `--fit tight` oriented boxes (the least rectangle about each axis in turn) make "
        "{obb:.2f} of the tests, swept rectangles (axes and radius moved to the least surface) {rss:.2f} and shells (centre "
        "moved likewise) {shell:.2f}; built bottom-up {tight:.2f}. That takes {longer:.1f} times as long to build.")
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


@quotes("tightness", RESULTS, "On the bunny of 8000 polygons 26-DOPs lose least at the top of the tree ({top:.2f}), boxes and "
        "swept rectangles least at the leaves ({leaves:.2f}), where they become flat")
def tightness(record):
    rows = records.read(record)
    rows = rows[(rows.mesh == "bunny:8000") & (rows.fit == "published")]
    published = rows.groupby(["level", "volume"])["mean"].mean().unstack("volume")
    leaves = published.index.max()
    claim(published.loc[0].idxmin() == "kdop26", "26-DOPs lose least at the top")
    claim(set(published.loc[leaves].nsmallest(2).index) == {"obb", "rss"}, "boxes and rectangles lose least at the leaves")
    claim(published.sphere[0] < published.sphere[leaves // 2] < published.sphere[leaves], "spheres lose more further down")
    return {"top": published.kdop26[0], "leaves": published.loc[leaves].min()}


@quotes("posing", RESULTS,
        "The optimum saves {saved:.0f} % of the tests, so realignment gives little away",
        "corners cost about as much ({corners:.0f} ns a volume, {realigned:.0f} realigned)",
        "A root bounded by climbing on the convex hull dismisses {hull:.0f} % of dense pairs where the other two dismiss "
        "{other:.0f} %, for {price:.1f} times the price.")
def posing(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    rows = rows.assign(share=100 * rows.dismissed / rows.pairs)
    middle = rows.groupby(["query", "side", "k", "policy"])[["n_v", "time_ns", "pose_ns", "share"]].median().unstack()
    asked = middle.drop("roots", level="query")
    time = (asked.time_ns.corners / asked.time_ns.realigned).dropna()
    sparse = time.index.get_level_values("side") == time.index.get_level_values("side").max()
    claim(time[~sparse].median() > 0.95 > time[sparse].median(), "corners are faster where bodies are sparse, and only there")
    dense = middle.share.loc["roots"].xs(4, level="side")
    price = middle.pose_ns.loc["roots"]
    return {"saved": Interval(100 * (1 - (asked.n_v.corners / asked.n_v.realigned)).clip(lower=0)),
            "corners": Interval(asked.pose_ns.corners), "realigned": Interval(asked.pose_ns.realigned),
            "hull": Interval(dense["hull"]), "other": Interval(dense[["realigned", "corners"]].stack()),
            "price": Interval(price["hull"] / price["realigned"])}


@quotes("closest-features", RESULTS,
        "GJK that starts from its last answer and climbs (Cameron) takes {gjk:.2g} us a pair on hulls of 80 to 8000 faces, V-Clip "
        "{v_clip:.2g}, libccd's GJK {libccd:.2g}, FCL's {fcl:.2g} with {off:.1f} % of its distances off by more than 1e-12; "
        "hierarchies, which need no convexity, {hierarchies:.2g}.")
def closest_features(record):
    rows = records.read(record)
    wrong = records.wrong_answers(rows)
    claim(set(rows[wrong].variant) <= {"fcl-gjk"}, "the distances of FCL's GJK alone are off")
    rows = rows.assign(us=rows.later_ns / rows.later_pairs / 1e3)
    middle = rows.groupby(["variant", "mesh", "degrees"]).us.median()
    fcl = rows[rows.variant == "fcl-gjk"]
    ours = rows[rows.peer == ""].groupby(["variant", "mesh", "degrees"]).us.median().groupby(["mesh", "degrees"]).min()
    return {"gjk": Interval(middle["gjk-coherent"]), "v_clip": Interval(middle["v-clip"]), "libccd": Interval(middle["libccd-gjk"]),
            "fcl": Interval(middle["fcl-gjk"]), "off": 100 * fcl.differing.sum() / fcl.pairs.sum(), "hierarchies": Interval(ours)}


stated(RESULTS, "what the definition sets", "hulls of 80 to 8000 faces", "off by more than 1e-12", "(Klosowski 1998)")


@quotes("frames", RESULTS,
        "the other body's frame poses {posed:.2f} of the volumes that the world does, a node at a time, at {dearer:.1f} times the price of "
        "one among sixteen siblings",
        "boxes along the axes make {aabb:.2f} of the world's tests there and K-DOPs {kdops:.2f}",
        "a pair takes {slab:.2f} of the world's time with slab-boxes ({slab_relative:.1f} ns a test there, {slab_world:.1f} here), {aabbs:.2f} with boxes "
        "along the axes and {others:.2f} with the others",
        "Sixteen children a node take {sixteen:.2f} of the time of two and {eight:.2f} of that of eight",
        "The fastest is the slab-box in the other body's frame, {best:.2f} us")
def frames(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    cell = ["mesh", "side", "volume", "fan_out", "frame"]
    middle = rows.assign(us=rows.time_ns / rows.pairs / 1e3).groupby(cell)[["n_u", "n_v", "us", "pose_ns", "test_ns"]].median().unstack()
    wide = middle.xs(16, level="fan_out")
    ratio = {of: wide[of].relative / wide[of].world for of in ("n_u", "n_v", "us", "pose_ns")}

    def only(what, volumes):
        return what[what.index.get_level_values("volume").isin(volumes)]
    kdops, rigid = ["kdop14", "kdop18", "kdop26"], ["sphere", "obb", "rss", "shell"]
    claim((only(ratio["n_v"], ["aabb", *kdops]) < 1).all(), "what is bound along axes makes fewer tests in the other body's frame")
    claim((only(ratio["n_v"], rigid) - 1).abs().max() < 0.01, "what turns with its body is tested as often in both frames")
    test = only(wide.test_ns, ["slab-box"])
    us = middle.us.stack()
    claim(all(at[2] == "slab-box" and at[4] == "relative" for at in us.groupby(["mesh", "side"]).idxmin()),
          "slab-boxes in the other body's frame are fastest")
    by_fan_out = us.unstack("fan_out")
    return {"posed": Interval(ratio["n_u"]), "dearer": Interval(only(ratio["pose_ns"], ["aabb", *kdops, *rigid])),
            "aabb": Interval(only(ratio["n_v"], ["aabb"])), "kdops": Interval(only(ratio["n_v"], kdops)),
            "slab_relative": Interval(test.relative), "slab_world": Interval(test.world),
            "slab": Interval(only(ratio["us"], ["slab-box"])), "aabbs": Interval(only(ratio["us"], ["aabb"])),
            "others": Interval(only(ratio["us"], [*kdops, *rigid])),
            "sixteen": (by_fan_out[16] / by_fan_out[2]).median(), "eight": (by_fan_out[16] / by_fan_out[8]).median(),
            "best": Interval(us.groupby(["mesh", "side"]).min())}
