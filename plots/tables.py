# SPDX-License-Identifier: BSD-3-Clause
"""The medians of a figure as a table: a line for each x, a column for each series."""

import pandas as pd

from charts import labelled_unit


def of(figure, points):
    attrs = points.attrs
    label, factor = labelled_unit(attrs["value"], figure.value_label or figure.y_label, points.middle,
                                  "" if figure.kind == "map" else figure.over)
    columns = {"panel": points.panel, **({figure.y: points.y} if figure.kind == "map" else {}), figure.x: points.x,
               "series": points.series.where(points.series != "", "median"), "value": points.middle * factor}
    frame = pd.DataFrame(columns)
    index = [column for column in columns if column not in ("series", "value", "panel")]
    lines = [f"{figure.name}: {label}".replace("\n", " ")]
    for panel, part in frame.groupby("panel", sort=False):
        table = part.pivot_table(index=index, columns="series", values="value", sort=False)
        lines += ([panel] if panel else []) + [table.to_string(float_format="{:.4g}".format, na_rep="")]
    return "\n".join(lines) + "\n"
