#!/usr/bin/env -S /usr/bin/python3 -B
# SPDX-License-Identifier: BSD-3-Clause
"""Ten lines on what the first run found: the talk's speedups, and `recommended` beside other libraries.

usage: first_run.py NINE_BUNNIES BESIDE

Both are folders of records: of nine-bunnies.toml and of first-run.toml, long or small. Times of other libraries whose
answers differ from the exact ones bear a star.
"""

import contextlib
import io
import sys

from bvlab_scripts import nine_bunnies
import quoting
from bvlab_plots import records
from bvlab_plots.arguments import exit_status
from bvlab_plots.refused import Refused

ONE = ["one body, one freedom", "one body, all freedoms"]
TOUCHING = "recommended"


def talk_lines(record):
    runs = nine_bunnies.read(record)
    yield f"{'Speedup over recursion, nine bunnies, one body moves a step':62}{'separation list':>17}{'deferred':>16}"
    separation_list, deferred = nine_bunnies.SPEEDUPS
    yield f"{'  published by Li and Chen, in time':62}{separation_list:>17.2f}{deferred:>16.2f}"
    for what, name in (("n_v", "volume tests"), ("time_ns", "time")):
        means = nine_bunnies.mean_speedups(runs, what)
        if not set(ONE) <= set(means.index.get_level_values("reading")):
            raise Refused(f"{record}: has no runs in which one body moves")
        ours = [format(quoting.Interval(means.loc[ONE][variant]), ".2f") for variant in nine_bunnies.LISTS]
        yield f"{'  here, in ' + name:62}{ours[0]:>17}{ours[1]:>16}"


def beside_lines(record):
    rows = records.right(record, needs=["method", "work"])
    rows = rows[rows["query"] == "touching"] if "query" in rows else rows
    rows = rows.assign(us=rows.time_ns / rows.pairs / 1e3)
    time = rows.groupby(["work", "method"], sort=False).us.median().unstack("method")
    if TOUCHING not in time:
        raise Refused(f"{record}: has no method {TOUCHING}")
    peers = [name for name in dict.fromkeys(rows[rows.peer != ""].method) if name in time]
    wrong = rows[(rows.peer != "") & (rows.differing > 0)].groupby(["work", "method"]).size()
    shown = [TOUCHING, *peers]
    widths = [max(8, len(name) + 2) for name in shown]
    yield f"{'Do two bunnies touch? us per pair':36}" + "".join(f"{name:>{width}}" for name, width in zip(shown, widths))
    for work in time.index:
        cells = [f"{quoting.written(time.loc[work, name], '.2g')}{'*' if (work, name) in wrong.index else ''}" for name in shown]
        yield f"{'  ' + work:36}" + "".join(f"{cell:>{width}}" for cell, width in zip(cells, widths))
    yield "Every answer was compared with the exact one: none of ours differs" + (
        "; a star marks a library whose answers do." if len(wrong) else ", and none of theirs does here.")


def lines(bunnies, beside):
    with contextlib.redirect_stdout(io.StringIO()):  # what ran beside other work is said with each table
        return [*talk_lines(bunnies), "", *beside_lines(beside)]


def main():
    if len(sys.argv) != 3:
        raise Refused("usage: first_run.py NINE_BUNNIES BESIDE")
    print("\n".join(lines(*sys.argv[1:])))


if __name__ == "__main__":
    sys.exit(exit_status(main))
