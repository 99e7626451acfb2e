# SPDX-License-Identifier: BSD-3-Clause
"""Records as pandas frames and matplotlib figures, by bvlab_plots, the library of plots/."""

from __future__ import annotations

import contextlib
import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # what takes long to import is imported where it is used
    import matplotlib.figure
    import pandas

_looks: dict[str, object] = {}  # settings of matplotlib that bvlab_plots draws with


def record(path: str | os.PathLike) -> pandas.DataFrame:
    """The rows of a record as a pandas frame: one for each variant, scene, seed and repetition.

    Numbers are numbers, NaN where there is none; times in ns. frame.attrs has name, kind, definition (a dict),
    settings (the columns that say what was run) and units (of each column). Added to the columns of the file are
    `variant`, what distinguishes what was run, `peer`, and later_ns and later_pairs, of all frames but the first.

    ValueError: no record, or one that is broken; the line names the file.
    """
    with _drawing():
        from bvlab_plots import records
        return records.read(os.fspath(path))


def figures(path: str | os.PathLike, **figure: str | list[str]) -> dict[str, matplotlib.figure.Figure]:
    """The figures of a record, drawn as plots/draw draws them: {name: matplotlib.figure.Figure}.

    path      folder of the record
    figure    one figure instead of those that its definition declares: x="degrees", y="time_ns / pairs",
              series="strategy", panels=..., over="strategy=recursive", kind="line" | "bars" | "map" ..., where=["query=touching"]; the keys
              of a [[figure]] table but "table", see experiments/definitions/README.md

    ValueError: no such column, an answer that differs from the reference ...
    """
    folder = os.fspath(path)
    with _drawing():
        from bvlab_plots import draw, kinds
        if unknown := set(figure) - set(draw.OPTIONS):
            raise ValueError(f"{min(unknown)}: unknown; available: {', '.join(sorted(draw.OPTIONS))}")
        options = [f"--{key.replace('_', '-')}={value}" for key, value in figure.items() if key != "where"]
        where = figure.get("where", [])
        options += [f"--where={each}" for each in ([where] if isinstance(where, str) else where)]
        rows, wanted, faults = draw.figures_of(draw.arguments_of([*options, "--", folder]))
        if faults:
            raise ValueError(f"{folder}: {faults[0]}")
        return {each.name: kinds.drawing_of(each, kinds.points_of(rows.of(each), each))
                for each in wanted if each.kind != "table"}


@contextlib.contextmanager
def _drawing():
    """Imports and uses bvlab_plots with its own matplotlib settings; what it refuses becomes a ValueError."""
    import matplotlib
    settings = dict(matplotlib.rcParams)
    with matplotlib.rc_context(_looks):
        from bvlab_plots import style  # noqa: F401  sets them
        from bvlab_plots.refused import Refused
        if not _looks:
            _looks.update({key: value for key, value in matplotlib.rcParams.items()
                           if settings.get(key) != value and key != "backend"})
        try:
            yield
        except Refused as fault:
            raise ValueError(str(fault)) from None
