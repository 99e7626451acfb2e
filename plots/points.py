# SPDX-License-Identifier: BSD-3-Clause
"""The points of a figure: rows selected, set in relation to a variant in the same cell, medians and quartiles."""

import numpy as np
import pandas as pd

import records
from expression import Expression
from figures import default_value
from ratios import cell_columns, ratios
from refused import Refused
from selection import columns_of, conditions_of, in_each_panel, right_only, selected, without_blanks
from words import value_text


def joined(rows, columns, blank=""):
    """The text of several columns in each row: "dense, 5 degrees"."""
    texts = [rows[column].map(lambda value, c=column: value_text(c, value)) for column in columns]
    return [", ".join(filter(None, parts)) or blank for parts in zip(*texts)] if texts else [blank] * len(rows)


def series_keys(rows, columns):
    """What the look of each row depends on: the strategy or the peer first, then the volume; or the columns."""
    if columns == ["variant"] and {"volume", "strategy"} <= set(rows):
        ours = rows[rows.peer == ""]
        first, second = ("strategy", "volume") if ours.strategy.nunique() > 1 or ours.volume.nunique() == 1 else (
            "volume", "strategy")
        several = ours[second].nunique() > 1
        keys = list(zip(rows[first].where(rows.peer == "", rows.peer), rows[second] if several else [""] * len(rows)))
        # Variants of the same volume and strategy differ in something else, and are known by their names alone.
        if len(set(keys)) == rows.variant.nunique():
            return keys
    texts = list(zip(*[rows[c].map(lambda value, c=c: value_text(c, value)) for c in columns])) or [("",)] * len(rows)
    return [(first, ", ".join(filter(None, rest))) for first, *rest in texts]


def axis_of(rows, text, what):
    """The place of each row on an axis: numbers or names; the expression, of numbers; whether it was measured."""
    names = [name.strip() for name in text.split(",")]
    if len(names) > 1 or names[0] in rows and rows[names[0]].dtype == object:
        return joined(rows, columns_of(rows, text, what)), None, False
    expression = Expression(text, rows)
    return expression.of(rows), expression, any(c not in rows.attrs["settings"] for c in expression.columns)


def measured(rows, text, figure):
    """The rows in which an expression has a value, as column `value`; and the expression."""
    expression = Expression(text, rows)
    values = expression.of(rows)
    if values.dtype == object:
        raise Refused(f"'{text}' holds names, not numbers")
    values = values.astype(float).replace([np.inf, -np.inf], np.nan)
    if values.isna().all():
        raise Refused(f"'{text}' is known for no row")
    records.say_left_out(rows[values.isna()].variant, f"which have no {text}, of {figure.name}")
    return rows.assign(value=values)[values.notna()], expression


def points_of(rows, figure):
    """A frame of points: panel, series, key (of its look), x (and y, of a map), low, middle and high (quartiles) of
    the value, ratio (its median over the base's). attrs: the expressions value, x, y (of names: nothing), and
    measured, whether x is."""
    attrs = rows.attrs
    text = (figure.value if figure.kind == "map" else figure.y) or default_value(rows)
    sooner, later = conditions_of(figure)
    rows = right_only(selected(rows, sooner), figure)
    rows.attrs.update(attrs)
    rows, value = measured(rows, text, figure)
    rows["ratio"] = 1.0
    if figure.over:
        rows.attrs.update(attrs)
        rows = ratios(rows, figure.over, keep_value=figure.kind == "map")
    rows.attrs.update(attrs)
    rows = in_each_panel(selected(rows, later), columns_of(rows, figure.panels, "panels"))
    rows = without_blanks(rows, figure)
    rows.attrs.update(attrs)
    x, across, is_measured = axis_of(rows, figure.x, "x")
    panels, series = columns_of(rows, figure.panels, "panels"), columns_of(rows, figure.series, "series")
    drawn = pd.DataFrame(dict(panel=joined(rows, panels), series=joined(rows, series), key=series_keys(rows, series),
                              x=x), index=rows.index)
    down = None
    if figure.kind == "map":
        drawn["y"], down, _ = axis_of(rows, figure.y, "y")
    # A measured x has a point for each cell; else what is not shown goes into medians and quartiles.
    apart = ["panel", "series", "key"] + [c for c in ("x", "y") if c in drawn and not (c == "x" and is_measured)]
    cells = [drawn[c] for c in apart] + ([rows[c] for c in cell_columns(rows, set())] if is_measured else [])
    drawn = drawn.assign(value=rows.value, ratio=rows.ratio, wrong=rows.wrong)
    grouped = drawn.groupby([cell.to_numpy() for cell in cells], sort=False, dropna=False)
    quartiles = grouped.value.quantile([0.25, 0.5, 0.75]).unstack().set_axis(["low", "middle", "high"], axis=1)
    first = grouped[[*apart]].first() if not is_measured else grouped[apart].first().join(grouped.x.median())
    points = first.join(quartiles).join(grouped.ratio.median()).join(grouped.wrong.any()).reset_index(drop=True)
    points.attrs.update(value=value, x=across, y=down, measured=is_measured)
    return points
