# SPDX-License-Identifier: BSD-3-Clause
"""What a front is worth by query, kernel and survival: a rule, the hypotheses of experiments/definitions/fronts.md, and a figure.

usage: plots/script fronts RECORD [--out DIR] [--table-only]

RECORD is that of fronts; the records of fronts-distance, best-rebuilds and coherence lie beside it.
"""

from functools import cache

import matplotlib
import numpy as np
import pandas as pd

from bvlab_plots import records, style
from bvlab_plots.arguments import record_arguments
from bvlab_plots.refused import Refused
from bvlab_scripts.law import FRONTLESS

LISTS = ["separation-list", "deferred", "raise"]
STRATEGIES = [*FRONTLESS, *LISTS, "margins", "adaptive"]
QUERIES = ["touching", "contacts", "distance"]
BINARY = "gathered, 2"
SCENE = ["mesh", "polygons", "degrees"]
CELL = ["query", "engine", *SCENE]
MISTAKEN = 1.2  # times the fastest strategy's time


def survival(record):
    """By query and scene, the share of a binary recursion's front that is there again in the next frame."""
    sums = pd.read_csv(records.table_at(record / f"{record.name}.coherence.csv"))
    sums = sums[(sums.volume == "obb") & (sums.fan_out == 2)].groupby(["query", *SCENE])[["kept", "entries"]].sum()
    return (sums.kept / sums.entries).rename("survival")


def medians(record, of, cell=CELL):
    """A row for each cell, a column for each strategy: the median over seeds."""
    rows = records.read(record)
    missing = {*cell, "strategy", *of} - set(rows)
    if missing:
        raise Refused(f"{record}: no record of fronts, for it has no column {sorted(missing)[0]}")
    records.wrong_answers(rows)
    middle = rows[of[0]] / rows[of[1]]
    return middle.groupby([rows[name] for name in (*cell, "strategy")]).median().unstack("strategy")


@cache
def read(record):
    """Times in ns per pair without the first frame, and the survival of the scene, in the index; of distances that of contacts."""
    time = pd.concat([medians(part, ["later_ns", "later_pairs"]) for part in (record, record.parent / "fronts-distance")])
    share = survival(record)
    of_contacts = share.xs("contacts").to_frame().assign(query="distance").set_index("query", append=True).survival
    share = pd.concat([share, of_contacts.reorder_levels(share.index.names)])
    return time.join(share, on=share.index.names).set_index("survival", append=True)


def worth(time, strategies):
    """The time of the fastest way without a front over that of the fastest of these strategies."""
    return time[FRONTLESS].min(axis=1) / time[strategies].min(axis=1)


def survivals(time):
    return time.index.get_level_values("survival").to_numpy()


def off(time, threshold):
    """The time of what the rule takes (margins where the survival is at least the threshold) over the fastest strategy's."""
    return time.margins.where(survivals(time) >= threshold, time[FRONTLESS].min(axis=1)) / time.min(axis=1)


def threshold(time):
    """The survival from which on margins are taken, by the least sum of logarithms of what the rule loses."""
    at = np.unique(survivals(time))
    between = [0, *((at[1:] + at[:-1]) / 2), 1.001]
    return min(between, key=lambda each: np.log(off(time, each)).sum())


def thresholds(time):
    """By query and kernel."""
    parts = sorted(time.groupby(level=["query", "engine"]), key=lambda part: QUERIES.index(part[0][0]))
    return {at: threshold(part) for at, part in parts}


def rule_off(time):
    """What the rule loses in each cell, with its own thresholds."""
    return pd.concat([off(time.xs(at, level=("query", "engine"), drop_level=False), limit) for at, limit in thresholds(time).items()])


def left_out(record):
    """Times and survival of shapes and motion models that the rule was not fitted on: binary trees of oriented boxes."""
    rows = records.right(record, needs=["entries"])
    rows = rows[(rows.volume == "obb") & (rows.peer == "")]
    seen = rows.mesh.isin(["bunny", "knot", "ChineseDragon-10kv"]) & (rows.motion_model == "all bodies, all freedoms")
    cell = ["query", "mesh", "motion", "motion_model"]
    rows = rows[~seen].assign(survival=rows.kept / rows.entries, time=rows.later_ns / rows.later_pairs)
    return rows.set_index([*cell, "survival", "strategy"]).time.unstack("strategy")


def left_out_off(time, record):
    limits = thresholds(time)
    return pd.concat([off(part, limits[query, BINARY]) for query, part in left_out(record).groupby(level="query")])


def degrees_at(time, query, polygons, share):
    """The step in degrees at which this share survives, between those that were run: median over meshes."""
    scenes = time.xs((query, polygons), level=("query", "polygons")).reset_index()
    found = []
    for _, scene in scenes.groupby("mesh"):
        steps = scene.groupby("degrees").survival.first()
        found.append(np.exp(np.interp(-share, -steps.to_numpy(), np.log(steps.index.to_numpy()))))
    return float(np.median(found))


