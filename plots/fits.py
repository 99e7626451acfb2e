#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""What a tighter construction and another build gain: tests and time over those of the published
construction, split along the principal axis.

usage: fits.py RECORD [--out FOLDER]

RECORD holds fits.csv.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import records
import style
from arguments import record_arguments

BASE = ("top-down-principal", "published")


def read(record):
    """One row for each polygons, query, volume, build and fit: N_v and time over the base's."""
    rows = records.table(Path(record) / "fits.csv")
    rows["variant"] = records.variant_names(rows)
    if (rows.hits.groupby([rows.polygons, rows["query"]]).nunique() != 1).any():
        raise SystemExit(f"{record}: answers differ")
    keys = ["polygons", "query", "variant", "build", "fit"]
    rows = rows.groupby(keys, sort=False, as_index=False).median(numeric_only=True)
    base = rows[(rows.build == BASE[0]) & (rows.fit == BASE[1])]
    records.say_left_out(set(rows.variant) - set(base.variant), "not built as " + ", ".join(BASE))
    rows = rows.merge(base[["polygons", "query", "variant", "n_v", "time_ns", "build_ns"]],
                      on=["polygons", "query", "variant"], suffixes=("", "_base"))
    for measure in ("n_v", "time_ns", "build_ns"):
        rows[measure] /= rows[measure + "_base"]
    return rows


def draw(rows, out):
    queries, builds = list(dict.fromkeys(rows["query"])), list(dict.fromkeys(rows.build))
    rows = rows[rows.polygons == rows.polygons.max()]
    figure, axes = plt.subplots(2, len(queries), figsize=(7.2, 4.6), sharex=True, sharey="row",
                             squeeze=False)
    places = np.arange(len(builds))
    looks, fits = style.variant_looks(rows.variant), style.looks(rows.fit)
    for column, query in enumerate(queries):
        part = rows[rows["query"] == query]
        for variant in dict.fromkeys(rows.variant):
            look = looks[variant]
            # What has no tight construction makes the same tests: drawn once.
            published = part[(part.variant == variant) & (part.fit == "published")].set_index("build")
            for fit in dict.fromkeys(["published", *part.fit]):
                fill = {"published": look["color"], "tight": "white"}.get(fit, fits[fit]["color"])
                filled = fit == "published"
                line = part[(part.variant == variant) & (part.fit == fit)].set_index("build")
                if not filled and line.n_v.equals(published.n_v.reindex(line.index)):
                    continue
                for axis, measure in zip(axes[:, column], ("n_v", "time_ns")):
                    axis.plot(places, line[measure].reindex(builds), marker=look["marker"],
                              color=look["color"], markersize=4,
                              linestyle={"published": "-", "tight": ":"}.get(fit, fits[fit]["linestyle"]),
                              markerfacecolor=fill,
                              label=variant if filled else f"{variant}, {fit}")
        axes[0, column].set_title(query)
        for axis in axes[:, column]:
            axis.axhline(1, color="#8f8f8f", lw=0.8)
            axis.set_xticks(places, [b.replace("top-down-", "") for b in builds], rotation=60,
                            ha="right")
    axes[0, 0].set_ylabel("tests of volumes, relative")
    axes[1, 0].set_ylabel("time, relative")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=8, frameon=False, columnspacing=1)
    figure.tight_layout(rect=(0, 0.06, 1, 1))
    style.save(figure, out, "fits")


def main():
    arguments = record_arguments(__doc__)
    rows = read(arguments.record)
    print("Over top-down-principal, published (geometric mean over queries and polygons):")
    for measure in ("n_v", "time_ns", "build_ns"):
        table = np.exp(np.log(rows[measure]).groupby([rows.build, rows.fit, rows.variant],
                                                     sort=False).mean()).unstack()
        print(measure)
        print(table.round(2).to_string())
    draw(rows, arguments.out)


if __name__ == "__main__":
    main()
