# SPDX-License-Identifier: BSD-3-Clause
"""What to draw: the [[figure]] tables of a definition, and figures of each axis where there are none.

    [[figure]]
    name = "mine"                  # <record>/figures/mine.png and .pdf
    kind = "line"                  # or "bars", or "map": over x and y, what is least, or how much it is
    x = "degrees"                  # a column, several ("density, motion"), or an expression of columns
    y = "time_ns / pairs"          # an expression of columns; of a map, its other axis
    value = "time_ns / pairs"      # of a map
    over = "strategy=recursive"    # a ratio to this variant in the same cell, to "best peer", "best of ours" or "best"
    series = "strategy"            # a column or several
    panels = "volume"              # a column or several
    where = ["query=touching", "side!=8", "nodes>=16"]   # the rows that are drawn; `over` looks among all of
                                   # them that satisfy the conditions on other columns than its own
    log = "xy"                     # axes that are logarithmic, "none", or as the data asks for
    peers = "all"                  # those whose answers differ, too, with a mark; else left out where they do
    x_label = "..."                # where the words for columns do not do, y_label and value_label, too
"""

from dataclasses import dataclass, field

from refused import Refused

KINDS = ["line", "bars", "map"]
LOGS = ["none", "x", "y", "xy"]
DEFAULT_VALUES = ["time_ns / pairs", "time_ns / answers", "frame_ns", "ns_per_call", "ns_per_frame", "time_ns",
                  "pose_ns", "false_positives + false_negatives", "n_v / pairs"]
MOST_SERIES, MOST_PANELS = 10, 6  # of a figure that nobody declared


@dataclass
class Figure:
    name: str
    x: str
    kind: str = ""
    y: str = ""
    value: str = ""
    over: str = ""
    series: str = ""
    panels: str = ""
    where: list = field(default_factory=list)
    log: str = ""
    peers: str = ""
    x_label: str = ""
    y_label: str = ""
    value_label: str = ""


def figure_from(table):
    """One [[figure]] table, or what the command line says. `bvlab run` refuses the same."""
    unknown = set(table) - set(Figure.__dataclass_fields__)
    if unknown:
        raise Refused(f"figure: unknown key '{min(unknown)}'; there are {', '.join(Figure.__dataclass_fields__)}")
    for key, value in table.items():
        strings = value if key == "where" and isinstance(value, list) else [value]
        if (key == "where") != isinstance(value, list) or not all(isinstance(each, str) for each in strings):
            raise Refused(f"figure: {key} must be {'a list of strings' if key == 'where' else 'a string'}")
    for key in ("name", "x"):
        if not table.get(key):
            raise Refused(f"figure {table.get('name', '')}: needs {'a' if key == 'name' else 'an'} {key}")
    figure = Figure(**table)
    if "/" in figure.name:
        raise Refused(f"figure {figure.name}: a name without '/'")
    for key, allowed in (("kind", KINDS), ("log", LOGS), ("peers", ["all"])):
        if getattr(figure, key) and getattr(figure, key) not in allowed:
            raise Refused(f"figure {figure.name}: unknown {key} '{getattr(figure, key)}'; there are "
                          + ", ".join(allowed))
    if figure.kind == "map" and not figure.y:
        raise Refused(f"figure {figure.name}: a map needs a y")
    return figure


def declared(definition):
    figures = [figure_from(table) for table in definition.get("figure", [])]
    names = [figure.name for figure in figures]
    for name in names:
        if names.count(name) > 1:
            raise Refused(f"a second figure '{name}'")
    return figures


def default_value(rows):
    """What is measured first of all: a time, if there is one."""
    for text in DEFAULT_VALUES:
        if all(word in "/+" or word in rows and rows[word].notna().any() for word in text.split()):
            return text
    settings, units = rows.attrs["settings"], rows.attrs["units"]
    measured = [c for c in rows if c not in settings and c in units and rows[c].dtype != object]
    if not measured:
        raise Refused("holds nothing that is measured")
    return "mean" if "mean" in measured else measured[0]


def axes_of(rows):
    """The columns that were varied, each once: of those that vary together the first."""
    axes, seen = [], {}
    for column in rows.attrs["settings"]:
        codes = tuple(rows[column].astype(str).factorize()[0])
        if rows[column].nunique() > 1 and codes not in seen:
            seen[codes] = column
            axes.append(column)
    return [axis for axis in axes if axis not in ("peer", "variant", "repetition", "seed")] or axes


def series_for(rows, x):
    """What distinguishes lines: the variants, or, where they are many, the part of them that is not x."""
    parts = {"strategy", "volume", "method", "test", "policy"}
    for column in ([] if x in parts else ["variant"]) + ["strategy", "volume", "method", "test", "policy"]:
        if column in rows and column != x and 1 < rows[column].nunique() <= MOST_SERIES:
            return column
    return "variant" if rows.variant.nunique() > 1 and x != "variant" else ""


def of_each_axis(rows):
    """A figure for each axis: the default value against it, by variant; panels are what matters next."""
    axes, value, figures = axes_of(rows), default_value(rows), []
    for x in axes or ["variant"]:
        series = series_for(rows, x)
        parts = {"variant": {"variant", "volume", "strategy", "method"}}.get(series, {series})
        panels = [c for c in axes if c not in parts | {x} and 1 < rows[c].nunique() <= MOST_PANELS]
        panel = min(panels, key=lambda c: (c != "query", rows[c].nunique()), default="")
        figures.append(Figure(name=f"by-{x}".replace("_", "-"), x=x, y=value, series=series, panels=panel))
    return figures
