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
    rows = rows.assign(us=rows.later_ns / rows.later_pairs / 1e3, whole=(rows.build_ns + rows.time_ns) / rows.pairs / 1e3,
                       volumes=rows.n_v / rows.pairs, triangles=rows.n_p / rows.pairs)
    each = rows.groupby(["mesh", "seed", "method"], sort=False)[["us", "whole", "volumes", "triangles"]].median()
    us, whole, volumes, triangles = (each[name].unstack() for name in ("us", "whole", "volumes", "triangles"))
    ours = us["witness, world"]
    lead, run = us[LIBRARIES].min(axis=1) / ours, whole[LIBRARIES].min(axis=1) / whole.recommended

    def by_mesh(series):
        return series.groupby("mesh", sort=False).median()
    lines = []
    for mesh, of in lead.groupby("mesh", sort=False):
        at = us.loc[mesh].median()
        low, high = bootstrap(of.to_numpy(), "median")
        fastest = at[LIBRARIES].idxmin()
        lines.append([mesh, two_digits(at["witness, world"]), two_digits(at["both, world"]), two_digits(at["one, world"]), fastest, two_digits(at[fastest]),
                      f"{of.median():.1f} ({low:.1f} to {high:.1f})", f"{run[mesh].median():.1f}"])
    claim((rows.differing == 0).all(), "distances of the libraries agree, too")
    claim((by_mesh(run) > 1).all(), "recommended's whole run is faster than the fastest library's")
    return {"rows": lines, "lead": Interval(by_mesh(lead)), "run": Interval(by_mesh(run)), "witness": Interval(by_mesh(ours / us["both, world"])),
            "frame": Interval(by_mesh(us["both, body"] / us["both, world"])), "volumes": Interval(by_mesh(volumes["witness, world"] / volumes["both, world"])),
            "triangles": Interval(by_mesh(triangles["witness, world"] / triangles["both, world"])), "margins": Interval(by_mesh(us["margins, world"] / ours))}
