# SPDX-License-Identifier: BSD-3-Clause
"""`recommended` beside every library: on five meshes, for distances, on motions of others, from arrays to the last answer."""

from functools import cache

import numpy as np

from bvlab_plots import provenance, records
from bvlab_plots.intervals import bootstrap
from quoting import Interval, claim, quotes, two_digits

ROOTS = "wide, from the roots"
TARGETS = ["touching", "contacts, near", "distance"]


def read(record):
    """The rows with what a pair takes: microseconds in later frames (us) and of whole runs, builds and choice included
    (whole), and tests of volumes and triangles. Ours are right."""
    rows = records.read(record)
    claim((rows[rows.peer == ""].differing == 0).all(), "answers of ours agree")
    return rows.assign(us=rows.later_ns / rows.later_pairs / 1e3, whole=(rows.build_ns + rows.time_ns) / rows.pairs / 1e3,
                       volumes=rows.n_v / rows.pairs, triangles=rows.n_p / rows.pairs)


def libraries_of(rows):
    return list(rows[rows.peer != ""].method.unique())


def packages(rows):
    """How many libraries there are, whatever they are set to."""
    return rows[rows.peer != ""].method.str.split(",").str[0].nunique()


def with_interval(of):
    low, high = bootstrap(of.to_numpy(), "median")
    return f"({low:.1f} to {high:.1f})"


def of_five_meshes(record):
    rows = read(record)
    claim(rows.mesh.nunique() == 5 and rows.seed.nunique() == 10, "five meshes and ten seeds")
    return rows


@quotes("peers-meshes")
def peers_meshes(record):
    """By mesh and motion: medians over seeds of the fastest library's time over ours, whole runs, builds and choice included; and of frames alone from the roots."""
    rows = of_five_meshes(record)
    each = rows.groupby(["mesh", "work", "seed", "method"], sort=False)[["whole", "us"]].median().unstack()
    whole, later, libraries = each.whole, each.us, [name for name in each.whole if name not in ("recommended", ROOTS)]
    lead, roots = whole[libraries].min(axis=1) / whole.recommended, later[libraries].min(axis=1) / later[ROOTS]
    lines, leads = {}, {query: [] for query in TARGETS}
    for (mesh, work), of in lead.groupby(["mesh", "work"], sort=False):
        at = whole.loc[mesh, work].median()
        leads[work if work in TARGETS else "touching"].append(of.median())
        lines.setdefault(mesh, [mesh]).append(
            f"{two_digits(at.recommended)}, {of.median():.1f} x {at[libraries].idxmin()} {with_interval(of)}")
    wrong = rows[(rows.differing > 0) & (rows["query"] != "distance")].groupby("method").differing.max()
    claim(min(min(of) for of in leads.values()) > 1, "recommended is faster than every library on each mesh and motion, whole runs")
    fixed = roots.groupby(["work", "mesh"]).median()
    claim(set(rows[rows.method == "recommended"].build) == {"on-demand"}, "recommended begins with trees made on demand in every run")
    return {"rows": [*lines.values()], "seeds": rows.seed.nunique(),
            **{query.split(",")[0]: Interval(of) for query, of in leads.items()},
            **{f"roots_{name}": Interval(fixed[work]) for name, work in (("five", "5 degrees"), ("near", "near"), ("contacts", "contacts, near"))},
            "wrong": ", ".join(f"{name.replace(',', '')} {count}" for name, count in wrong.items())}


@quotes("peers-meshes")
def peers_counts(record):
    """Tests per pair of `recommended`, from the roots and of OPCODE, medians over seeds, by mesh."""
    each = read(record).groupby(["work", "method", "mesh"])[["us", "volumes", "triangles"]].median()
    contacts, opcode = each.loc["contacts, near", "recommended"], each.loc["contacts, near", "OPCODE"]
    slow, coherent = each.loc["slow", "recommended"], each.loc["slow", "OPCODE, coherent"]
    roots, cold = each.loc["5 degrees", ROOTS], each.loc["5 degrees", "OPCODE"]

    def price(part):
        return Interval(1e3 * part.us / (part.volumes + part.triangles))
    claim((contacts.volumes < opcode.volumes).all() and (contacts.triangles > opcode.triangles).all(),
          "for contacts ours makes fewer tests of volumes than OPCODE, and more tests of triangles")
    claim((roots.volumes < cold.volumes).all(), "from the roots ours makes fewer tests of volumes than OPCODE")
    return {"volumes": Interval(contacts.volumes / opcode.volumes), "triangles": Interval(contacts.triangles / opcode.triangles),
            "price": price(contacts), "opcode_price": price(opcode), "slow": Interval(slow.volumes), "coherent": Interval(coherent.volumes),
            "roots": Interval(roots.volumes / cold.volumes), "roots_triangles": Interval(roots.triangles / cold.triangles)}


