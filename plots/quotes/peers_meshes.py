# SPDX-License-Identifier: BSD-3-Clause
"""`recommended` beside every library on five meshes and ten seeds."""

from bvlab_plots import records
from bvlab_plots.intervals import bootstrap
from quoting import Interval, claim, quotes, two_digits

OURS = ["recommended", "wide, from the roots"]
TARGETS = ["touching", "contacts, near", "distance"]


def query_of(work):
    return work if work in TARGETS else "touching"


@quotes("peers-meshes")
def peers_meshes(record):
    """By mesh and motion: medians over seeds of the fastest library's time over ours, whole runs, builds and choice included; and of frames alone from the roots."""
    rows = records.read(record)
    claim((rows[rows.peer == ""].differing == 0).all(), "answers of ours agree")
    claim(rows.mesh.nunique() == 5 and rows.seed.nunique() == 10, "five meshes and ten seeds")
    rows = rows.assign(us=(rows.build_ns + rows.time_ns) / rows.pairs / 1e3, later=rows.later_ns / rows.later_pairs / 1e3)
    each = rows.groupby(["mesh", "work", "seed", "method"], sort=False)[["us", "later"]].median().unstack()
    whole, later = each.us, each.later
    libraries = [method for method in whole if method not in OURS]
    lead, roots = whole[libraries].min(axis=1) / whole.recommended, later[libraries].min(axis=1) / later["wide, from the roots"]
    lines, leads = {}, {query: [] for query in TARGETS}
    for place, of in lead.groupby(["mesh", "work"], sort=False):
        at = whole[libraries].loc[place]
        low, high = bootstrap(of.to_numpy(), "median")
        leads[query_of(place[1])].append(of.median())
        lines.setdefault(place[0], [place[0]]).append(
            f"{two_digits(whole.recommended.loc[place].median())}, {of.median():.1f} x {at.median().idxmin()} ({low:.1f} to {high:.1f})")
    wrong = rows[(rows.differing > 0) & (rows["query"] != "distance")].groupby("method").differing.max()
    claim(min(min(of) for of in leads.values()) > 1, "recommended is faster than every library on each mesh and motion, whole runs")
    fixed = roots.groupby(["work", "mesh"]).median()
    claim(set(rows[rows.method == "recommended"].build) == {"on-demand"}, "recommended makes its trees on demand in every run")
    return {"rows": [*lines.values()], "seeds": rows.seed.nunique(),
            **{query.split(",")[0]: Interval(of) for query, of in leads.items()},
            **{f"roots_{name}": Interval(fixed[work]) for name, work in (("five", "5 degrees"), ("near", "near"), ("contacts", "contacts, near"))},
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