def judged(time, record):
    """(number, whether it holds, why) of each hypothesis."""
    share = pd.Series(survivals(time), time.index)
    gain = worth(time, ["margins"])
    fastest = time[STRATEGIES].idxmin(axis=1)
    query, engine = (time.index.get_level_values(name) for name in ("query", "engine"))
    binary = (query == "contacts") & (engine == BINARY)
    high, low = gain[binary & (share > 0.95)], gain[binary & (share < 0.5)]
    yield 1, bool((high > 1).all() and (low <= 1).all()), f"above .95 {high.min():.2f} to {high.max():.2f}, below .5 {low.min():.2f} to {low.max():.2f}"
    touching = query == "touching"
    high, low = gain[touching & (share > 0.9)], fastest[touching & (share < 0.8)]
    yield 2, bool((high > 1).all() and (low == "witness").mean() > 0.5), f"above .9 {high.min():.2f} to {high.max():.2f}; witness in {(low == 'witness').mean():.0%}"
    lists = fastest.isin(LISTS).groupby(engine).mean()
    yield 3, bool((lists < 0.1).all()), "; ".join(f"{name}: {part:.0%}" for name, part in lists.items())
    by_step = gain[query == "contacts"].groupby(["degrees", "engine"]).median().unstack("engine")
    less = by_step[["siblings", "mixed"]].lt(by_step[BINARY], axis=0)
    yield 4, bool(less.all(axis=None)), f"in {int(less.to_numpy().sum())} of {less.size} steps"
    scene = time[query == "contacts"].groupby([*SCENE, "survival"])
    kept = scene.apply(lambda part: part[STRATEGIES].min().idxmin() not in FRONTLESS)
    kept_share = pd.Series(survivals(kept), kept.index)
    yield 5, bool(kept[kept_share > 0.95].all() and not kept[kept_share < 0.7].any()), f"above .95 {kept[kept_share > 0.95].mean():.0%}, below .7 {kept[kept_share < 0.7].mean():.0%}"
    distance = query == "distance"
    high, low = gain[distance & (share > 0.95)], fastest[distance & (share < 0.8)]
    yield 6, bool((high >= 1.5).all() and low.isin(["witness", *LISTS]).mean() > 0.5), f"above .95 {high.min():.2f} to {high.max():.2f}; a list or witness in {low.isin(['witness', *LISTS]).mean():.0%}"
    beside = (time.adaptive / time[STRATEGIES].min(axis=1)) <= MISTAKEN
    yield 7, bool(beside.mean() >= 0.8), f"{beside.mean():.0%} of cells"
    more, slower, _ = kinetic(record.parent / "best-rebuilds")
    yield 8, bool((more >= 2).all() and (slower > 1).all()), f"{more.min():.1f} to {more.max():.1f} times the tests, {slower.min():.1f} to {slower.max():.1f} times the time"
    wrong = left_out_off(time, record.parent / "coherence") > MISTAKEN
    yield 9, bool(wrong.mean() <= 0.2), f"in {wrong.mean():.0%} of {len(wrong)} cells"


KINETIC = ["kinetic-list:8", "kinetic-list:50"]


def kinetic(record):
    """Of best-rebuilds, the better kinetic list's tests and time over those of margins in slow motion, and its time over the best list's."""
    tests, time = (medians(record, of, ["query", "degrees"]) for of in (["n_v", "pairs"], ["later_ns", "later_pairs"]))
    ratios = [tests[KINETIC].min(axis=1) / tests.margins, time[KINETIC].min(axis=1) / time.margins, time[KINETIC].min(axis=1) / time[[*LISTS, "by-cost"]].min(axis=1)]
    return [ratio[ratio.index.get_level_values("degrees") <= 1] for ratio in ratios]


def draw_worth(time, out, figure=None, axes=None, name="fronts-worth"):
    """A point for each cell: what margins, and the best list, are worth, against survival."""
    if figure is None:
        figure, axes = style.subplots(2, len(QUERIES), (7.4, 4.4))
    most = max(10, worth(time, ["margins"]).max(), worth(time, LISTS).max())
    ticks = [tick for tick in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100) if tick <= most]
    engines = list(dict.fromkeys(time.index.get_level_values("engine")))
    colours = [matplotlib.colormaps["viridis"](0.9 - 0.28 * i) for i in range(len(engines))]
    for line, (strategies, label) in zip(axes, ((["margins"], "worth of margins"), (LISTS, "worth of the best list"))):
        for axis, query in zip(line, QUERIES):
            for engine, colour, marker in zip(engines, colours, "os^D"):
                part = time[(time.index.get_level_values("query") == query) & (time.index.get_level_values("engine") == engine)]
                if len(part):
                    axis.plot(survivals(part), worth(part, strategies), marker, color=colour, label=engine, markersize=3.5, alpha=0.8, markeredgewidth=0)
            axis.axhline(1, color="black", linewidth=0.7)
            axis.set_yscale("log")
            axis.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
            axis.minorticks_off()
            axis.set_ylim(0.08, 1.2 * most)
        line[0].set_ylabel(label)
    for axis, query in zip(axes[0], QUERIES):
        axis.set_title(query)
    for axis in axes[-1]:
        axis.set_xlabel("survival")
    style.legend_below(figure, *style.labelled(axes.flat))
    return style.save(figure, out, name)


def main():
    arguments = record_arguments(__doc__, table_only=True)
    time = read(arguments.record)
    for (query, engine), limit in thresholds(time).items():
        part = off(time.xs((query, engine), level=("query", "engine")), limit)
        print(f"{query:9} {engine:13} margins from {limit:.2f} on; over the fastest: median {part.median():.2f}, most {part.max():.2f}, above {MISTAKEN} in {(part > MISTAKEN).mean():.0%}")
    print("Hypotheses:")
    for number, holds, why in judged(time, arguments.record):
        print(f"  {number}: {'holds' if holds else 'fails'}: {why}")
    if not arguments.table_only:
        print(draw_worth(time, arguments.out))
