# SPDX-License-Identifier: BSD-3-Clause
"""A record that is to be made: its figures are computed of what is known of it, so that hours of measuring are not lost.

`bvlab run` writes a folder with the definition and the tables: their columns and, of an experiment, a row for each cell,
in which nothing is measured. What will be measured is made up here, and points are computed as those of a record are. So
nothing is refused by other rules than it is drawn by.
"""

import ast
import contextlib
import dataclasses
import functools
import io
import re
import shutil

import numpy as np
import pandas as pd

from bvlab_plots import kinds, points, records, stacks
from bvlab_plots.expression import Expression
from bvlab_plots.refused import Refused
from bvlab_plots.selection import BEST, CONDITION, columns_of, selected

MADE = ["peer", "variant", "later_ns", "later_pairs", "survival"]  # columns that a record has when it is read
ELSEWHERE = ["program"]  # that experiments/builds adds
COLUMNS = ["series", "panels", "panel_rows", "pool"]  # keys that take names of columns


class RecordToCome:
    """Tables of which columns and cells are known, and a record made up of them."""

    def __init__(self, folder, scratch):
        self.folder, self.scratch = folder, scratch
        self.name = records.read_definition(folder)["name"]
        self.known = {}
        for table in ("", "frames"):
            path = self.path(folder, table)  # a study has no frames
            self.known[table] = pd.read_csv(path, keep_default_na=False, dtype=str) if path.is_file() else pd.DataFrame()

    def path(self, folder, table):
        return folder / ".".join(filter(None, [self.name, table, "csv"]))

    def check(self, figure):
        """Refused where the figure cannot be drawn."""
        known = self.known[figure.table]
        check_names(figure, list(known))
        if len(known):
            with contextlib.redirect_stdout(io.StringIO()):
                check_points(figure, self.rows)

    @functools.cached_property
    def rows(self):
        """Of one repetition, in which all answers are right."""
        shutil.copy(self.folder / "definition.toml", self.scratch)
        random = np.random.default_rng(1)
        for table, known in self.known.items():
            rows, columns = known.assign(**dict.fromkeys(ELSEWHERE, "this")), list(known)
            for column in columns[columns.index("frame" if table else "repetition") + 1:] if len(known) else []:
                rows[column] = 0 if column in records.WRONG else random.uniform(1, 2, len(rows))
            if "alone" in rows:
                rows["alone"] = "yes"
            if table:
                rows["frame"] = range(len(rows))
            rows[[*ELSEWHERE, *columns]].to_csv(self.path(self.scratch, table), index=False)
        return kinds.Rows(self.scratch)


def check_names(figure, columns):
    """Each column is there, each expression is one; of what a study will hold nothing else is known."""
    one = pd.DataFrame(1.0, [0], dict.fromkeys([*columns, *MADE, *ELSEWHERE]))
    one.attrs.update(units=dict.fromkeys(one, ""), kind="")
    for key in ("x", "y", "value"):
        for text in re.split("[,;]", getattr(figure, key)) if getattr(figure, key) else []:
            check_expression(text, key, one)
    for key in COLUMNS:
        columns_of(one, getattr(figure, key), key)
    over = [] if figure.over in BEST or figure.over.startswith("record") else filter(None, figure.over.split(","))
    for key, conditions in (("where", figure.where), ("over", over)):
        for text in conditions:
            if match := CONDITION.match(text):
                columns_of(one, match[1], key)
            else:
                check_expression(text, key, one)


def check_expression(text, key, one):
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise Refused(f"{key}: '{text.strip()}' is no expression of columns" if text.strip() else
                      f"{key}: an expression is missing") from None
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            columns_of(one, node.id, key)
    try:
        Expression(text.strip(), one)
    except Refused as fault:
        raise Refused(f"{key}: {fault}") from None


def check_points(figure, made_up):
    """Computes the figure's points."""
    rows = made_up.of(dataclasses.replace(figure, clock="wall"))
    known = [each for each in figure.where if is_known(rows, each)]
    figure = dataclasses.replace(figure, where=known, statistic="", interval="")  # the fastest ones
    if figure.over.startswith(("record", *ELSEWHERE)):
        figure = dataclasses.replace(figure, over="", ratio="")
    if figure.kind == "stacked":  # unit costs may be measured, or fitted to times
        found = points.one_value(rows, figure, stacks.time_of(rows, figure))
    else:
        found = kinds.points_of(rows, figure)
    for quantity in found.attrs.get("quantities", [found.attrs]):
        for axis in ("x", "y") if figure.over else ("x", "y", "value"):
            if expression := quantity.get(axis):
                expression.unit()  # there may be none


def is_known(rows, condition):
    """Whether a condition can be applied before anything is measured: it is on what was set, or leaves some rows."""
    match = CONDITION.match(condition)
    if match:
        return match[1] in {*rows.attrs["settings"], "peer", "variant"} - {*ELSEWHERE}
    try:
        return len(selected(rows, [condition])) > 0
    except Refused as fault:
        if "no row is left" in str(fault):
            return False
        raise
