# SPDX-License-Identifier: BSD-3-Clause
"""The points of a figure: rows selected, set in relation to a variant in the same cell, a statistic and its interval."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from bvlab_plots import records
from bvlab_plots.expression import Expression
from bvlab_plots.figures import default_value
from bvlab_plots.intervals import chosen, summary
from bvlab_plots.ratios import cell_columns, ratios, ratios_to
from bvlab_plots.refused import Refused
from bvlab_plots.selection import columns_of, conditions_of, in_each_panel, right_only, selected, without_blanks
from bvlab_plots.words import is_time, value_text

RECORD = re.compile(r"^record\s*=\s*(.+)$")


def texts_of(rows, columns):
    """The texts of several columns in each row."""
    return list(zip(*(rows[c].map(lambda value, c=c: value_text(c, value)) for c in columns))) or [("",)] * len(rows)


def joined(rows, columns):
    """As one text: "dense, 5 degrees"."""
    return [", ".join(filter(None, texts)) for texts in texts_of(rows, columns)]


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
    return [(first, ", ".join(filter(None, rest))) for first, *rest in texts_of(rows, columns)]


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
        times = [column for column in expression.columns if is_time(column) and rows[column].isna().all()]
        raise Refused(f"'{text}' is known for no row" + (f": {times[0]} was not measured" if times else ""))
    records.say_left_out(rows[values.isna()].variant, f"which have no {text}, of {figure.name}")
    return rows.assign(value=values)[values.notna()], expression


def other_record(path, text, figure, sooner):
    """The rows of another record that a figure is set in relation to, with their value."""
    others = records.read(Path(path), figure.table, clock=figure.clock or "processor")
    attrs = others.attrs
    others = right_only(selected(others, sooner), figure)
    others.attrs.update(attrs)
    others, _ = measured(others, text, figure)
    others.attrs.update(attrs)
    return others


def rows_of(rows, figure, text):
    """The rows that a figure shows, with `value`, over what the figure says; and the value's expression."""
    attrs = rows.attrs
    sooner, later = conditions_of(rows, figure)
    if RECORD.match(figure.over):
        sooner, later = figure.where, []
    rows = right_only(selected(rows, sooner), figure)
    rows.attrs.update(attrs)
    rows, value = measured(rows, text, figure)
    rows["ratio"] = 1.0
    if figure.over:
        rows.attrs.update(attrs)
        match = RECORD.match(figure.over)
        rows = ratios_to(rows, other_record(match[1], text, figure, sooner)) if match else ratios(rows, figure.over)
        if figure.ratio == "speedup":
            rows["ratio"] = 1 / rows.ratio
        if figure.kind != "map":
            rows["value"] = rows.ratio
    rows.attrs.update(attrs)
    panels = [column for text in (figure.panels, figure.panel_rows) for column in columns_of(rows, text, "panels")]
    rows = without_blanks(in_each_panel(selected(rows, later), panels), figure)
    rows.attrs.update(attrs)
    return rows, value


def places_of(rows, figure):
    """A frame beside the rows: panel, panel_row, series, key (of the look)."""
    panels, lines = (columns_of(rows, text, "panels") for text in (figure.panels, figure.panel_rows))
    series = columns_of(rows, figure.series, "series")
    return pd.DataFrame(dict(panel=joined(rows, panels), panel_row=joined(rows, lines), series=joined(rows, series),
                             key=series_keys(rows, series)), index=rows.index)


def pooled_in(rows, figure, apart):
    """What varies in a point and is neither named nor fixed, as {column: how many values}, or (least, most) of them
    where points differ; refused where `pool` does not name it. The columns of the frame `apart` distinguish points."""
    named = columns_of(rows, figure.pool, "pool")
    # What goes into an interval though `pool` does not name it; `frame` is also where volumes are compared.
    repeated = ["seed", "frame"] if figure.table == "frames" else ["seed"]
    settings = [c for c in rows.attrs["settings"] if c not in ("repetition", "node", *repeated)]
    keys = [apart[column].to_numpy() for column in apart]
    pooled = {}
    # Those that may vary first: what they determine, as a label does its parameters, varies with them.
    for column in [c for c in repeated if c in rows] + named + [c for c in settings if c not in named] + ["repetition"] * ("repetition" in rows):
        counts = rows.groupby(keys, sort=False, dropna=False)[column].nunique(dropna=False)
        least, most = int(counts.min()), int(counts.max())
        if most < 2 or column in pooled:
            continue
        if column not in named + repeated + ["repetition"]:
            raise Refused(f"axis '{column}' is neither named nor fixed: {most} of its values would be one point; say where = "
                          f"[\"{column}=...\"], or name it in x, series or panels, or say pool = \"{column}\"")
        pooled[column] = most if least == most else (least, most)
        if column != "repetition":
            keys.append(rows[column].to_numpy())
    return pooled


