# SPDX-License-Identifier: BSD-3-Clause
"""The rows that a figure shows: those that satisfy its conditions and whose answers are right."""

import re

import numpy as np
import pandas as pd

from bvlab_plots import records
from bvlab_plots.expression import Expression
from bvlab_plots.refused import Refused
from bvlab_plots.words import LENGTHS

VARIANT = ["volume", "tree", "fan_out", "frame", "kernel", "strategy", "configuration", "method", "test", "source", "peer", "variant"]  # what a variant may be
CONFIGURED = {"volume", "tree", "fan_out", "frame", "kernel", "strategy", "build", "fit", "leaf_size"}  # what a configuration sets
BEST = {"best peer": lambda rows: (rows.peer != "") & ~rows.wrong, "best of ours": lambda rows: rows.peer == "",
        "best": lambda rows: ~rows.wrong}
# name=value or name!=value; with another comparison in it, it is an expression.
CONDITION = re.compile(r"^\s*(\w+)\s*(!?=)(?!=)((?:(?!==|!=|[<>]).)*)$", re.DOTALL)


def columns_of(rows, text, what):
    """The columns that "density, motion" names."""
    names = [name.strip() for name in text.split(",")] if text else []
    for name in names:
        if name not in rows:
            raise Refused(f"{what}: no column '{name}'; available: {', '.join(rows.attrs['units'])}")
    return names


def has_value(rows, column, text, what):
    """Which rows have the value in the column; refused where none has."""
    values = rows[column]
    if values.dtype == object:
        found = values == text.strip()
    else:
        try:
            found = np.isclose(values, number_of(text, rows.attrs.get("units", {}).get(column)), rtol=1e-12, atol=0)
        except ValueError:
            found = pd.Series(False, rows.index)
    if not np.any(found):
        there = dict.fromkeys(value if isinstance(value, str) else f"{value:g}" for value in values)
        raise Refused(f"{what}: {column} has no '{text.strip()}'; available: {', '.join(map(repr, there))}")
    return pd.Series(found, rows.index)


def number_of(text, unit):
    """Of a length with the unit of its column, too: "0.03body"."""
    suffix = next((suffix for suffix, name in LENGTHS.items() if name == unit), "")
    return float(text.strip().removesuffix(suffix))


def selected(rows, conditions):
    """The rows that satisfy each: name=value, name!=value, or a condition that pandas evaluates."""
    for text in conditions:
        match = CONDITION.match(text)
        if match and match[1] in rows:
            found = has_value(rows, match[1], match[3], f"where {text}")
            kept = found if match[2] == "=" else ~found
        else:
            kept = Expression(text, rows).of(rows)
            if kept.dtype != bool:
                raise Refused(f"where {text}: no condition: name=value, name!=value, or expressions compared by "
                              "< <= > >= == != and joined by and, or, not")
        # What an earlier condition has left, and not all there was.
        rows = rows[kept]
        if rows.empty:
            raise Refused(f"where {text}: no row is left")
    return rows


def axes_of_definition(rows):
    """Each axis of the record's definition: its label, and the columns that it sets with the label."""
    for axis in rows.attrs["definition"].get("axis", []):
        yield axis["name"], {axis["name"]} | {key for value in axis.get("value", []) for key in value if key != "name"}


def tied(rows, names):
    """The columns named, the labels of axes that set them, and what those axes set beside them."""
    found = set(names)
    for _, sets in axes_of_definition(rows):
        if sets & found:
            found |= sets
    return found | CONFIGURED if "configuration" in found else found


def conditions_of(rows, figure):
    """The conditions on rows that `over` looks among, and those on the columns that it names itself, as axes that set a
    variant are."""
    names = re.findall(r"(\w+)\s*=", figure.over)
    if figure.over in BEST:
        names = VARIANT + [label for label, sets in axes_of_definition(rows) if sets & set(VARIANT)]
    later = [text for text in figure.where if (match := CONDITION.match(text)) and match[1] in names]
    return [text for text in figure.where if text not in later], later


def right_only(rows, figure):
    """No answer of ours is wrong; peers are left out where theirs are, or bear a mark if the figure shows all."""
    wrong = records.wrong_answers(rows)
    rows = rows.assign(wrong=wrong)
    if figure.peers != "all":
        records.say_left_out(rows[wrong].variant, f"where their answers differ, of {figure.name}")
        rows = rows[~wrong]
    return rows


def without_blanks(rows, figure):
    """What has no name on an axis of names, as a peer has no volume, has no place there."""
    axes = [figure.x, figure.y] if figure.kind == "map" else [figure.x]
    blank = rows[[text for text in axes if text in rows]].eq("").any(axis=1)
    if blank.all():
        raise Refused(f"{figure.x} has no names")
    records.say_left_out(rows[blank].variant, f"which have no {figure.x}, of {figure.name}")
    return rows[~blank]


def in_each_panel(rows, panels):
    """What has no value of a panel's column, as a peer has no volume, is in every panel."""
    for column in panels:
        blank = rows[column].isin([""]) if rows[column].dtype == object else rows[column].isna()
        others = rows[~blank][column].drop_duplicates()
        if blank.any() and len(others):
            copies = rows[blank].drop(columns=column).merge(others, how="cross")
            rows = pd.concat([rows[~blank], copies[rows.columns]], ignore_index=True)
    return rows
