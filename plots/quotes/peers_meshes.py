# SPDX-License-Identifier: BSD-3-Clause
"""`recommended` beside every library on five meshes and ten seeds."""

from bvlab_plots import records
from bvlab_plots.intervals import bootstrap
from quoting import Interval, claim, quotes

OURS = ["recommended", "wide, from the roots"]
TARGETS = {"touching": 5, "contacts, near": 6, "distance": 8}


def query_of(work):
    return work if work in TARGETS else "touching"


@quotes("peers-meshes")
def peers_meshes(record):
    """By mesh and motion: the median over seeds of the fastest library's time over ours, with an interval."""
    rows = records.read(record)
    claim((rows.alone != "no").all(), "the rows were timed alone")
    claim((rows[rows.peer == ""].differing == 0).all(), "answers of ours agree")
    claim(rows.mesh.nunique() == 5 and rows.seed.nunique() == 10, "five meshes and ten seeds")
    rows = rows.assign(us=rows.later_ns / rows.later_pairs / 1e3)
    us = rows.groupby(["mesh", "work", "seed", "method"], sort=False).us.median().unstack()
    libraries = us.drop(columns=OURS)
    lead = libraries.min(axis=1) / us.recommended
    lines, leads, last = [], {query: [] for query in TARGETS}, None
    for place, of in lead.groupby(["mesh", "work"], sort=False):
        at = libraries.loc[place]
        low, high = bootstrap(of.to_numpy(), "median")
        leads[query_of(place[1])].append(of.median())
        lines.append(["" if place[0] == last else place[0], place[1], f"{us.recommended.loc[place].median():.2g}", at.median().idxmin(),
                      f"{at.median().min():.2g}", f"{of.median():.1f} ({low:.1f} to {high:.1f})"])
        last = place[0]
    wrong = rows[(rows.differing > 0) & (rows["query"] != "distance")].groupby("method").differing.max()
    claim(min(min(of) for of in leads.values()) > 1, "recommended is faster than every library on each mesh and motion")
    return {"rows": lines, "seeds": rows.seed.nunique(), "cells": len(lines),
            **{query.split(",")[0]: Interval(of) for query, of in leads.items()},
            **{f"{query.split(',')[0]}_reached": sum(value >= TARGETS[query] for value in of) for query, of in leads.items()},
            **{f"{query.split(',')[0]}_cells": len(of) for query, of in leads.items()},
            "wrong": ", ".join(f"{name} up to {count}" for name, count in wrong.items())}
