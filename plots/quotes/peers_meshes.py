# SPDX-License-Identifier: BSD-3-Clause
"""`recommended` beside every library on five meshes and ten seeds."""

from bvlab_plots import records
from bvlab_plots.intervals import bootstrap
from quoting import Interval, claim, quotes, two_digits

OURS = ["recommended", "wide, from the roots"]
TARGETS = {"touching": 5, "contacts, near": 6, "distance": 8}


def query_of(work):
    return work if work in TARGETS else "touching"


@quotes("peers-meshes")
def peers_meshes(record):
    """By mesh and motion: the median over seeds of the fastest library's time over ours, with an interval."""
    rows = records.read(record)
    claim((rows[rows.peer == ""].differing == 0).all(), "answers of ours agree")
    claim(rows.mesh.nunique() == 5 and rows.seed.nunique() == 10, "five meshes and ten seeds")
    rows = rows.assign(us=rows.later_ns / rows.later_pairs / 1e3)
    us = rows.groupby(["mesh", "work", "seed", "method"], sort=False).us.median().unstack()
    libraries = us.drop(columns=OURS)
    lead = libraries.min(axis=1) / us.recommended
    lines, leads = {}, {query: [] for query in TARGETS}
    for place, of in lead.groupby(["mesh", "work"], sort=False):
        at = libraries.loc[place]
        low, high = bootstrap(of.to_numpy(), "median")
        leads[query_of(place[1])].append(of.median())
        lines.setdefault(place[0], [place[0]]).append(f"{two_digits(us.recommended.loc[place].median())}, {of.median():.1f} x {at.median().idxmin()} ({low:.1f} to {high:.1f})")
    alike = {query: [value for (_, work), of in lead.groupby(["mesh", "work"]) if query_of(work) == query
                     for value in [of.median() / lead["bunny", work].median()]] for query in ("touching", "contacts, near")}
    wrong = rows[(rows.differing > 0) & (rows["query"] != "distance")].groupby("method").differing.max()
    fastest = {work: {libraries.loc[mesh, work].median().idxmin() for mesh in us.index.levels[0]} for work in us.index.levels[1]}
    claim(fastest == {"5 degrees": {"PhysX"}, "near": {"PhysX"}, "contacts, near": {"PhysX"}, "slow": {"OPCODE, coherent"}, "distance": {"FCL, obbrss"}},
          "PhysX is the fastest library for touching and contacts, in slow motion OPCODE's coherent mode, FCL for distances")
    claim(min(min(of) for of in leads.values()) > 1, "recommended is faster than every library on each mesh and motion")
    chosen = rows[rows.method == "recommended"]
    from_roots = {work: int((of.strategy == "recursive").sum()) for work, of in chosen.groupby("work")}
    fast = chosen.work.eq("5 degrees").sum()
    claim(from_roots["5 degrees"] > 0.9 * fast and from_roots["slow"] == 0, "the rule starts from the roots where bodies are fast, not where they are slow")
    return {"fast_found": Interval(lead.xs("5 degrees", level="work").groupby("mesh").median()), "rows": [*lines.values()], "seeds": rows.seed.nunique(), "fast_roots": from_roots["5 degrees"], "fast_runs": int(fast),
            **{query.split(",")[0]: Interval(of) for query, of in leads.items()},
            **{f"{query.split(',')[0]}_reached": sum(value >= TARGETS[query] for value in of) for query, of in leads.items()},
            **{f"{query.split(',')[0]}_cells": len(of) for query, of in leads.items()},
            "alone": 100 * (rows.alone == "yes").mean(), "touching_alike": Interval(alike["touching"]), "contacts_alike": Interval(alike["contacts, near"]),
            "wrong": ", ".join(f"{name.replace(',', '')} {count}" for name, count in wrong.items())}


@quotes("peers-meshes")
def peers_counts(record):
    """Tests per pair of `recommended`, from the roots and of OPCODE, medians over seeds, by mesh."""
    rows = records.read(record)
    rows = rows.assign(us=rows.later_ns / rows.later_pairs / 1e3, volumes=rows.n_v / rows.pairs, triangles=rows.n_p / rows.pairs)
    each = rows.groupby(["work", "method", "mesh"])[["us", "volumes", "triangles"]].median()
    contacts, opcode = each.loc["contacts, near", "recommended"], each.loc["contacts, near", "OPCODE"]
    slow, coherent = each.loc["slow", "recommended"], each.loc["slow", "OPCODE, coherent"]
    roots, cold = each.loc["5 degrees", "wide, from the roots"], each.loc["5 degrees", "OPCODE"]

    def price(part):
        return Interval(1e3 * part.us / (part.volumes + part.triangles))
    claim((contacts.volumes < opcode.volumes).all() and (contacts.triangles > opcode.triangles).all(),
          "for contacts ours makes fewer tests of volumes than OPCODE, and more tests of triangles")
    claim((roots.volumes < cold.volumes).all(), "from the roots ours makes fewer tests of volumes than OPCODE")
    return {"volumes": Interval(contacts.volumes / opcode.volumes), "triangles": Interval(contacts.triangles / opcode.triangles),
            "price": price(contacts), "opcode_price": price(opcode), "slow": Interval(slow.volumes), "coherent": Interval(coherent.volumes),
            "slow_us": Interval(slow.us), "coherent_us": Interval(coherent.us),
            "roots": Interval(roots.volumes / cold.volumes), "roots_triangles": Interval(roots.triangles / cold.triangles)}
