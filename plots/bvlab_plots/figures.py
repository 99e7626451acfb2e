# SPDX-License-Identifier: BSD-3-Clause
"""What to draw: the [[figure]] tables of a definition, and figures of each axis where there are none.

experiments/definitions/README.md says what every key means, with an example of each kind.
"""

from dataclasses import field, make_dataclass

from bvlab_plots.refused import Refused

KINDS = ["line", "bars", "map", "scatter", "stacked", "ecdf", "box", "table"]
# Keys that take one of a few words.
CHOICES = {
    "kind": KINDS,
    "log": ["none", "x", "y", "xy"],
    "peers": ["all"],
    "ratio": ["cost", "speedup"],
    "statistic": ["median", "mean", "p99", "worst", "least"],
    "interval": ["quartiles", "range", "95%", "none"],
    "fit": ["line", "power"],
    "clock": ["processor", "wall"],
    "table": ["frames"],
    "width": ["column", "page"],
    "caption": ["below", "beside"],
}
DEFAULT_VALUES = ["time_ns / pairs", "time_ns / answers", "frame_ns", "ns_per_call", "time_ns",
                  "false_positives + false_negatives", "n_v / pairs"]
MOST_SERIES, MOST_PANELS = 10, 6  # of a figure that nobody declared


# Each key once, and what it says.
KEYS = {"name": "of the files", "x": "a column, several, or an expression of columns", "kind": ", ".join(KINDS),
        "y": "an expression of columns, or several", "value": "of a map",
        "over": "a ratio to this variant in the same cell: name=value, 'best peer', 'best', or record=DIR",
        "ratio": "to what it is over: cost, or speedup", "series": "what lines or bars are told apart by",
        "panels": "what has a panel each", "panel_rows": "what has a row of panels each", "where": "rows that are drawn",
        "pool": "columns that go into the interval", "statistic": ", ".join(CHOICES["statistic"]),
        "interval": ", ".join(CHOICES["interval"]), "fit": "of a scatter: line or power", "clock": "processor or wall",
        "table": "frames: rows of single frames", "log": "axes that are logarithmic: none, x, y or xy",
        "peers": "all: those whose answers differ, too", "width": "column or page of a paper",
        "caption": "below the figure, or beside it, as NAME.txt", "x_label": "in place of words for columns",
        "y_label": "as well", "value_label": "as well"}
Figure = make_dataclass("Figure", ["name", "x", *(
    (key, list, field(default_factory=list)) if key == "where" else (key, str, "") for key in list(KEYS)[2:])])


def figure_from(table):
    """One [[figure]] table, or what the command line says. A Refused has the key that is at fault, if it is one."""
    named = f"figure {table.get('name', '')}: "
    for key, value in table.items():
        if key not in KEYS:
            raise Refused(f"{named}unknown key '{key}'; available: {', '.join(KEYS)}", key)
        strings = value if key == "where" and isinstance(value, list) else [value]
        if (key == "where") != isinstance(value, list) or not all(isinstance(each, str) for each in strings):
            raise Refused(f"{named}{key} must be {'a list of strings' if key == 'where' else 'a string'}", key)
        if value and value not in CHOICES.get(key, [value]):
            raise Refused(f"{named}unknown {key} '{value}'; available: {', '.join(CHOICES[key])}", key)
    for key in ("name", "x"):
        if not table.get(key):
            raise Refused(f"{named}needs {'a' if key == 'name' else 'an'} {key}")
    figure = Figure(**table)
    if "/" in figure.name:
        raise Refused(f"{named}a name without '/'", "name")
    if figure.kind in ("map", "scatter") and not figure.y:
        raise Refused(f"{named}a {figure.kind} needs a y")
    if figure.fit and figure.kind != "scatter":
        raise Refused(f"{named}a fit is drawn through a scatter", "fit")
    if figure.ratio and not figure.over:
        raise Refused(f"{named}a ratio needs what it is over")
    return figure


def each_declared(definition):
    """Of each [[figure]] of a definition, in their order: the figure, or why it is none."""
    names = set()
    for table in definition.get("figure", []):
        try:
            figure = figure_from(table)
            if figure.name in names:
                raise Refused(f"a second figure '{figure.name}'")
            names.add(figure.name)
            yield figure
        except Refused as fault:
            yield fault


def declared(definition):
    """The figures of a definition, and why others are none: a fault of one is none of the others'."""
    found = list(each_declared(definition))
    return ([each for each in found if isinstance(each, Figure)],
            [str(each) for each in found if isinstance(each, Refused)])


def default_value(rows):
    """What is measured first of all: a time, if there is one. Rows that say where they were measured may have none."""
    def there(column):
        return column in rows and ("alone" not in rows or rows[column].notna().any())

    for text in DEFAULT_VALUES:
        if all(word in "/+" or there(word) for word in text.split()):
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
    """A figure for each axis: the default value against it, by variant; panels are what matters next. What else was
    varied goes into quartiles, and is named in the figure."""
    axes, value, figures = axes_of(rows), default_value(rows), []
    for x in axes or ["variant"]:
        series = series_for(rows, x)
        parts = {"variant": {"variant", "volume", "strategy", "method"}}.get(series, {series})
        panels = [c for c in axes if c not in parts | {x} and 1 < rows[c].nunique() <= MOST_PANELS]
        panel = min(panels, key=lambda c: (c != "query", rows[c].nunique()), default="")
        figures.append(Figure(name=f"by-{x}".replace("_", "-"), x=x, y=value, series=series, panels=panel,
                              pool=", ".join(rows.attrs["settings"])))
    return figures
