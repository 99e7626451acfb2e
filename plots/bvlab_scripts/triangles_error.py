# SPDX-License-Identifier: BSD-3-Clause
"""A triangles record as a figure: misclassified pairs per million against time per call, one panel for each set, the
Pareto front drawn.

usage: plots/script triangles-error RECORD [--out FOLDER]
"""

import numpy as np
import matplotlib.pyplot as plt

from bvlab_plots import records, style
from bvlab_plots.arguments import record_arguments

NONE = 3  # the place of zero on the logarithmic axis, in pairs per million


def read(record):
    rows = records.read(record, needs=["set", "test", "false_positives", "false_negatives"])
    rows["wrong"] = (rows.false_positives + rows.false_negatives) / rows.pairs * 1e6
    return rows


def middle_of(rows):
    """Median time and the answers, which are the same in every repetition."""
    keys = ["set", "test", "source"]
    assert (rows.groupby(keys).wrong.nunique() == 1).all()
    return rows.groupby(keys, sort=False).agg(
        ns=("ns_per_call", "median"), wrong=("wrong", "first")).reset_index()


def front_of(points):
    """The points that no other beats in both time and error, fastest first."""
    front, least = [], np.inf
    for ns, wrong in sorted(points):
        if wrong < least:
            front.append((ns, wrong))
            least = wrong
    return front


def draw(middle, out, name):
    sets = list(dict.fromkeys(middle.set))
    lines, looks = -(-len(sets) // 3), style.looks(middle.test)
    figure, axes = plt.subplots(lines, 3, figsize=(7.2, 2.3 * lines), squeeze=False, sharey=True)
    for axis, which in zip(axes.flat, sets):
        group = middle[middle.set == which]
        front = front_of(zip(group.ns, group.wrong))
        axis.step([p[0] for p in front] + [middle.ns.max() * 2], [max(p[1], NONE) for p in front] +
                  [max(front[-1][1], NONE)], where="post", color="#888888", linewidth=1, zorder=1)
        for _, row in group.iterrows():
            marker = style.marker_style(looks[row.test])
            if row.source == "one by one":
                marker["markerfacecolor"] = "none"
            axis.plot(row.ns, max(row.wrong, NONE), markersize=5, zorder=2,
                      label=row.test if row.source == "peer" else f"{row.test}, {row.source}", **marker)
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_xlim(middle.ns.min() / 2, middle.ns.max() * 2)
        axis.set_ylim(NONE / 2, 1e6)
        axis.set_yticks([NONE, 1e2, 1e4, 1e6], ["none", "$10^2$", "$10^4$", "$10^6$"])
        axis.set_yticks([], minor=True)
        axis.set_title(which)
    for axis in list(axes.flat)[len(sets):]:
        axis.set_visible(False)
    for axis in axes[-1, :]:
        axis.set_xlabel("ns per call")
    for axis in axes[:, 0]:
        axis.set_ylabel("wrong per million")
    handles, labels = style.labelled(axes.flat)
    handles = dict(zip(labels, handles))
    known = list(style.STYLES)
    labels = sorted(handles, key=lambda label: known.index(label.split(",")[0]) if label.split(",")[0] in known
                    else len(known))
    figure.legend([handles[label] for label in labels], labels, loc="lower center", ncol=4,
                  frameon=False, bbox_to_anchor=(0.5, -0.07))
    figure.tight_layout()
    return style.save(figure, out, name)


def main():
    arguments = record_arguments(__doc__)
    rows = read(arguments.record)
    print(draw(middle_of(rows), arguments.out, rows.attrs["name"]))

