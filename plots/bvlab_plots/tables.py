# SPDX-License-Identifier: BSD-3-Clause
"""A figure's numbers as a table: a line for each x, a column for each series; as text, LaTeX and CSV."""

import re
import warnings

import pandas as pd

from bvlab_plots import captions
from bvlab_plots.charts import labelled_unit
from bvlab_plots.words import called


def label_of(figure, points):
    given = figure.value_label or figure.y_label
    label, factor = labelled_unit(points.attrs["value"], given, points.middle, None if figure.kind == "map" else figure)
    return label.replace("\n", " "), factor


def frame_of(figure, points):
    """A line for each point: panels, x (and y), series, low, middle, high, how many values it is made of."""
    _, factor = label_of(figure, points)
    columns = {figure.panel_rows or "panel_row": points.panel_row, figure.panels or "panel": points.panel,
               **({figure.y: points.y} if figure.kind == "map" else {}), figure.x: points.x,
               figure.series or "series": points.series, "low": points.low * factor, "middle": points.middle * factor,
               "high": points.high * factor, "values": points["count"]}
    frame = pd.DataFrame(columns)
    return frame[[c for c in frame if frame[c].dtype != object or (frame[c] != "").any()]]


def wide(figure, points, cells):
    """[(panel, table)]: lines are x, columns series."""
    columns = {"panel": [", ".join(filter(None, each)) for each in zip(points.panel_row, points.panel)],
               **({figure.y: points.y} if figure.kind == "map" else {}), figure.x: points.x,
               "series": points.series.where(points.series != "", "median"), "value": cells}
    frame = pd.DataFrame(columns)
    index = [column for column in columns if column not in ("series", "value", "panel")]
    return [(panel, part.pivot_table(index=index, columns="series", values="value", sort=False, aggfunc="first"))
            for panel, part in frame.groupby("panel", sort=False)]


def of(figure, points):
    label, factor = label_of(figure, points)
    lines = [f"{figure.name}: {label}"]
    for panel, table in wide(figure, points, points.middle * factor):
        lines += ([panel] if panel else []) + [table.to_string(float_format="{:.4g}".format, na_rep="")]
    return "\n".join(lines) + "\n"


def shortest(value):
    return "" if pd.isna(value) else f"{value:.3g}"


def to_csv(figure, points):
    label, _ = label_of(figure, points)
    return frame_of(figure, points).rename(columns={"middle": label}).to_csv(index=False)


def to_latex(figure, points):
    """A tabular for booktabs: a value with its interval in each cell; a comment says what it is made of."""
    label, factor = label_of(figure, points)
    cells = [shortest(m * factor) + (f" [{shortest(lo * factor)}, {shortest(hi * factor)}]" if lo != hi else "")
             for lo, m, hi in zip(points.low, points.middle, points.high)]
    headers = [header(figure.y, points.attrs["y"], figure.y_label, points)] if figure.kind == "map" else []
    headers.append(header(figure.x, points.attrs["x"], figure.x_label, points))
    lines = ["% " + escaped(label), "% " + escaped(captions.note_of(figure, points))]
    for panel, table in wide(figure, points, cells):
        table.columns.name = None
        table = table.reset_index()
        table[figure.x] = [value if isinstance(value, str) else shortest(value) for value in table[figure.x]]
        table.columns = [*headers, *table.columns[len(headers):]]
        with warnings.catch_warnings():  # pandas 1.5 announces that 2.0 will need Jinja for this
            warnings.simplefilter("ignore", FutureWarning)
            text = table.rename(columns=str).to_latex(index=False, na_rep="", escape=True)
        lines += ([f"% {escaped(panel)}"] if panel else []) + [text.rstrip()]
    return mathematics("\n".join(lines)) + "\n"


def header(columns, expression, given, points):
    """What an axis is called at the head of its column, with its unit."""
    kind = points.attrs["value"].kind
    if given or not expression:
        return given or ", ".join(called(column.strip(), kind) for column in columns.split(","))
    return expression.titled()


def escaped(text):
    return re.sub(r"\s+", " ", text)


def mathematics(text):
    """Signs that a LaTeX of 8 bits does not know."""
    for sign, command in {"×": r"$\times$", "°": r"$^\circ$", "µ": r"$\mu$", "−": "$-$", "·": r"$\cdot$"}.items():
        text = text.replace(sign, command)
    return text
