# SPDX-License-Identifier: BSD-3-Clause
"""What a front is worth, by query, kernel and survival: the rule, its errors, and the hypotheses."""

import numpy as np
import pandas as pd

from bvlab_plots import records
from bvlab_scripts import fronts
from bvlab_scripts.law import FRONTLESS
from quoting import Interval, claim, quotes

SHARES = [(0, 0.5, "below .5"), (0.5, 0.8, ".5 to .8"), (0.8, 0.95, ".8 to .95"), (0.95, 1.01, "above .95")]
KERNELS = {"gathered, 2": "gathered, binary", "gathered, 16": "gathered, 16", "siblings": "siblings", "mixed": "mixed"}
SAME = {"recursive": "recursion", "recursive-both": "recursion", ("adaptive", "siblings"): "margins", ("adaptive", "mixed"): "margins"}
SHORT = {"gathered, 2": "binary", "gathered, 16": "sixteen", "siblings": "siblings", "mixed": "mixed"}  # in keys
KEPT = [*fronts.LISTS, "margins", "adaptive"]
MOST = 0.9  # of a front: where motion is slow enough for any front to pay
HYPOTHESES = 9


def level(table, name):
    return table.index.get_level_values(name)


def by_configuration(time):
    """A row for each query and scene, a column for each strategy of each kernel."""
    return time[fronts.STRATEGIES].unstack("engine").dropna(axis=1, how="all")


def fastest_of(time, strategies):
    """By query and scene, over all kernels: the least time of these strategies, and which kernel and strategy have it."""
    table = by_configuration(time)
    table = table[[at for at in table if at[0] in strategies]]
    return table.min(axis=1), table.idxmin(axis=1)


def called(places):
    """The most frequent of these kernels and strategies, as texts name it, and its share."""
    names = places.map(lambda at: (KERNELS[at[1]], SAME.get((at[0], at[1]), SAME.get(at[0], at[0]))))
    most = names.value_counts(normalize=True)
    return f"{most.index[0][1]}, {most.index[0][0]}", 100 * most.iloc[0]


@quotes("fronts")
def rule(record):
    """By query and kernel the survival from which on margins are taken, and what the rule loses."""
    time = fronts.read(record)
    limits, rows, found = fronts.thresholds(time), [], {}
    loss = fronts.rule_off(time)
    for (query, engine), limit in limits.items():
        part = time.xs((query, engine), level=("query", "engine"))
        above = fronts.survivals(part) >= limit
        gain, off = fronts.worth(part, ["margins"]), fronts.off(part, limit)
        rows.append([query if not rows or query != query_before else "", KERNELS[engine],
                     f"from {limit:.2f} on" if above.any() else "nowhere",
                     format(Interval(gain[above]), ".1f") if above.any() else "", format(Interval(gain[~above]), ".2f") if (~above).any() else "",
                     f"{off.median():.2f}, {off.max():.2f}"])
        query_before = query
    unseen = fronts.left_out_off(time, record.parent / "coherence")
    found["survival"] = Interval(100 * fronts.survivals(time))
    seen = records.read(record)
    other = [set(level(unseen, "mesh")) - set(seen.mesh), set(level(unseen, "motion_model")) - {"all bodies, all freedoms"}]
    claim([len(names) for names in other] == [3, 2] and set(level(unseen, "query")) == {"touching", "contacts"}, "left out are three shapes and two models of motion, for touching and contacts")
    claim((seen.alone == "yes").all(), "the times of fronts are of rows that were alone")
    claim(len(set(seen.seed)) == 5 and len(set(seen.mesh)) == 3, "five seeds, three meshes")
    for query in fronts.QUERIES:
        of = [limit for (name, _), limit in limits.items() if name == query and limit <= 1]
        found[query] = Interval(of)
        for polygons in (500, 8000):
            found[f"{query}_{polygons}"] = fronts.degrees_at(time, query, polygons, limits[query, fronts.BINARY])
    return {**found, "rows": rows, "cells": len(loss), "off": loss.median(), "most": loss.max(), "wrong": 100 * (loss > fronts.MISTAKEN).mean(), "wrong_cells": int((loss > fronts.MISTAKEN).sum()),
            "wrong_distance": int((loss[(level(loss, "query") == "distance") & (level(loss, "engine") == fronts.BINARY)] > fronts.MISTAKEN).sum()),
            "unseen": unseen.median(), "unseen_most": unseen.max(), "unseen_wrong": 100 * (unseen > fronts.MISTAKEN).mean(), "unseen_cells": len(unseen)}


