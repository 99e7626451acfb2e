# SPDX-License-Identifier: BSD-3-Clause
"""What a separation list is worth at fan-out F: the hypotheses of experiments/definitions/fan-outs.md, and a figure.

usage: plots/script fan-outs RECORD [--out DIR] [--table-only]
"""

import matplotlib
import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.ticker import NullLocator

from bvlab_plots import records, style
from bvlab_plots.arguments import record_arguments
from bvlab_plots.refused import Refused

MEASURED = ["n_u", "n_v", "n_p", "time_ns"]
CELL = ["mesh", "motion", "volume", "fan_out", "frame"]
SLOW, FAST = "0.0003 / 0.03", ["0.03 / 5", "0.3 / 45"]
KEEPING = ["separation-list", "deferred", "raise", "margins"]
RIGID = ["sphere", "obb", "rss"]
MOTIONS = ["rest", SLOW, "0.003 / 0.3", *FAST]
LABELS = dict(zip(MOTIONS, ("at rest", "0.03 degrees", "0.3 degrees", "5 degrees", "45 degrees")))
AT_REST = {2: (1.9, 2.0), 4: (1.25, 1.5), 8: (1.1, 1.25), 16: (1.05, 1.15)}


def all_rows(record):
    rows = records.read(record)
    records.wrong_answers(rows)
    return rows


def survival(record, volumes=None):
    """By motion, the share of a binary recursion's front that is there again in the next frame; of all volumes together, or of these."""
    measured = pd.read_csv(records.table_at(record / f"{record.name}.coherence.csv"))
    if "fan_out" in measured:
        measured = measured[measured.fan_out == 2]
    if volumes:
        measured = measured[measured.volume.isin(volumes)]
    at = [tuple(motion.split(" / ")) if motion != "rest" else ("0", "0") for motion in MOTIONS]
    sums = measured.groupby([measured.step.str.removesuffix("body").astype(float), measured.degrees.astype(float)])[["kept", "entries"]].sum()
    return [sums.kept[float(step), float(degrees)] / sums.entries[float(step), float(degrees)] for step, degrees in at]


def read(record):
    """A row for each cell: tests and time of every strategy, summed over seeds, times medians of repetitions."""
    rows = records.read(record)
    missing = {*CELL, "strategy", "seed", *MEASURED, "front"} - set(rows)
    if missing:
        raise Refused(f"{record}: no record of fan-outs, for it has no column {sorted(missing)[0]}")
    records.wrong_answers(rows)
    middle = rows.groupby([*CELL, "strategy", "seed"])[[*MEASURED, "front", "pairs"]].median().reset_index()
    middle["entries"] = middle.front * middle.pairs
    return middle.groupby([*CELL, "strategy"])[[*MEASURED, "entries", "pairs"]].sum()


def savings(cells, of, strategy):
    """Recursion's over the strategy's, of each cell."""
    return cells.xs("recursive", level="strategy")[of] / cells.xs(strategy, level="strategy")[of]


def at_rest(cells):
    """Recursion's tests over the entries of the front that it leaves: a list's run that is no rebuild tests each once."""
    rest = cells.xs("rest", level="motion", drop_level=False)
    return rest.xs("recursive", level="strategy").n_v / rest.xs("separation-list", level="strategy").entries


def within_a_third(ratio):
    """Of each cell, whether one saving is within a third of the other, which is by how much it differs at most."""
    return (ratio - 1).abs() <= 1 / 3


