#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""How K-DOPs are posed: what it costs, what it saves, and what the roots alone dismiss.

usage: posing.py RECORD [--out FOLDER]

RECORD holds posing.csv.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import style
from arguments import record_arguments

DENSITIES = ("interlocked", "dense", "sparse")  # of three sides, the smallest first


def read(record):
    """Medians over repetitions: a row for each density, k, policy and query."""
    rows = pd.read_csv(Path(record) / "posing.csv")
    if rows.differing.any():
        raise SystemExit(f"{record}: answers differ")
    keys = ["mesh", "side", "k", "policy", "query"]
    rows = rows.groupby(keys, sort=False, as_index=False).median(numeric_only=True)
    sides = sorted(rows.side.unique())
    rows["density"] = [DENSITIES[sides.index(s)] if len(sides) == 3 else f"side {s:g}"
                       for s in rows.side]
    for count in ("n_u", "n_v", "n_p"):
        rows[count] /= rows.pairs
    rows["us"] = rows.time_ns / rows.pairs / 1e3
    rows["posing_us"] = rows.n_u * rows.pose_ns / 1e3
    rows["share"] = rows.dismissed / rows.pairs
    for column, first in (("policy", ["realigned", "corners", "hull"]), ("query", ["touching", "contacts", "roots"])):
        rows[column] = pd.Categorical(rows[column], list(dict.fromkeys([*first, *rows[column]])))
    return rows.sort_values(["side", "query", "k", "policy"]).astype({"policy": str, "query": str})


def relative(rows, measure):
    """Every policy over realigned: a column for each density, query and policy, a row for each k."""
    part = rows[rows["query"] != "roots"]
    table = part.pivot_table(index="k", columns=["density", "query", "policy"], values=measure,
                             sort=False)
    base = table.xs("realigned", axis=1, level="policy")
    return pd.DataFrame({key: line / base[key[:2]] for key, line in table.items() if key[2] != "realigned"})


def bars(axis, table, policies, decimals):
    """Groups along the rows of the table, side by side its columns."""
    places, width = np.arange(len(table)), 0.8 / len(policies)
    looks = style.looks(policies)
    for i, policy in enumerate(policies):
        drawn = axis.bar(places + (i - (len(policies) - 1) / 2) * width, table[policy], width,
                         label=policy, **style.bar_style(looks[policy]))
        axis.bar_label(drawn, fmt=f"%.{decimals}f", fontsize=6, padding=1)
    axis.grid(axis="x", visible=False)
    axis.set_xticks(places, table.index)


def draw_ratios(axis, table, title):
    # Corners are what the figure is about: another policy is named.
    named = {key: key[1] + ("" if key[2] == "corners" else f", {key[2]}") for key in table.columns}
    densities, shapes = style.looks(key[0] for key in named), style.looks(named.values())
    for key, line in table.items():
        shape = dict(style.point_style(shapes[named[key]]), color=densities[key[0]]["color"])
        axis.plot(np.arange(len(line)), line, markersize=4, label=f"{key[0]}, {named[key]}", **shape)
    axis.axhline(1, color="#8f8f8f", lw=0.8)
    axis.set_xticks(np.arange(len(table)), table.index)
    axis.set_xlabel("K")
    axis.set_title(title, loc="left")


def draw(rows, out):
    figure, axes = plt.subplots(2, 2, figsize=(7.2, 5.4))
    asked, roots = rows[rows["query"] != "roots"], rows[rows["query"] == "roots"]
    costs = asked.pivot_table(index="k", columns="policy", values="pose_ns", aggfunc="median",
                              sort=False)
    bars(axes[0, 0], costs, list(costs.columns), 0)
    axes[0, 0].set_title("To pose one volume, ns", loc="left")
    axes[0, 0].set_xlabel("K")
    # Where the roots decide about some pairs and not about others, policies can differ most.
    density = roots.groupby("density", sort=False).share.mean().sub(0.5).abs().idxmin()
    shares = roots[roots.density == density].pivot_table(index="k", columns="policy",
                                                         values="share", sort=False) * 100
    bars(axes[0, 1], shares, list(shares.columns), 0)
    axes[0, 1].set_title(f"Pairs dismissed at the roots, %, {density}", loc="left")
    axes[0, 1].set_xlabel("K")
    draw_ratios(axes[1, 0], relative(rows, "n_v"), "Tests of volumes, over realigned's")
    draw_ratios(axes[1, 1], relative(rows, "us"), "Time of a pair, over realigned's")
    low = min(axes[1, 0].get_ylim()[0], axes[1, 1].get_ylim()[0])
    high = max(axes[1, 0].get_ylim()[1], axes[1, 1].get_ylim()[1])
    for axis in axes[1]:
        axis.set_ylim(low, high)
    for axis in axes[0]:
        axis.margins(y=0.12)
    figure.legend(*axes[0, 1].get_legend_handles_labels(), loc="upper center", ncols=3,
                  frameon=False)
    figure.legend(*axes[1, 0].get_legend_handles_labels(), loc="lower center", ncols=3,
                  frameon=False)
    figure.tight_layout(rect=(0, 0.08, 1, 0.96))
    return style.save(figure, out, "posing")


def main():
    arguments = record_arguments(__doc__)
    rows = read(arguments.record)
    keys = ["density", "query", "k", "policy"]
    with pd.option_context("display.width", 200, "display.max_rows", 200):
        print("A pair, medians (us; posing_us is N_u C_u):")
        print(rows[rows["query"] != "roots"].set_index(keys)[
            ["pose_ns", "n_u", "n_v", "n_p", "posing_us", "us"]].round(2).to_string())
        print("Roots: share of pairs dismissed, ns a root:")
        print(rows[rows["query"] == "roots"].pivot_table(
            index=["density", "k"], columns="policy", values=["share", "pose_ns"], sort=False)[
                ["share", "pose_ns"]].round(3).to_string())
    print(draw(rows, arguments.out))


if __name__ == "__main__":
    main()