@quotes("distances")
def distances(record):
    """What `recommended` gains for distances, on seeds on which nothing was chosen. By mesh: medians over seeds of each seed's ratios, with intervals by bootstrap."""
    rows = of_five_meshes(record)
    processors = {provenance.machine_of(record.parent / name)["processor"] for name in ("distances", "peers-meshes")}
    claim(len(processors) == 1, "distances and the five meshes were recorded on the same processor")
    libraries = libraries_of(rows)
    each = rows.groupby(["mesh", "seed", "method"], sort=False)[["us", "whole", "volumes", "triangles"]].median()
    us, whole, volumes, triangles = (each[name].unstack() for name in each)
    ours = us["witness, world"]
    build = rows.groupby(["mesh", "seed", "method"], sort=False).build_ns.median().unstack()
    lead, run = us[libraries].min(axis=1) / ours, whole[libraries].min(axis=1) / whole.recommended

    def by_mesh(series):
        return series.groupby("mesh", sort=False).median()
    lines = []
    for mesh, of in lead.groupby("mesh", sort=False):
        at = us.loc[mesh].median()
        fastest = at[libraries].idxmin()
        lines.append([mesh, *(two_digits(at[name]) for name in ("witness, world", "both, world", "one, world")), fastest, two_digits(at[fastest]),
                      f"{of.median():.1f} {with_interval(of)}", f"{run[mesh].median():.1f}"])
    claim((rows.differing == 0).all(), "distances of the libraries agree, too")
    claim((by_mesh(run) > 1).all(), "recommended's whole run is faster than the fastest library's")
    return {"rows": lines, "lead": Interval(by_mesh(lead)), "run": Interval(by_mesh(run)), "witness": Interval(by_mesh(ours / us["both, world"])),
            "frame": Interval(by_mesh(us["both, body"] / us["both, world"])), "volumes": Interval(by_mesh(volumes["witness, world"] / volumes["both, world"])),
            "triangles": Interval(by_mesh(triangles["witness, world"] / triangles["both, world"])), "margins": Interval(by_mesh(us["margins, world"] / ours)),
            "mixed": Interval(by_mesh(us["mixed, margins"] / ours)), "mixed_build": Interval(by_mesh(build["mixed, margins"] / build["witness, world"]))}


PLANNED = ["bugtrap", "abstract", "env-rob"]  # scenes of others without a path: our planner's (experiments/definitions/real-motions.md)
FIXED = "mixed, obb, margins"


@quotes("real-motions")
def real_motions(record):
    """By motion: us per pair of one configuration whose trees are made before, over the fastest library; and whole runs of `recommended`, builds and choice included."""
    rows = read(record)
    peers, libraries = rows[rows.peer != ""], libraries_of(rows)
    middle = rows.groupby(["motion", "method"])[["us", "whole"]].median().unstack()
    us, whole = middle.us, middle.whole
    alone, fixed_run = us[libraries].min(axis=1) / us.recommended, whole[libraries].min(axis=1) / whole[FIXED]
    build = rows[rows.method == FIXED].groupby("motion").build_ns.median() / 1e6
    times, run = us[libraries].min(axis=1) / us[FIXED], whole[libraries].min(axis=1) / whole.recommended
    differ = peers.groupby(["method", "motion"]).differing.max().groupby("method").sum()
    claim(len(us) == 14, "fourteen motions are in the record")
    claim(set(differ.index[differ > 0]) == {"Bullet", "PhysX", "OPCODE", "OPCODE, coherent"}, "answers of Bullet, PhysX and OPCODE differ")
    claim((times > 1).all(), "no library is faster on any motion, frame by frame")
    claim(set(PLANNED) < {name.split()[0] for name in us.index}, "the motions of our planner are in the record")
    table = [[motion.replace("(unseen)", "(unseen at first)"), f"{us[FIXED][motion]:.2f}", us[libraries].loc[motion].idxmin(), f"{us[libraries].loc[motion].min():.2f}",
              f"{times[motion]:.1f}", f"{whole.recommended[motion]:.2f}", whole[libraries].loc[motion].idxmin(), f"{run[motion]:.1f}"] for motion in us.index]
    return {"rows": table, "others": len(us) - len(PLANNED), "planned": len(PLANNED), "count": len(us), "times": Interval(times), "run": Interval(run),
            "libraries": packages(rows), "five": int((times >= 5).sum()), "slowest_at": times.idxmin().split()[0],
            "behind": int((run < 1).sum()), "alone": Interval(alone), "alone_behind": int((alone < 1).sum()), "fixed_run_behind": int((fixed_run < 1).sum()), "build": Interval(build), "frames": rows.frames.max(),
            "bullet": int(differ["Bullet"]), "physx": int(differ["PhysX"]), "opcode": int(differ["OPCODE"])}


