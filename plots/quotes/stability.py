# SPDX-License-Identifier: BSD-3-Clause
"""Wrong answers on scenes where the right one hangs on the last digits; triangle tests."""

import records
from quoting import RESULTS, Interval, claim, quotes


@quotes("stability-map", RESULTS,
        "eleven stressors at {levels:d} levels",
        "mixed sizes), {frames:d} frames each",
        "Every volume and strategy at `exact`: {exact:d} answers, none wrong. The cheaper precisions: {float64:d} (`float64`) "
        "and {float32:d} (`float32`) called touching that are not, no contact missed. Wrong among {answers:d} answers: FCL's "
        "oriented boxes {obb:d} ({missed:d} contacts missed), kIOS {kios:d}, the most of its trees, its other volumes {others:d}, "
        "CGAL's rigid meshes {cgal:d} (they apply poses to exact numbers, not rounded ones), ODE {ode:d}, Bullet {bullet:d}. "
        "Embree, given our triangle test, {embree:d}, all of them of denormal size.")
def stability(record):
    rows = records.read(record)
    rows = rows.assign(wrong=rows.false_positives + rows.false_negatives)
    ours = rows[rows.peer == ""].groupby("precision")[["answers", "wrong", "false_positives", "false_negatives"]].sum()
    peers = rows[rows.peer != ""].groupby("peer")[["answers", "wrong", "false_negatives"]].sum()
    claim(rows.stressor.nunique() == 11, "eleven stressors")
    claim(ours.wrong["exact"] == 0, "no answer at exact is wrong")
    claim((ours.false_negatives == 0).all(), "the cheaper precisions miss no contact")
    fcl = peers.wrong[[peer for peer in peers.index if peer.startswith("fcl")]]
    claim(fcl.idxmax() == "fcl-kios" and fcl["fcl-obb"] == fcl["fcl-obbrss"], "kIOS errs most of FCL's trees")
    claim(set(rows[(rows.peer == "embree") & (rows.wrong > 0)].stressor) == {"tiny"}, "Embree errs where all is denormal")
    others = fcl.drop(["fcl-kios", "fcl-obb", "fcl-obbrss"])
    return {"levels": len(rows[["stressor", "level"]].drop_duplicates()), "frames": rows.answers.iloc[0],
            "exact": ours.answers["exact"], "float64": ours.false_positives["float64"],
            "float32": ours.false_positives["float32"], "answers": peers.answers.iloc[0], "obb": fcl["fcl-obb"],
            "missed": peers.false_negatives["fcl-obb"], "kios": fcl["fcl-kios"], "others": Interval(others),
            **{name: peers.wrong[name] for name in ("cgal", "ode", "bullet", "embree")}}


@quotes("triangles-error", RESULTS,
        "nine sets of {pairs:d} pairs, nanoseconds a call against wrong answers",
        "`exact` is right on all and takes {random:.0f} ns on random pairs, {mesh:.0f} on neighbours in a mesh, {far:.0f} far from "
        "the origin, {grid:.0f} on a rotated grid, {close:.0f} where every pair hangs on the last digits. One by one it takes "
        "{alone:.0f}. CGAL's filtered predicates are right, too, in {cgal:.0f} ns; the others are wrong on {fewest:d} sets or more: "
        "separating axes (FCL) up to {fcl:.0f} in a thousand, Guigue and Devillers' test in float64 {guigue:.0f}, Moller's "
        "{moller:.0f}.")
def triangles(record):
    rows = records.read(record)
    rows = rows.assign(wrong=1000 * (rows.false_positives + rows.false_negatives) / rows.pairs)
    middle = rows.groupby(["test", "source", "set"])[["wrong", "ns_per_call"]].median()
    wrong = middle.wrong.groupby("test").max()
    claim(rows.set.nunique() == 9, "nine sets")
    claim(wrong["exact"] == wrong["cgal"] == 0, "exact and CGAL are right on all")
    others = (middle.wrong > 0).drop(["exact", "cgal"], level="test")
    exact = middle.ns_per_call["exact", "batched"]
    return {"pairs": rows.pairs.iloc[0], "random": exact["random"], "mesh": exact["mesh neighbours"],
            "far": Interval(exact[["far from the origin", "far and touching"]]), "grid": exact["integer grid, rotated"],
            "close": Interval(exact[["coplanar", "coplanar, rotated", "touching", "slivers"]]),
            "alone": Interval(middle.ns_per_call["exact", "one by one"]), "cgal": Interval(middle.ns_per_call["cgal"]),
            "fewest": others.groupby(["test", "source"]).sum().min(),
            "fcl": wrong["fcl"], "guigue": wrong["guigue-devillers"], "moller": wrong["moller"]}
