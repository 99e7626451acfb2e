# SPDX-License-Identifier: BSD-3-Clause
"""Distances: what `recommended` gains from its parts, and over FCL and Coal, on seeds on which nothing was chosen."""

import json
from pathlib import Path

from bvlab_plots import records
from bvlab_plots.intervals import bootstrap
from quoting import Interval, claim, quotes, two_digits

LIBRARIES = ["FCL, obbrss", "FCL, rss", "Coal, obbrss", "Coal, rss"]


@quotes("distances")
def distances(record):
    """By mesh: medians over seeds of each seed's ratios, with intervals by bootstrap."""
    rows = records.read(record)
    claim((rows[rows.peer == ""].differing == 0).all(), "distances of ours agree with the reference in every frame")
    claim(rows.mesh.nunique() == 5 and rows.seed.nunique() == 10, "five meshes and ten seeds")
    machines = {name: json.loads((Path(record).parent / name / "machine.json").read_text())["processor"] for name in ("distances", "peers-meshes")}
    claim(machines["distances"] == machines["peers-meshes"], "distances and the five meshes were recorded on the same processor")
    rows = rows.assign(us=rows.later_ns / rows.later_pairs / 1e3, volumes=rows.n_v / rows.pairs, triangles=rows.n_p / rows.pairs)
    each = rows.groupby(["mesh", "seed", "method"], sort=False)[["us", "volumes", "triangles"]].median()
    us, volumes, triangles = (each[name].unstack() for name in ("us", "volumes", "triangles"))
    lead = us[LIBRARIES].min(axis=1) / us.recommended
    ratio = {name: us.recommended / us[name] for name in ("one, world", "both, body", "witness, world")}

    def by_mesh(series):
        return series.groupby("mesh", sort=False).median()
    lines = []
    for mesh, of in lead.groupby("mesh", sort=False):
        at = us.loc[mesh].median()
        low, high = bootstrap(of.to_numpy(), "median")
        fastest = at[LIBRARIES].idxmin()
        lines.append([mesh, two_digits(at.recommended), two_digits(at["both, body"]), two_digits(at["one, world"]), fastest, two_digits(at[fastest]),
                      f"{of.median():.1f} ({low:.1f} to {high:.1f})"])
    claim((by_mesh(ratio["one, world"]) < 1).all() and (by_mesh(ratio["both, body"]) < 1).all(), "recommended is the faster of both on every mesh")
    saved = by_mesh(volumes.recommended / volumes["both, body"])
    claim((saved < 1).all(), "the witness saves tests of volumes on every mesh")
    claim((rows.differing == 0).all(), "distances of the libraries agree, too")
    return {"rows": lines, "lead": Interval(by_mesh(lead)), "reached": int((by_mesh(lead) >= 8).sum()), "meshes": len(lines),
            "before": Interval(by_mesh(ratio["one, world"])), "witness": Interval(by_mesh(ratio["both, body"])),
            "frame": Interval(by_mesh(ratio["witness, world"])), "volumes": Interval(saved),
            "triangles": Interval(by_mesh(triangles.recommended / triangles["both, body"])), "margins": Interval(by_mesh(us["margins, world"] / us.recommended)),
            "expected": int(by_mesh(ratio["one, world"]).between(0.6, 0.8).sum()), "alone": 100 * (rows.alone == "yes").mean()}
