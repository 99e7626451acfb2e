# SPDX-License-Identifier: BSD-3-Clause
"""Lines and bars of the points of a figure: panels, axes, ticks and labels."""

import math
import re
import textwrap
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.ticker import NullLocator

from bvlab_plots import captions, style
from bvlab_plots.ticks import Scale, numeric_ticks, settle, share_y, spreads
from bvlab_plots.words import number, plain, scaled, texts, value_text

GREY = "#8f8f8f"


def panel_grid(figure, points, places):
    """A figure, and its axes by (panel_row, panel): in one grid where rows are declared, else as many beside each
    other as their titles and places on x leave room for.

    seaborn's FacetGrid lays out in one number of columns, whatever is in the panels; here it depends on that."""
    names = list(dict.fromkeys(zip(points.panel_row, points.panel)))
    if figure.panel_rows or "quantities" in points.attrs:
        return declared_grid(figure, names)
    title = max(len(name) for _, name in names)
    room = 1 if places > 60 else 2 if title > 26 or places > 20 else 3 if title > 16 else 4
    columns = min(len(names), room)
    if columns == 3 and len(names) == 4:
        columns = 2
    lines, height = math.ceil(len(names) / columns), 1.8 if room == 1 else 2.2
    narrow, wide = style.WIDTHS["column"], style.WIDTHS["page"]
    width = wide if places > 40 else narrow if columns == 1 else min(wide, 1.2 + 2.5 * columns)
    width = style.WIDTHS.get(figure.width, width)
    drawing, axes = style.subplots(lines, columns, figsize=(width, 0.5 + height * lines), sharex=True)
    for axis in axes.flat[len(names):]:
        axis.remove()
    for axis, (_, name) in zip(axes.flat, names):
        axis.set_title(name)
    # Where the last line is short the axes above its gap carry ticks and labels.
    bottom = [axes.flat[i] for i in range(len(names)) if i + columns >= len(names)]
    for axis in bottom:
        axis.tick_params(labelbottom=True)
    return drawing, dict(zip(names, axes.flat))


def declared_grid(figure, names):
    """Small multiples: a line of panels for each value of panel_rows, a column for each of panels."""
    lines, columns = (list(dict.fromkeys(name[i] for name in names)) for i in (0, 1))
    width = style.WIDTHS.get(figure.width, min(style.WIDTHS["page"], 1.0 + 2.1 * len(columns)))
    drawing, axes = style.subplots(len(lines), len(columns), figsize=(width, 0.5 + 1.45 * len(lines)), sharex=True)
    found = {}
    for i, line in enumerate(lines):
        for j, column in enumerate(columns):
            if i == 0:
                axes[i, j].set_title(column)
            if (line, column) in names:
                found[line, column] = axes[i, j]
            else:
                axes[i, j].set_axis_off()
        if figure.panel_rows:
            axes[i, -1].annotate(line, (1.02, 0.5), xycoords="axes fraction", rotation=270, va="center",
                                 fontsize=matplotlib.rcParams["legend.fontsize"])
    return drawing, found


def logs(figure, points):
    """Which axes are logarithmic, by the figure or by the data."""
    named = figure.log.replace("none", "")
    if figure.log:
        return "x" in named, "y" in named
    return points.attrs["x"] is not None and spreads(points.x), (
        spreads(points.middle, 4 if figure.over else 25) or spreads(points[["low", "high"]], 200))


def over_text(over):
    """"strategy=recursive" as "recursive"."""
    if over.startswith("best"):
        return f"the {over}"
    parts = [re.split(r"\s*=\s*", part.strip(), 1) for part in re.split(r",\s*(?=\w+\s*=)", over)]
    return ", ".join(f"the record {plain(Path(value).name)}" if column == "record" else value_text(column, value)
                     for column, value in parts)


def value_label(expression, figure):
    """What is drawn, in words: a value, a ratio to another's, or how many times as little."""
    if not figure.over:
        return expression.label()
    other = over_text(figure.over)
    if figure.ratio == "speedup":
        return f"speedup over {other}\n({expression.label()})"
    return f"{expression.label()}\nover {other}" + ("" if other.endswith("best of ours") else "'s")


def labelled_unit(expression, given, values, figure=None):
    """A label with its unit, and what to multiply values with to get that unit."""
    over = figure is not None and bool(figure.over)
    unit, factor = ("", 1) if over else scaled(expression.unit(), values)
    text = given or (value_label(expression, figure) if over else expression.label())
    return (f"{text} ({unit})" if unit and not given.endswith(")") else text), factor


