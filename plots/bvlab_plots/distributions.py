# SPDX-License-Identifier: BSD-3-Clause
"""Distributions of a figure's values, by seaborn: empirical distribution functions, and boxes."""

import matplotlib.pyplot as plt
import pandas as pd
import seaborn as sns

from bvlab_plots import captions, charts, style
from bvlab_plots.figures import default_value
from bvlab_plots.points import axis_of, places_of, pooled_in, rows_of, said_of
from bvlab_plots.ticks import Scale, numeric_ticks, spreads
from bvlab_plots.words import span, texts


def values_of(rows, figure):
    """A frame of every value: panel, panel_row, series, key, x (of boxes), middle; as points have it."""
    text = (figure.x if figure.kind == "ecdf" else figure.y) or default_value(rows)
    rows, value = rows_of(rows, figure, text)
    drawn, across = places_of(rows, figure), None
    if figure.kind == "box":
        x, across, _ = axis_of(rows, figure.x, "x")
        drawn["x"] = x
    pooled = pooled_in(rows, figure, drawn)
    points = drawn.assign(middle=rows.value, low=rows.value, high=rows.value, ratio=rows.ratio, wrong=rows.wrong)
    points["count"] = points.groupby([points[c].to_numpy() for c in drawn], sort=False).middle.transform("size")
    if "x" not in points:
        points["x"] = points.middle
    points.attrs.update(value=value, x=across, y=None, measured=False, pooled=pooled, several=False, **said_of(rows, value))
    return points


def count_text(points):
    return span(*(f"{count:.0f}" for count in (points["count"].min(), points["count"].max())))


def draw(figure, points):
    """A matplotlib figure of kind ecdf or box."""
    label, factor = charts.labelled_unit(points.attrs["value"], figure.value_label or (
        figure.x_label if figure.kind == "ecdf" else figure.y_label), points.middle, figure)
    attrs = points.attrs
    points = points.assign(middle=points.middle * factor)
    points.attrs.update(attrs)
    return (ecdfs if figure.kind == "ecdf" else boxes)(figure, points, label)


def ecdfs(figure, points, label):
    looks, labels = style.joint_looks(points.key), dict(zip(points.key, points.series))
    log = figure.log == "x" if figure.log else spreads(points.middle)
    drawing, axes = charts.panel_grid(figure, points, 0)
    for (line, panel, key), group in points.groupby(["panel_row", "panel", "key"], sort=False):
        sns.ecdfplot(x=group.middle, ax=axes[line, panel], label=labels[key], linewidth=1.2,
                     **style.line_style(looks[key]))
    for axis in axes.values():
        if log:
            axis.set_xscale("log")
        axis.set(xlabel="", ylabel="", ylim=(0, 1.02))
    ticks, numbers, _ = numeric_ticks(points.middle, Scale(points.middle, log))
    if log and ticks is not None:
        for axis in axes.values():
            axis.set_xticks(ticks, numbers, minor=False)
            axis.minorticks_off()
    note = captions.note_of(figure, points, made=f"distribution of {count_text(points)} values a curve")
    return charts.labelled(figure, drawing, axes.values(), label, "share of values", note)


def boxes(figure, points, label):
    looks, labels = style.joint_looks(points.key), dict(zip(points.key, points.series))
    names, keys = list(dict.fromkeys(points.x)), list(looks)
    drawing, axes = charts.panel_grid(figure, points, len(names) * len(keys))
    log = figure.log == "y" if figure.log else spreads(points.middle)
    for (line, panel), group in points.groupby(["panel_row", "panel"], sort=False):
        axis = axes[line, panel]
        frame = pd.DataFrame(dict(x=[names.index(x) for x in group.x], y=group.middle.to_numpy(),
                                  series=[keys.index(key) for key in group.key]))
        if log:
            axis.set_yscale("log")
        sns.boxplot(data=frame, x="x", y="y", hue="series", order=range(len(names)), hue_order=range(len(keys)),
                    whis=(0, 100), linewidth=0.7, ax=axis, width=0.8)
        axis.legend_.remove()
        dress(axis, keys, looks, labels)
        axis.set(xlabel="", ylabel="", xticks=range(len(names)))
        axis.set_xticklabels(texts(names))
        axis.grid(axis="x", visible=False)
    note = captions.note_of(figure, points, made=f"boxes: quartiles, whiskers: least to largest, of {count_text(points)} "
                            "values a box")
    x_label = figure.x_label or (points.attrs["x"].label() if points.attrs["x"] else "")
    return charts.labelled(figure, drawing, axes.values(), x_label, label, note)


def dress(axis, keys, looks, labels):
    """Boxes in the looks of their names: seaborn puts those of one x side by side, in the order of the series."""
    for patch in list(axis.patches):
        if isinstance(patch, plt.Rectangle):  # of seaborn's own legend
            patch.remove()
            continue
        middle = patch.get_path().vertices[:4, 0].mean()
        key = keys[round(((middle - round(middle)) / 0.8 + 0.5) * len(keys) - 0.5)]
        patch.set(**look_of(looks[key]))
    for key in keys:
        axis.add_patch(plt.Rectangle((0, 0), 0, 0, label=labels[key], **look_of(looks[key])))


def look_of(look):
    """A box light enough for its median to be seen."""
    return dict(facecolor=style.lighter(look["color"]), hatch=look["hatch"], edgecolor="#444444", linewidth=0.7)