@cache
def totals(record):
    """The rows, and by motion and number of frames: ms of `recommended`, choice, trees and frames together, and of the fastest library, and which."""
    rows = read(record)
    rows = rows.assign(ms=(rows.build_ns + rows.time_ns) / 1e6)
    cell = ["motion", "frames"]
    median = rows.groupby([*cell, "method", "peer"]).ms.median().reset_index()
    theirs = median[median.peer != ""]
    found = median[median.peer == ""].set_index(cell)[["ms"]]
    fastest = theirs.loc[theirs.groupby(cell).ms.idxmin()].set_index(cell)
    return rows, found.assign(library=fastest.method, theirs=fastest.ms, times=fastest.ms / found.ms)


@quotes("end-to-end")
def end_to_end(record):
    rows, found = totals(record)
    times = found.times.unstack("frames")
    numbers = sorted(times.columns)
    nine = times.index.str.startswith("nine")
    meshes, times = times[nine], times[~nine]
    claim(len(times) == 14 and len(meshes) == 5 and numbers == [1, 10, 100, 500, 2000], "fourteen motions, five meshes, and up to 2000 frames, are in the record")
    values = {"motions": len(times), "meshes": Interval(meshes.stack()), "libraries": packages(rows), "n1": Interval(times[1]), "n500": Interval(times[500])}
    for frames in numbers:
        values |= {f"n{frames}_mean": float(np.exp(np.log(times[frames]).mean())), f"n{frames}_ahead": int((times[frames] >= 1).sum())}
    return values


@quotes("end-to-end")
def end_to_end_table(record):
    _, found = totals(record)

    def cell(line, frames):
        return f"{line['ms', frames]:.2g} ms, {line['times', frames]:.2g} x {line['library', frames].split(',')[0]}"

    return {"rows": [[motion, *(cell(line, frames) for frames in sorted(found.index.levels[1]))] for motion, line in found.unstack("frames").iterrows()]}


@quotes("tournament-peers")
def tournament_peers(record):
    """Every library from source in one program: microseconds per pair, later frames, medians of repetitions, means of seeds."""
    rows, cell = read(record), ["work", "polygons"]
    claim((rows.alone != "no").all(), "the rows were timed alone")
    places = rows[cell].drop_duplicates().itertuples(index=False, name=None)
    us = rows.groupby([*cell, "method", "seed"]).us.median().groupby([*cell, "method"]).mean().unstack()
    us, libraries = us.loc[list(places), list(rows.method.unique())], libraries_of(rows)
    least, best = us[libraries].min(axis=1), us[libraries].idxmin(axis=1)
    times = least / us.recommended
    touching = times[~times.index.get_level_values("work").str.startswith("contacts")]
    roots, contacts = (least / us[ROOTS])[touching.index], times.drop(touching.index)
    claim(set(best) <= {"PhysX", "OPCODE, coherent"}, "PhysX or OPCODE's coherent mode is the fastest library")
    physx = best.index[best == "PhysX"]
    claim(set(best.drop(physx)) == {"OPCODE, coherent"}, "OPCODE's coherent mode is the fastest library where PhysX is not")
    begun = rows[rows.method == "recommended"]
    claim({*begun.volume} == {"slab-box"} and {*begun.build} == {"on-demand"} and {*begun.strategy} == {"margins"},
          "recommended begins with slab-boxes in trees made on demand, with margins")
    wrong = rows[rows.differing > 0].groupby("method").differing.max()
    claim(set(rows[rows.differing > 0].work) == {"contacts, near"} and set(wrong.index) == {"Coal, obb", "Coal, obbrss", "OPCODE", "PhysX"}, "Coal, OPCODE and PhysX differ, in contacts alone")
    return {"touching": Interval(touching), "five": int((touching >= 5).sum()), "cells": len(touching), "roots": Interval(roots),
            "contacts": Interval(contacts), "physx": len(physx), "places": len(us),
            "roots_faster": int((us[ROOTS] < us.recommended).sum()), "coal": int(wrong["Coal, obb"]), "opcode": int(wrong["OPCODE"]), "physx_wrong": int(wrong["PhysX"]), "seeds": rows.seed.nunique(),
            "repetitions": rows.repetition.nunique()}
