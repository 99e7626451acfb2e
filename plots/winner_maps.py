#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Maps of the volume and strategy that win, over two axes of a record.

usage: winner_maps.py RECORD [--out FOLDER] [--table-only]

The two axes are the parameters that vary besides volume and strategy: `step` and `degrees`, or `side` and
`polygons`. Each field names the fastest, its time per pair, and how many times as fast as spheres from the
roots it is; its colour is the strategy's.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import records
import style
from arguments import record_arguments

TITLES = {"step": "translation a frame", "degrees": "rotation a frame, degrees", "side": "side of the cube",
          "polygons": "polygons of a body"}


def read(record):
    (table,) = [p for p in Path(record).glob("winners-*.csv") if p.name.count(".") == 1]
    rows = records.table(table)
    if (rows.differing != 0).any():
        raise SystemExit("a variant's answers differ from the reference: refused")
    across, down = [c for c in ("step", "degrees", "side", "polygons") if rows[c].nunique() > 1]
    rows["ns"] = rows.time_ns / rows.pairs
    # A peer stands as a strategy, with no volume.
    rows["strategy"] = rows.strategy.where(rows.peer == "", rows.peer)
    middle = rows.groupby([across, down, "volume", "strategy"], sort=False).ns.median().reset_index()
    return middle, across, down, table.stem


def winners(rows, across, down):
    best = rows.loc[rows.groupby([across, down], sort=False).ns.idxmin()].copy()
    base = rows[(rows.volume == "sphere") & (rows.strategy == "recursive")]
    best = best.merge(base[[across, down, "ns"]], how="left", on=[across, down], suffixes=("", "_base"))
    best["speedup"] = best.ns_base / best.ns
    return best


def ink(colour):
    """Black or white, whichever reads on the colour."""
    r, g, b = plt.matplotlib.colors.to_rgb(colour)
    return "black" if 0.3 * r + 0.59 * g + 0.11 * b > 0.5 else "white"


def readable(name, value):
    return str(value).replace("body", " radii") if name in ("step", "side") else f"{value:g}"


def draw(rows, across, down, out, name):
    best = winners(rows, across, down)
    columns, lines = list(dict.fromkeys(rows[across])), list(dict.fromkeys(rows[down]))
    looks = style.looks(rows.strategy)
    figure, axis = plt.subplots(figsize=(1.35 * len(columns) + 0.9, 0.85 * len(lines) + 1.1))
    for _, field in best.iterrows():
        x, y = columns.index(field[across]), lines.index(field[down])
        colour = looks[field.strategy]["color"]
        speedup = f"{field.speedup:.1f}×" if field.speedup > 0 else ""
        axis.add_patch(plt.Rectangle((x - 0.48, y - 0.47), 0.96, 0.94, color=colour))
        axis.text(x, y, "\n".join(filter(None, (field.volume, f"{field.ns:.0f} ns", speedup))), ha="center", va="center",
                  color=ink(colour), fontsize=8)
    axis.set(xlim=(-0.5, len(columns) - 0.5), ylim=(-0.5, len(lines) - 0.5), xlabel=TITLES[across],
             ylabel=TITLES[down])
    axis.set_xticks(range(len(columns)), [readable(across, v) for v in columns])
    axis.set_yticks(range(len(lines)), [readable(down, v) for v in lines])
    axis.grid(False)
    present = dict.fromkeys(best.strategy)
    handles = [plt.Rectangle((0, 0), 1, 1, color=looks[s]["color"]) for s in present]
    axis.legend(handles, list(present), loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=len(present),
                frameon=False)
    return style.save(figure, out, name)


def main():
    arguments = record_arguments(__doc__, table_only=True)
    rows, across, down, name = read(arguments.record)
    best = winners(rows, across, down)
    print(f"Fastest per field, nanoseconds per pair, and over spheres from the roots ({name}):")
    print(best.drop(columns="ns_base").round(2).to_string(index=False))
    if not arguments.table_only:
        print(draw(rows, across, down, arguments.out, name))


if __name__ == "__main__":
    main()