def judged(cells):
    rest = at_rest(cells)
    of_rest = {fan_out: rest.xs(fan_out, level="fan_out") for fan_out in AT_REST}
    yield (1, all(values.between(*AT_REST[fan_out]).all() for fan_out, values in of_rest.items()),
           "; ".join(f"{fan_out}: {values.min():.2f} to {values.max():.2f}" for fan_out, values in of_rest.items()))
    deferred = savings(cells, "n_v", "deferred").xs(SLOW, level="motion").unstack("fan_out")
    yield (2, bool((deferred > 1).all().all() and (deferred[2] > deferred[16]).all() and (deferred[16] < 1.1).all()),
           "; ".join(f"{fan_out}: {deferred[fan_out].min():.2f} to {deferred[fan_out].max():.2f}" for fan_out in deferred))
    fast = pd.concat([savings(cells, "n_v", name) for name in ("separation-list", "deferred")])
    fast = fast[fast.index.get_level_values("motion").isin(FAST) & fast.index.get_level_values("fan_out").isin([8, 16])]
    yield 3, bool((fast <= 1).all()), f"savings {fast.min():.2f} to {fast.max():.2f}"
    margins = savings(cells, "n_v", "margins").xs(SLOW, level="motion").unstack("fan_out")
    change = margins[16] / margins[2]
    share = within_a_third(change).mean()
    yield 4, bool(share >= 0.75), f"{share:.0%} of cells; 16 over 2: {change.min():.2f} to {change.max():.2f}"
    time = savings(cells, "time_ns", "deferred").xs(SLOW, level="motion").unstack("fan_out")
    yield (5, bool((time[2] > 1).all() and (time[16] < 1.1).mean() > 0.5),
           "; ".join(f"{fan_out}: {time[fan_out].min():.2f} to {time[fan_out].max():.2f}" for fan_out in time))
    frames = savings(cells, "n_v", "deferred").xs(SLOW, level="motion").unstack("frame")
    frames = frames[frames.index.get_level_values("volume").isin(RIGID)]
    off = (frames.body / frames.world - 1).abs().max()
    yield 6, bool(off < 0.05), f"at most {off:.1%}"
    slow = cells.xs(SLOW, level="motion").time_ns.unstack("strategy")
    ratio = slow.drop(columns="margins").min(axis=1) / slow.margins
    medians = ratio.groupby(["fan_out", "frame"]).median()
    yield 7, bool((medians > 1).all()), f"the fastest other over margins: {medians.min():.2f} to {medians.max():.2f}"


def colours(fan_outs):
    return {fan_out: matplotlib.colormaps["viridis"](0.85 - 0.27 * i) for i, fan_out in enumerate(fan_outs)}


def draw_coherence(cells, shares, out, figure=None, axes=None, names=("deferred", "raise", "margins"), name="fan-outs-coherence"):
    """Speedup against coherence, a line for each fan-out: median and range of cells; in tests above, in time below."""
    if figure is None:
        figure, axes = plt.subplots(2, len(names), figsize=(7.4, 4.6), sharex=True, sharey="row", layout="constrained")
    places = range(len(MOTIONS))
    for line, (what, label) in zip(axes, (("n_v", "tests"), ("time_ns", "time"))):
        for axis, strategy in zip(line, names):
            saved = savings(cells, what, strategy)
            for (fan_out, colour), marker in zip(colours(AT_REST).items(), "os^D"):
                values = saved.xs(fan_out, level="fan_out").groupby("motion")
                least, middle, most = (of.reindex(MOTIONS) for of in (values.min(), values.median(), values.max()))
                axis.plot(places, middle, color=colour, marker=marker, label=f"F = {fan_out}")
                axis.fill_between(places, least, most, color=colour, alpha=0.15, linewidth=0)
            axis.axhline(1, color="black", linewidth=0.7)
            axis.set_yscale("log")
            axis.set_yticks([0.1, 0.3, 1, 3, 10, 30, 100], ["0.1", "0.3", "1", "3", "10", "30", "100"])
            axis.yaxis.set_minor_locator(NullLocator())
            axis.set_xticks(places, [f"{100 * share:.{0 if share < 0.995 else 1}f}".removesuffix(".0") for share in shares])
        line[0].set_ylabel(f"speedup in {label}")
    for axis, strategy in zip(axes[0], names):
        axis.set_title(strategy)
    figure.supxlabel("share of the front that the next frame finds again, % (at rest, 0.03, 0.3, 5, 45 degrees per frame)",
                     fontsize=plt.rcParams["axes.labelsize"])
    style.legend_below(figure, *style.labelled(axes.flat))
    return style.save(figure, out, name)


def main():
    arguments = record_arguments(__doc__, table_only=True)
    cells = read(arguments.record)
    print("Hypotheses:")
    for number, holds, why in judged(cells):
        print(f"  {number}: {'holds' if holds else 'fails'}: {why}")
    if not arguments.table_only:
        print(draw_coherence(cells, survival(arguments.record), arguments.out))