def points_of(rows, figure):
    """A frame of points: panel, panel_row, series, key (of its look), x (and y, of a map), low, middle and high of the
    value by the figure's statistic and interval, ratio (the median of the value's over the base's), count (of values).

    attrs: the expressions value, x, y (of names: nothing); measured, whether x is; pooled, what went into a point."""
    texts = [(figure.value if figure.kind == "map" else figure.y) or default_value(rows)]
    if figure.kind in ("", "line", "bars") and ";" in texts[0]:
        return points_in_panels(rows, figure, texts[0].split(";"))
    if figure.kind in ("", "line", "bars", "table", "scatter"):
        texts = [text.strip() for text in texts[0].split(",")]
    parts = [one_value(rows, figure, text) for text in texts]
    points, attrs = parts[0], dict(parts[0].attrs)
    if len(parts) > 1:
        labels = [part.attrs["value"].label() for part in parts]
        if len({part.attrs["value"].unit() for part in parts}) > 1 and not figure.over:
            raise Refused(f"y: {', '.join(labels)} are not measured in the same unit; "
                          "between semicolons each has a panel")
        points = pd.concat([with_what(part, label) for part, label in zip(parts, labels)], ignore_index=True)
    points.attrs.update(attrs, several=len(parts) > 1)
    return points


def points_in_panels(rows, figure, texts):
    """Of several quantities: each has a row of panels. Those that are timed say of all how."""
    if figure.panel_rows:
        raise Refused("panel_rows: y has several panels, which stand there", "panel_rows")
    parts = [points_of(rows, replace(figure, y=text.strip())) for text in texts]
    points = pd.concat([part.assign(panel_row=str(row)) for row, part in enumerate(parts)], ignore_index=True)
    said = next((part.attrs for part in parts if part.attrs["timed"]), parts[0].attrs)
    points.attrs.update(said, quantities=[part.attrs for part in parts])
    return points


def with_what(points, label):
    """Points whose series say what of several values they are."""
    keys = [(first, f"{second}, {label}" if second else label) if first else (label, "") for first, second in points.key]
    return points.assign(series=[f"{name}, {label}" if name else label for name in points.series], key=keys)


def one_value(rows, figure, text):
    rows, value = rows_of(rows, figure, text)
    x, across, is_measured = axis_of(rows, figure.x, "x")
    if figure.kind == "scatter" and across is None:
        raise Refused(f"'{figure.x}' holds names: a scatter needs numbers on both axes")
    is_measured = is_measured or figure.kind == "scatter"
    drawn = places_of(rows, figure).assign(x=x)
    down = None
    if figure.kind == "map":
        drawn["y"], down, _ = axis_of(rows, figure.y, "y")
    # A measured x has a point for each cell; else what is not shown goes into the interval, if it may.
    names = [c for c in drawn if not (c == "x" and is_measured)]
    cells = pd.DataFrame({c: rows[c] for c in cell_columns(rows, set())} if is_measured else {}, index=rows.index)
    apart = pd.concat([drawn[names], cells.add_prefix("cell ")], axis=1)
    pooled = pooled_in(rows, figure, apart)
    drawn = drawn.assign(value=rows.value, ratio=rows.ratio, wrong=rows.wrong)
    grouped = drawn.groupby([apart[column].to_numpy() for column in apart], sort=False, dropna=False)
    statistic, interval = chosen(figure)
    if (statistic, interval) == ("median", "quartiles"):
        middle = grouped.value.quantile([0.25, 0.5, 0.75]).unstack().set_axis(["low", "middle", "high"], axis=1)
    else:
        middle = grouped.value.apply(summary, statistic, interval).unstack()
    first = grouped[names].first() if not is_measured else grouped[names].first().join(grouped.x.median())
    points = first.join(middle).join(grouped.ratio.median()).join(grouped.wrong.any())
    points = points.join(grouped.value.size().rename("count")).reset_index(drop=True)
    points.attrs.update(value=value, x=across, y=down, measured=is_measured, pooled=pooled, **said_of(rows, value))
    return points


def said_of(rows, value):
    """What a figure has to say of the rows it is drawn of."""
    timed = any(is_time(column) for column in value.columns)
    beside = int((rows["alone"] == "no").sum()) if timed and "alone" in rows else 0
    if "wall_ns" in rows:  # beside it stand the processor's times, of single frames, too
        clock, of_frames = "wall" if "wall_ns" in value.columns else "processor", []
    else:
        by_processor = rows.attrs.get("clock_of_frames") == "processor"
        corrected = rows.attrs.get("clock") == "processor" and "wall_per_processor" in rows
        clock = "processor" if by_processor or corrected else "wall"
        of_frames = [] if by_processor else records.times_of_frames(" ".join(value.columns))
    plays = rows.attrs.get("definition", {}).get("parameters", {}).get("plays", 1)
    return dict(drawn=len(rows), timed=timed, beside=beside, of_frames=of_frames, clock=clock, plays=plays, unfinished=rows.attrs.get("unfinished"))