def draw(figure, points):
    """A matplotlib figure of kind line or bars. Each quantity has a row of panels, and an axis of its own."""
    attrs = points.attrs
    quantities = attrs.get("quantities", [attrs])
    named = attrs["x"] is None or figure.kind == "bars"
    looks, labels = style.joint_looks(points.key), dict(zip(points.key, points.series))
    labels.update({key: labels[key] + " (answers differ)" for key in points[points.wrong].key})
    drawing, axes = panel_grid(figure, points, points.x.nunique() * len(looks) if named else 0)
    if named:
        names = list(dict.fromkeys(points.x))
        places = range(len(names)), texts(names), False
        x_label = figure.x_label or (attrs["x"].titled() if attrs["x"] else "")
    else:
        log_x = logs(figure, points)[0]
        x_label, x_factor = labelled_unit(attrs["x"], figure.x_label, points.x)
        points = points.assign(x=points.x * x_factor)
        across = Scale(points.x, log_x)
        places = numeric_ticks(points.x, across)
    note, y_labels = captions.note_of(figure, points), []
    given = [text.strip() for text in figure.y_label.split(";")] if len(quantities) > 1 else [figure.y_label]
    for row, quantity in enumerate(quantities):
        part, there = points, axes
        if len(quantities) > 1:
            part = points[points.panel_row == str(row)]
            there = {place: axis for place, axis in axes.items() if place[0] == str(row)}
        y_label, factor = y_label_of(quantity, figure, part, given[row] if row < len(given) else "")
        y_labels.append(y_label)
        log_y = logs(figure, part)[1]
        part = part.assign(**{c: part[c] * factor for c in ("low", "middle", "high")})
        scale = Scale(part.middle, log_y)
        if named:
            base = draw_named(part, there, looks, labels, scale, figure, names)
            note += f" Bars begin at {number(base)}." if base and not figure.over else ""
        else:
            draw_lines(part, there, looks, labels, scale, across, attrs["measured"])
        finish(there.values(), scale, part, figure.over, places, named, figure.kind == "bars")
        if len(quantities) > 1:
            next(iter(there.values())).set_ylabel(wrapped(y_label, 22))
    return labelled(figure, drawing, axes.values(), x_label, "" if len(quantities) > 1 else y_labels[0], note)


def y_label_of(quantity, figure, points, given):
    """What is on an axis, with its unit, and what to multiply values with."""
    label, factor = labelled_unit(quantity["value"], given, points.middle, figure)
    if quantity["several"] and not given:
        unit = label[label.rfind("("):] if label.endswith(")") else ""
        label = {"ns": "time"}.get(quantity["value"].unit(), "value") + f" {unit}"
    return label, factor


def labelled(figure, drawing, axes, x_label, y_label, note):
    """With labels, the legend and the note below it."""
    size = matplotlib.rcParams["axes.labelsize"]
    drawing.supylabel(wrapped(y_label, 13 * drawing.get_figheight()), fontsize=size)
    drawing.supxlabel(wrapped(x_label, 13 * drawing.get_figwidth()), fontsize=size)
    handles, names = style.labelled(axes)
    legend = None
    if len(names) > 1 or names and names[0]:
        legend = style.legend_below(drawing, handles, names)
    settle(drawing, axes)
    captions.write(figure, drawing, note, legend)
    return drawing


def wrapped(label, most):
    """In lines of at most `most` letters."""
    return "\n".join(textwrap.fill(line, int(most)) for line in label.split("\n"))


def draw_lines(points, axes, looks, labels, scale, across, measured):
    for (line, panel, key), group in points.groupby(["panel_row", "panel", "key"], sort=False):
        group = group if measured else group.sort_values("x")
        low, middle, high = (scale.at(group[c]) for c in ("low", "middle", "high"))
        axes[line, panel].errorbar(across.at(group.x), middle, yerr=[middle - low, high - middle], label=labels[key],
                                   markersize=4, linewidth=1.1, elinewidth=0.6, **style.point_style(looks[key]))


def draw_named(points, axes, looks, labels, scale, figure, names):
    """Side by side at each name. Bars stand on zero, or, as ratios on a logarithmic axis, on one; where neither is on
    the axis there are points, or, if the figure says so, bars from where the axis begins. Gives where bars begin."""
    keys = list(looks)
    barred = figure.kind == "bars" and (not scale.log or bool(figure.over) or "y" in figure.log)
    width, base = 0.8 / len(keys), 1 if scale.log else 0
    if barred and scale.log and not figure.over:
        base = scale.begins()
    for (line, panel, key), group in points.groupby(["panel_row", "panel", "key"], sort=False):
        axis = axes[line, panel]
        place = np.array([names.index(x) for x in group.x]) + (keys.index(key) - (len(keys) - 1) / 2) * width
        low, middle, high = (scale.at(group[c]) for c in ("low", "middle", "high"))
        label = labels[key]
        if barred:
            axis.bar(place, middle - base, width, bottom=base, label=label, **style.bar_style(looks[key]))
            axis.errorbar(place, middle, yerr=[middle - low, high - middle], fmt="none", ecolor="black", elinewidth=0.7)
            # A bar of no height differs from none.
            for x in place[middle == base] if base == 0 else []:
                axis.annotate("0", (x, 0), xytext=(0, 1), textcoords="offset points", ha="center", fontsize=6, color=GREY)
        else:
            axis.errorbar(place, middle, yerr=[middle - low, high - middle], label=label, markersize=4.5,
                          elinewidth=0.7, **style.marker_style(looks[key]))
    for axis in axes.values():
        axis.grid(axis="x", visible=False)
        for between in range(1, len(names)):
            axis.axvline(between - 0.5, color="#eeeeee", linewidth=0.8, zorder=0)
        axis.set_xlim(-0.5, len(names) - 0.5)
    return base if barred else 0


def finish(axes, scale, points, over, places, named, barred):
    """Scales and ticks."""
    ticks, names, log_x = places
    for axis in axes:
        if scale.log:
            axis.set_yscale("log")
        elif (points.low >= 0).all() and (barred or not over):
            axis.set_ylim(0, None if points.high.max() > 0 else 1)
        if log_x and not named:
            axis.set_xscale("log")
        if ticks is not None:
            axis.set_xticks(ticks, names)
            axis.xaxis.set_minor_locator(NullLocator())
        if over:
            axis.axhline(1, color=GREY, linewidth=0.8, zorder=1)
    share_y(list(axes), scale)
