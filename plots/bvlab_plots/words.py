# SPDX-License-Identifier: BSD-3-Clause
"""What columns of records are called on axes and in legends, and what they are measured in."""

import math

# Column: what it is called. What is not here is called as its column is, without the unit.
CALLED = {
    "time_ns": "time", "first_ns": "time of the first frame", "later_ns": "time",
    "build_ns": "time to build", "frame_ns": "time per frame", "ns_per_frame": "time per frame",
    "ns_per_call": "time per call",
    "fan_out": "children per node", "wall_ns": "wall time per frame", "middle_ns": "median time of a frame",
    "survival": "share of the front that survives a frame", "p99_ns": "99th percentile of a frame's time",
    "worst_ns": "worst frame's time",
    "n_u": "volumes posed", "n_v": "volume tests", "n_p": "triangle tests", "front": "entries of the front",
    "objects": "bodies", "degrees": "rotation per frame", "step": "translation per frame", "side": "side of the cube",
    "displacement": "displacement per frame, of a box's size", "offset": "distance from the origin",
    "events": "pairs that began or ended per frame", "overlaps": "overlapping pairs", "bytes": "memory held",
    "relative_error": "relative error allowed", "largest_error": "largest error seen", "mean_error": "mean error seen",
    "level": "level (the root is 0)", "leaf_size": "triangles of a leaf",
    "best_tests": "those of a list with the best rebuilds", "count": "boxes asked for",
    "moving": "bodies that move (0: all)",
}
# The same in studies of one kind, where a column means something else.
CALLED_IN = {
    "worlds": {"moving": "share of the bodies that move", "time_ns": "time of all frames but the first"},
    "tightness": {"mean": "distance left out, over the node's diameter"},
}
# Of which one is counted: "time / pairs" is time per pair.
ONE_OF = {"pairs": "pair", "later_pairs": "pair after the first frame", "frames": "frame", "answers": "answer",
          "objects": "body", "boxes": "box", "overlaps": "overlapping pair", "n_v": "volume test",
          "n_p": "triangle test"}
UNITS = {"ns": "ns", "us": "us", "ms": "ms", "seconds": "s", "bytes": "B"}  # by the end of a column's name
UNIT_OF = {"degrees": "°", "bytes": "B", "ns_per_frame": "ns", "ns_per_call": "ns"}
LENGTHS = {"body": "radii", "leaf": "leaf sizes"}  # what is written behind a length of a definition
VALUES = {"polygons": "{} polygons", "objects": "{} bodies", "count": "{} boxes", "boxes": "{} boxes",
          "degrees": "{}°", "step": "{} radii", "threads": "{} threads", "leaf_size": "leaves of {}",
          "fan_out": "{} children"}
SWITCHES = {("coherent", "on"): "coherent", ("coherent", "off"): "from scratch", ("changes", "on"): "changes reported",
            ("changes", "off"): "changes not reported"}


def unit_of(column):
    """What a column is measured in, from the end of its name; nothing for numbers and names."""
    return UNIT_OF.get(column) or UNITS.get(column.rpartition("_")[2] if "_" in column else "", "")


def is_time(column):
    return unit_of(column) in ("ns", "us", "ms", "s")


def called(column, kind=""):
    known = CALLED_IN.get(kind, {}).get(column) or CALLED.get(column)
    if known:
        return known
    head, _, tail = column.rpartition("_")
    return (head if head and tail in UNITS else column).replace("_", " ")


def number(value):
    """A number as it is read: 0.003, 5, 8000, 10^6."""
    value = float(value)
    if not math.isfinite(value):
        return "none" if math.isnan(value) else str(value)
    if value == int(value) and 1e4 <= abs(value) < 1e6 and value % 1000 == 0:
        return f"{value:,.0f}".replace(",", "\u2009")
    if value == 0 or 1e-4 <= abs(value) < 1e4:
        return f"{value:.4g}"
    power = math.floor(math.log10(abs(value)) + 1e-9)
    factor = value / 10**power
    return (f"{factor:.3g}·" if abs(factor - 1) > 1e-9 else "") + f"$10^{{{power}}}$"


def texts(values):
    """Values as they stand at an axis: names, and numbers."""
    return [value if isinstance(value, str) else number(value) for value in values]


def span(least, most):
    """"2 to 8"; "2" where both ends are written alike."""
    return least if least == most else f"{least} to {most}"


def plain(name):
    """A name as it is, in a legend and without formulas; of a file of poses or boxes, that of the file."""
    if name.endswith(".npy"):
        name = name.rpartition("/")[2].removesuffix(".npy")
    return (" " if name.startswith("_") else "") + name.replace("$", "\\$").replace("\r", " ")


def value_text(column, value):
    """A value of a column where the column is not named beside it."""
    if isinstance(value, str):
        return SWITCHES.get((column, value), f"{column} {value}" if value in ("on", "off") else plain(value))
    return VALUES.get(column, column.replace("_", " ") + " {}").format(number(value))


def scaled(unit, values):
    """A unit in which the values are easy to read, and what to multiply them with."""
    times = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1}
    ladders = {**{name: [(1, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns")] for name in times},
               "B": [(1e9, "GB"), (1e6, "MB"), (1e3, "kB"), (1, "B")]}
    values = sorted(abs(value) for value in values if value and math.isfinite(value))
    if unit not in ladders or not values:
        return unit, 1
    base = times.get(unit, 1)
    middle = values[len(values) // 2] * base
    step, name = next(((step, name) for step, name in ladders[unit] if middle >= step), ladders[unit][-1])
    return name, base / step