@quotes("fronts")
def kernels(record):
    """By query and kernel: the time from the roots over the fastest kernel's, and what the best front is worth where most of it survives."""
    time = fronts.read(record)
    roots = time[FRONTLESS].min(axis=1).unstack("engine")
    roots = roots.div(roots.min(axis=1), axis=0)
    behind, first = roots.groupby("query").median(), (roots == 1).groupby("query").mean()
    gain = fronts.worth(time, KEPT)
    slow = fronts.survivals(time) >= MOST
    cells = {name: gain[here].groupby(["query", "engine"]) for name, here in (("high", slow), ("low", ~slow))}
    middle = {name: of.median().unstack() for name, of in cells.items()}
    claim(first.loc["contacts"].idxmax() == "siblings" and first.loc["distance"].idxmax() == "mixed" and behind.loc["touching", ["siblings", "mixed"]].max() < 1.1,
          "from the roots, siblings are the fastest kernel for contacts, mixed is for distances, and both are for touching")
    claim(all(middle["high"].loc[query].idxmin() == behind.loc[query].idxmin() for query in ("touching", "contacts")),
          "for touching and contacts, a front is worth least on the kernel that is fastest from the roots")
    claim((middle["high"].loc[["touching", "contacts"], ["siblings", "mixed"]].max(axis=1) < middle["high"].loc[["touching", "contacts"], fronts.BINARY]).all(),
          "for touching and contacts, a front is worth less on siblings and mixed than on binary trees")
    rows, found = [], {}
    for query in fronts.QUERIES:
        for engine in behind.loc[query].dropna().sort_values().index:
            rows.append([query if query not in (row[0] for row in rows) else "", KERNELS[engine], f"{behind.loc[query, engine]:.2f}",
                         f"{100 * first.loc[query, engine]:.0f} %", *(f"{table.loc[query, engine]:.2f}" for table in middle.values())])
            found |= {f"{query}_{SHORT[engine]}": middle["high"].loc[query, engine], f"{query}_{SHORT[engine]}_roots": behind.loc[query, engine]}
    return {**found, "rows": rows, "most": MOST}


TWINS = {"margins": "adaptive", "recursive": "recursive-both"}  # on siblings and mixed, one loop that was timed twice


def without_twins(time):
    """by_configuration, but of two names of one loop the mean of both (geometric)."""
    table = by_configuration(time)
    for engine in ("siblings", "mixed"):
        for name, twin in TWINS.items() if ("margins", engine) in table else ():
            table[name, engine] = (table[name, engine] * table[twin, engine]) ** 0.5
            table = table.drop(columns=[(twin, engine)])
    return table


def two_configurations(table):
    """(survival, the front from it on, what is taken below) of least sum of logarithms over the fastest of all configurations."""
    share = level(table, "survival").to_numpy()
    lost = np.log(table.div(table.min(axis=1), axis=0))
    fronts_, frontless = ([at for at in table if (at[0] in FRONTLESS) == without] for without in (False, True))
    return min(((limit, kept, roots) for limit in (*np.unique(share), 1.001) for kept in fronts_ for roots in frontless),
               key=lambda each: np.where(share >= each[0], lost[each[1]], lost[each[2]]).sum())


@quotes("fronts")
def fixed(record):
    """A rule of two configurations for each query: which, from which survival on, and what each is worth beside the other."""
    time, rows, found, losses = fronts.read(record), [], {}, []
    for query in fronts.QUERIES:
        table = without_twins(time.xs(query, level="query", drop_level=False)).dropna(axis=1)
        limit, kept, roots = two_configurations(table)
        above = level(table, "survival") >= limit
        ratio, names = table[roots] / table[kept], [called(pd.Series([at]))[0] for at in (kept, roots)]
        loss = np.where(above, table[kept], table[roots]) / table.min(axis=1)
        losses.append(loss)
        for name, other, of, when in ((names[0], names[1], ratio[above], f"survival from {limit:.2f} on"), (names[1], names[0], 1 / ratio[~above], "less survives")):
            rows.append([f"{query}, {when}", name, f"{of.median():.2f} ({Interval(of):.2f}) times as fast as {other}; the other is faster in {(of < 1).sum()} of {len(of)} scenes"])
        found[f"{query}_configurations"] = table.shape[1]
    losses = pd.concat(losses)
    return {**found, "rows": rows, "off": losses.median(), "most": losses.max(), "wrong": 100 * (losses > fronts.MISTAKEN).mean()}


