# SPDX-License-Identifier: BSD-3-Clause
"""From arrays to the last answer: choice, trees and frames together, of `recommended` beside every library."""

from functools import cache

import numpy as np
from bvlab_plots import records
from quoting import Interval, claim, quotes


@cache
def totals(record):
    """The rows, and by motion and number of frames: ms of `recommended`, and of the fastest library, and which."""
    rows = records.read(record)
    claim((rows.differing[rows.peer == ""] == 0).all(), "answers of ours agree")
    rows = rows.assign(ms=(rows.build_ns + rows.time_ns) / 1e6)
    median = rows.groupby(["motion", "frames", "method", "peer"]).ms.median().reset_index()
    theirs = median[median.peer != ""]
    found = median[median.peer == ""].set_index(["motion", "frames"])[["ms"]]
    fastest = theirs.loc[theirs.groupby(["motion", "frames"]).ms.idxmin()].set_index(["motion", "frames"])
    return rows, found.assign(library=fastest.method, theirs=fastest.ms, times=fastest.ms / found.ms)


@quotes("end-to-end")
def end_to_end(record):
    rows, found = totals(record)
    times = found.times.unstack("frames")
    numbers = sorted(times.columns)
    nine = times.index.str.startswith("nine")
    meshes, times = times[nine], times[~nine]
    claim(len(times) == 14 and len(meshes) == 5 and numbers == [1, 10, 100, 500, 2000], "fourteen motions, five meshes, and up to 2000 frames, are in the record")
    values = {"motions": len(times), "meshes": Interval(meshes.stack()), "libraries": rows[rows.peer != ""].method.str.split(",").str[0].nunique(), "n1": Interval(times[1]), "n500": Interval(times[500]), "n2000": Interval(times[2000])}
    for frames in numbers:
        values |= {f"n{frames}_mean": float(np.exp(np.log(times[frames]).mean())), f"n{frames}_ahead": int((times[frames] >= 1).sum())}
    return values


@quotes("end-to-end")
def end_to_end_table(record):
    _, found = totals(record)
    by_motion = found.unstack("frames")

    def cell(line, frames):
        return f"{line['ms', frames]:.2g} ms, {line['times', frames]:.2g} x {line['library', frames].split(',')[0]}"

    return {"rows": [[motion, *(cell(line, frames) for frames in sorted(found.index.levels[1]))] for motion, line in by_motion.iterrows()]}
