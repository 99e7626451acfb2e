#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The cost model T = N_u C_u + N_v C_v + N_p C_p: predicted from unit costs against measured, and
where the time goes.

usage: cost_model.py RECORD [--out FOLDER]

RECORD holds cost-model.csv and unit-costs.json (bench_unit_costs --benchmark_format=json).
"""

import json
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import records
import style
from arguments import record_arguments


def unit_costs(path):
    """Nanoseconds per volume: to place a body, pose a volume, test a pair; and to test triangles."""
    costs, triangles = {}, {}
    for entry in json.loads(Path(path).read_text())["benchmarks"]:
        what, name, *rest = entry["name"].split("/")
        ns = entry["ns"]
        if what == "triangles":
            triangles[(name, rest[0])] = ns
        elif what == "test":
            costs.setdefault(name, {}).setdefault(("test", int(rest[0])), []).append(ns)
        elif what in ("place", "pose"):
            costs.setdefault(name, {})[what] = ns
    for of_volume in costs.values():
        widest = max(key[1] for key in of_volume if isinstance(key, tuple))
        of_volume["batched"] = np.mean(of_volume[("test", widest)])
        of_volume["alone"] = np.mean(of_volume[("test", 1)])
    return costs, triangles[("exact", "apart")]


def predicted(rows, costs, triangle):
    """Adds the terms of T in microseconds per pair and frame."""
    pairs = rows.pairs
    of = lambda key: rows.volume.map(lambda v: costs[v][key])
    rows["us_u"] = rows.n_u * of("pose") / pairs / 1e3
    rows["us_v"] = rows.n_v * of("batched") / pairs / 1e3
    rows["us_p"] = rows.n_p * triangle / pairs / 1e3
    rows["us_placed"] = rows.frames * rows.objects * of("place") / pairs / 1e3
    rows["us_model"] = rows.us_u + rows.us_v + rows.us_p
    rows["us_measured"] = rows.time_ns / pairs / 1e3
    return rows


def read(record):
    rows = records.table(Path(record) / "cost-model.csv")
    records.say_left_out(rows[rows.peer.notna() & (rows.peer != "")].peer, "which count nothing")
    rows = rows[rows.peer.isna() | (rows.peer == "")]
    wrong = rows[rows.differing != 0]
    if len(wrong):
        raise SystemExit(f"{record}: answers differ: {wrong.volume.unique()}")
    keys = ["query", "motion", "density", "volume", "strategy"]
    rows = rows.groupby(keys, sort=False, as_index=False).median(numeric_only=True)
    costs, triangle = unit_costs(Path(record) / "unit-costs.json")
    records.say_left_out(set(rows.volume) - set(costs), "whose unit costs are not in unit-costs.json")
    return predicted(rows[rows.volume.isin(costs)].copy(), costs, triangle), costs, triangle


def draw_errors(rows, out):
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.2, 3.4))
    volumes = list(dict.fromkeys(rows.volume))
    for density, look in style.looks(rows.density).items():
        part = rows[rows.density == density]
        left.plot(part.us_measured, part.us_model, ms=3.5, alpha=0.7, label=density, **style.marker_style(look))
    ends = [rows.us_measured.min() / 2, rows.us_measured.max() * 2]
    left.plot(ends, ends, color="#8f8f8f", lw=1)
    left.plot(ends, np.array(ends) / 2, color="#8f8f8f", lw=0.6, ls=":")
    left.set(xscale="log", yscale="log", xlabel="measured, us per pair",
             ylabel="$N_u C_u + N_v C_v + N_p C_p$, us per pair",
             title="The model leaves out what a pair costs by itself")
    left.legend(frameon=False)
    busy = rows[rows.density != "sparse"]
    ratio = [busy[busy.volume == v].us_model / busy[busy.volume == v].us_measured for v in volumes]
    right.boxplot(ratio, vert=True, widths=0.6, medianprops=dict(color="#d95f0e"))
    right.set_xticklabels(volumes, rotation=45)
    right.axhline(1, color="#8f8f8f", lw=1)
    right.set(ylabel="predicted / measured", title="dense and interlocked scenes", ylim=(0, None))
    figure.tight_layout()
    style.save(figure, out, "cost-model-error")


def draw_split(rows, out):
    # One strategy and motion, where pairs cost more than to be looked at.
    part = rows[(rows.strategy == "recursive") & (rows.motion == rows.motion.iloc[0]) & (rows.density != "sparse")]
    panels = list(dict.fromkeys(zip(part["query"], part.density)))
    figure, axes = plt.subplots(1, len(panels), figsize=(1.8 * len(panels), 3.0), squeeze=False)
    axes = axes[0]
    terms = [("us_u", "posing $N_u C_u$", "#41a5c4"), ("us_v", "volumes $N_v C_v$", "#1b1b1b"),
             ("us_p", "triangles $N_p C_p$", "#d95f0e")]
    for axis, (query, density) in zip(axes, panels):
        group = part[(part["query"] == query) & (part.density == density)]
        bottom = np.zeros(len(group))
        for column, label, colour in terms:
            axis.bar(group.volume, group[column], bottom=bottom, color=colour, label=label)
            bottom += group[column].to_numpy()
        axis.plot(group.volume, group.us_measured, "x", color="#b0413e", label="measured")
        axis.set_title(f"{query}, {density}")
        axis.tick_params(axis="x", rotation=90)
    axes[0].set_ylabel("us per pair")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=4, frameon=False)
    figure.tight_layout(rect=(0, 0.07, 1, 1))
    style.save(figure, out, "cost-model-split")


def main():
    arguments = record_arguments(__doc__)
    out = arguments.out
    rows, costs, triangle = read(arguments.record)
    table = pd.DataFrame({v: {"place": c["place"], "C_u": c["pose"], "C_v batched": c["batched"],
                              "C_v alone": c["alone"]} for v, c in costs.items()}).T
    print("Unit costs, ns:")
    print(table.round(1).to_string())
    print(f"C_p, batched: {triangle:.1f} ns")
    ratio = rows.us_model / rows.us_measured
    print("Predicted / measured, median by density and strategy:")
    print(ratio.groupby([rows.density, rows.strategy]).median().unstack().round(2).to_string())
    busy = rows[rows.density != "sparse"]
    loop = (busy.us_measured - busy.us_model) * 1e3 * busy.pairs / busy.n_v
    print("What is left over, ns a test of volumes (dense and interlocked):")
    print(loop.groupby(busy.volume, sort=False).describe()[["25%", "50%", "75%"]].round(1).to_string())
    draw_errors(rows, out)
    draw_split(rows, out)


if __name__ == "__main__":
    main()
