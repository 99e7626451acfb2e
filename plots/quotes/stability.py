# SPDX-License-Identifier: BSD-3-Clause
"""Wrong answers on scenes where the right one hangs on the last digits; triangle tests."""

from bvlab_plots import records
from quoting import Interval, claim, quotes


@quotes("stability-map")
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
    mine = rows[rows.peer == ""]
    claim({"slab-box", "raise", "recommended"} <= {*mine.volume, *mine.strategy, *mine.configuration}, "slab-box, raise and recommended are in the map")
    claim({*mine.fan_out.astype(int)} == {2, 4, 8, 16} and mine.frame.nunique() == 2 and mine.kernel.nunique() == 3, "every fan-out, frame and kernel is in the map")
    others = fcl.drop(["fcl-kios", "fcl-obb", "fcl-obbrss"])
    claim(peers.wrong["coal-obb"] == peers.wrong["coal-obbrss"], "Coal's trees err alike")
    claim(set(peers.index) == {"fcl-aabb", "fcl-kdop16", "fcl-kdop18", "fcl-kdop24", "fcl-kios", "fcl-obb", "fcl-obbrss", "fcl-rss", "bullet", "cgal",
                               "coal-obb", "coal-obbrss", "embree", "ode", "opcode", "opcode-coherent", "physx"}, "every peer of the map is named")
    claim(peers.wrong.idxmax() == "bullet", "Bullet errs most")
    return {"levels": len(rows[["stressor", "level"]].drop_duplicates()), "frames": rows.answers.iloc[0],
            "volumes": mine.volume.nunique(), "strategies": mine.strategy.nunique(), "variants": int((mine.precision == "exact").sum() / len(rows[["stressor", "level"]].drop_duplicates())), "exact": ours.answers["exact"], "float64": ours.false_positives["float64"],
            "float32": ours.false_positives["float32"], "answers": peers.answers.iloc[0], "obb": fcl["fcl-obb"],
            "missed": peers.false_negatives["fcl-obb"], "kios": fcl["fcl-kios"], "others": Interval(others),
            "coal": peers.wrong["coal-obb"], "opcode": Interval(peers.wrong[["opcode-coherent", "opcode"]]),
            **{name: peers.wrong[name] for name in ("cgal", "ode", "bullet", "embree", "physx")}}


@quotes("triangles-error")
def triangles(record):
    rows = records.read(record)
    rows = rows.assign(wrong=1000 * (rows.false_positives + rows.false_negatives) / rows.pairs)
    middle = rows.groupby(["test", "source", "set"])[["wrong", "ns_per_call"]].median()
    wrong = middle.wrong.groupby("test").max()
    size = rows.groupby("set").pairs.max()
    claim((size == 50000).sum() == 8 and len(size) == 9, "eight sets of 50 000 pairs and another")
    claim(size.idxmin() == "integer grid, rotated", "the other is the integer grid")
    claim(wrong.idxmax() == "float32" and wrong.nlargest(2).index[1] == "float64", "our own cheaper precisions are the worst")
    claim(wrong["exact"] == wrong["cgal"] == 0, "exact and CGAL are right on all")
    others = (middle.wrong > 0).drop(["exact", "cgal"], level="test")
    exact = middle.ns_per_call["exact", "batched"]
    return {"pairs": size.max(), "grid_pairs": size.min(), "random": exact["random"], "mesh": exact["mesh neighbours"],
            "far": Interval(exact[["far from the origin", "far and touching"]]), "grid": exact["integer grid, rotated"],
            "close": Interval(exact[["coplanar", "coplanar, rotated", "touching", "slivers"]]),
            "alone": Interval(middle.ns_per_call["exact", "one by one"]), "cgal": Interval(middle.ns_per_call["cgal"]),
            "fewest": others.groupby(["test", "source"]).sum().min(),
            "fcl": wrong["fcl"], "guigue": wrong["guigue-devillers"], "moller": wrong["moller"],
            "ode": wrong["ode"], "bullet": wrong["bullet"], "float64": wrong["float64"], "float32": wrong["float32"]}
