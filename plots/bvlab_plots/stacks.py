# SPDX-License-Identifier: BSD-3-Clause
"""The terms N_u C_u, N_v C_v and N_p C_p on each other, beside the time that was measured."""

import numpy as np

from bvlab_plots import captions, charts, unit_costs
from bvlab_plots.figures import default_value
from bvlab_plots.points import one_value
from bvlab_plots.refused import Refused
from bvlab_plots.ticks import Scale
from bvlab_plots.words import texts

TERMS = {"posing_ns": ("posing $N_u C_u$", "#41a5c4", "..."), "volumes_ns": ("volumes $N_v C_v$", "#1b1b1b", ""),
         "triangles_ns": ("triangles $N_p C_p$", "#d95f0e", "///")}
MEASURED = "#b0413e"


def with_terms(rows):
    """The rows that count, with the terms in ns; and where unit costs are from."""
    missing = [column for column in (*unit_costs.COUNTS, "time_ns", "volume") if column not in rows]
    if missing:
        raise Refused(f"has no {', '.join(missing)}: there are no terms to stack")
    attrs = rows.attrs
    rows = rows[(rows.peer == "") & rows[unit_costs.COUNTS].notna().all(axis=1)].copy()
    if rows.empty or rows.time_ns.isna().all():
        raise Refused("no row has counts and a time")
    costs, source = unit_costs.of_record(attrs.get("folder"), rows)
    for i, (term, count) in enumerate(zip(TERMS, unit_costs.COUNTS)):
        rows[term] = rows[count] * rows.volume.map(lambda v, i=i: costs[v][i])
    rows.attrs.update(attrs, units={**attrs["units"], **dict.fromkeys(TERMS, "ns")})
    return rows, source


def time_of(rows, figure):
    """The expression of the time that terms are stacked beside; refused where a figure has another."""
    text = figure.y or default_value(rows)
    if "time_ns" not in text:
        raise Refused(f"figure {figure.name}: y of stacked terms is a time: time_ns, or time_ns / pairs")
    if figure.series or figure.over:
        raise Refused(f"figure {figure.name}: stacked terms have neither series nor over: name what differs in x")
    return text


def points_of(rows, figure):
    """As of bars, with a column for each term."""
    text = time_of(rows, figure)
    rows, source = with_terms(rows)
    points = one_value(rows, figure, text)
    for term in TERMS:
        of_term = one_value(rows, figure, text.replace("time_ns", term))
        points[term] = of_term.middle.to_numpy()
    points.attrs.update(several=False, source=source)
    return points


def draw(figure, points):
    """A matplotlib figure of kind stacked."""
    attrs = points.attrs
    label, factor = charts.labelled_unit(attrs["value"], figure.y_label, points.middle, figure)
    names = list(dict.fromkeys(points.x))
    drawing, axes = charts.panel_grid(figure, points, 2 * len(names))
    for (line, panel), group in points.groupby(["panel_row", "panel"], sort=False):
        axis, place = axes[line, panel], np.array([names.index(x) for x in group.x], float)
        bottom = np.zeros(len(group))
        for term, (text, colour, hatch) in TERMS.items():
            height = (group[term] * factor).to_numpy()
            axis.bar(place, height, 0.62, bottom=bottom, color=colour, hatch=hatch, edgecolor="white", linewidth=0.4,
                     label=text)
            bottom += height
        low, middle, high = ((group[c] * factor).to_numpy() for c in ("low", "middle", "high"))
        axis.errorbar(place, middle, yerr=[middle - low, high - middle], fmt="D", markersize=4, color=MEASURED,
                      markerfacecolor="white", elinewidth=0.8, label="measured")
        axis.set_xlim(-0.6, len(names) - 0.4)
    charts.finish(axes.values(), Scale(points.middle, False), points, "", (range(len(names)), texts(names), False), True, True)
    for axis in axes.values():
        axis.grid(axis="x", visible=False)
    x_label = figure.x_label or (attrs["x"].label() if attrs["x"] else "")
    return charts.labelled(figure, drawing, axes.values(), x_label, label,
                           captions.note_of(figure, points) + f" {attrs['source'][0].upper()}{attrs['source'][1:]}.")