@quotes("fronts")
def overall(record):
    """The fastest configuration of all kernels with a front, and without, by query and survival."""
    time = fronts.read(record)
    (with_front, kept), (without, frontless) = fastest_of(time, KEPT), fastest_of(time, FRONTLESS)
    gain = (without / with_front).rename("gain")
    lines, found = [], {}
    for query in fronts.QUERIES:
        of_query = level(gain, "query") == query
        for low, high, name in SHARES:
            share = level(gain, "survival")
            here = of_query & (share >= low) & (share < high)
            best, most = called(kept[here])
            roots, roots_most = called(frontless[here])
            lines.append([query if low == 0 else "", name, f"{gain[here].median():.2f} ({Interval(gain[here]):.2f})", f"{best} ({most:.0f} %)", f"{roots} ({roots_most:.0f} %)"])
        table = gain[of_query].reset_index()
        limit = min([0, *table.survival, 1.001], key=lambda each, table=table: (table.gain[table.survival >= each] < 1).sum() + (table.gain[table.survival < each] > 1).sum())
        above = of_query & (level(gain, "survival") >= limit)
        below = of_query & ~above
        found[f"{query}_limit"], found[f"{query}_above"], found[f"{query}_below"] = limit, Interval(gain[above]), Interval(1 / gain[below])
    configurations = by_configuration(time.xs("contacts", level="query", drop_level=False))
    return {**found, "rows": lines, "configurations": len(configurations.dropna(axis=1).columns)}


@quotes("fronts")
def lists(record):
    """What a list saves at most in tests, what lists are worth, and a kinetic list beside margins."""
    time = fronts.read(record)
    sums = pd.read_csv(records.table_at(record / f"{record.name}.coherence.csv"))
    sums = sums[(sums["query"] == "contacts") & (sums.volume == "obb")]
    ratio = (sums.tests / sums.entries).groupby(sums.fan_out)
    best = time[fronts.STRATEGIES].idxmin(axis=1).isin(fronts.LISTS)
    gain = fronts.worth(time, fronts.LISTS)
    found = {}
    for name, key in SHORT.items():
        for query in fronts.QUERIES[:2]:
            found[f"{query}_{key}"] = gain.xs((query, name), level=("query", "engine")).max()
        found[f"best_{key}"] = 100 * best.xs(name, level="engine").mean()
    twice = pd.concat([(time["recursive-both"] / time.recursive), (time.adaptive / time.margins)])
    twice = twice[level(twice, "engine").isin(["siblings", "mixed"])]
    more, slower, beside = fronts.kinetic(record.parent / "best-rebuilds")
    claim((slower > 1).all() and (beside > 1).all(), "a kinetic list is slower than margins and lists in each cell of slow motion")
    adaptive = time.adaptive / time[fronts.STRATEGIES].min(axis=1)
    return {**found, "two": Interval([ratio.get_group(2).min(), ratio.get_group(2).max()]), "sixteen": Interval([ratio.get_group(16).min(), ratio.get_group(16).max()]),
            "kinetic_tests": Interval(more), "kinetic_time": Interval(slower), "kinetic_list": Interval(beside), "noise": 100 * (twice - 1).abs().quantile(0.9),
            "adaptive": adaptive.median(), "adaptive_most": adaptive.max(), "adaptive_near": 100 * (adaptive <= fronts.MISTAKEN).mean()}


@quotes("fronts")
def hypotheses(record):
    judged = list(fronts.judged(fronts.read(record), record))
    claim(len(judged) == HYPOTHESES, "nine hypotheses")
    return {"rows": [[str(number), "holds" if holds else "fails", why] for number, holds, why in judged],
            "holding": sum(holds for _, holds, _ in judged), "all": HYPOTHESES}
