# SPDX-License-Identifier: BSD-3-Clause
"""Maps over two axes: which variant has the least, what ties with it, and how much that is; or how much alone."""

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.colors import LogNorm, Normalize, to_rgb

from bvlab_plots import captions, charts, style
from bvlab_plots.ticks import spreads
from bvlab_plots.words import number, plain, scaled, texts

TIE = 1.05  # times the least: within this a variant is as good


def winners(points):
    """One row for each panel and field: what is least there, and what ties with it."""
    rows = []
    for (panel, x, y), field in points.groupby(["panel", "x", "y"], sort=False):
        field = field.sort_values("middle", kind="stable")
        best = field.iloc[0]
        ties = field[(field.middle <= TIE * best.middle) & (field.key != best.key)]
        rows.append(dict(panel=panel, x=x, y=y, key=best.key, series=best.series, value=best.middle, ratio=best.ratio,
                         ties=list(ties.series), keys=list(ties.key)))
    return pd.DataFrame(rows)


def ink(colour):
    """Black or white, whichever reads on the colour."""
    red, green, blue = to_rgb(colour)
    return "black" if 0.3 * red + 0.59 * green + 0.11 * blue > 0.5 else "white"


def prepared(points, figure):
    """Values in a unit that reads, and labels of both axes."""
    attrs = points.attrs
    unit, factor = scaled(attrs["value"].unit(), points.middle)
    labels = [given or (e.titled() if e else "") for e, given in ((attrs["x"], figure.x_label), (attrs["y"], figure.y_label))]
    return points.assign(middle=points.middle * factor), unit, labels


def field_axes(points):
    """A figure with an axis for each panel, whose fields are all of one size."""
    panels, columns, lines = (list(dict.fromkeys(points[c])) for c in ("panel", "x", "y"))
    columns, lines = in_order(columns), in_order(lines)
    across = len(panels) if len(panels) <= 2 and len(panels) * len(columns) <= 8 else 1
    down = -(-len(panels) // across)
    size = (1.2 + 1.16 * len(columns) * across, 0.8 + (0.35 + 0.74 * len(lines)) * down)
    drawing, axes = style.subplots(down, across, figsize=size)
    for axis in axes.flat:
        axis.set(xlim=(-0.5, len(columns) - 0.5), ylim=(-0.5, len(lines) - 0.5))
        axis.set_xticks(range(len(columns)), texts(columns))
        axis.set_yticks(range(len(lines)), texts(lines))
        axis.grid(False)
        axis.tick_params(length=0)
    for axis in axes.flat[len(panels):]:
        axis.remove()
    for axis, panel in zip(axes.flat, panels):
        axis.set_title(panel)
    return drawing, dict(zip(panels, axes.flat)), columns, lines


def in_order(values):
    """Numbers from the least; names as they come."""
    return values if any(isinstance(value, str) for value in values) else sorted(values)


def draw(figure, points):
    """A matplotlib figure of kind map."""
    points, unit, labels = prepared(points, figure)
    drawing, axes, columns, lines = field_axes(points)
    legend = None
    if points.key.nunique() > 1:
        legend = draw_winners(drawing, axes, columns, lines, points, unit, figure)
    else:
        draw_values(drawing, axes, columns, lines, points, unit, figure)
    for axis in axes.values():
        axis.set(xlabel=labels[0], ylabel=labels[1])
    captions.write(figure, drawing, captions.note_of(figure, points), legend)
    return drawing


def draw_winners(drawing, axes, columns, lines, points, unit, figure):
    """Each field in the colour and hatch of its winner; a second one's stripe where that is as good."""
    over = figure.over
    if over and figure.ratio != "speedup":  # a field says how many times as little it is
        points = points.assign(ratio=1 / points.ratio)
    best = winners(points)
    looks = style.joint_looks(sorted({*best.key, *(key for keys in best["keys"] for key in keys)}))
    firsts = {first: dict(look, fill="full") for (first, _), look in looks.items()}
    for field in best.itertuples():
        x, y, axis = columns.index(field.x), lines.index(field.y), axes[field.panel]
        look = firsts[field.key[0]]
        axis.add_patch(plt.Rectangle((x - 0.48, y - 0.47), 0.96, 0.94, facecolor=look["color"], hatch=look["hatch"],
                                     edgecolor="white", linewidth=0))
        others = [key[0] for key in field.keys if key[0] != field.key[0]]
        if others:
            axis.add_patch(plt.Rectangle((x + 0.36, y - 0.47), 0.12, 0.94, facecolor=firsts[others[0]]["color"],
                                         hatch=firsts[others[0]]["hatch"], edgecolor="white", linewidth=0))
        text = text_of(field, unit, over)
        size = min(6.2, 6.2 * 20 / max(map(len, text.split("\n"))))
        axis.text(x - (0.06 if others else 0), y, text, ha="center", va="center", fontsize=size, linespacing=1.05,
                  color=ink(look["color"]), bbox=dict(facecolor=look["color"], edgecolor="none", pad=0.6))
    shown = [plt.Rectangle((0, 0), 1, 1, **style.bar_style(look)) for look in firsts.values()]
    note = f"= within {100 * (TIE - 1):.0f} % of the least"
    if over:
        note += f"; ×: times as {'fast' if points.attrs['timed'] else 'little'} as {charts.over_text(over)}"
    return style.legend_below(drawing, shown, [plain(name) for name in firsts], title=note, title_fontsize=7)


def text_of(field, unit, over):
    """What wins where colours alone do not say it, how much it takes, and what ties with it."""
    lines = [field.series.replace(" ", "\n", 1)] if field.key[1] else []
    lines.append(f"{rounded(field.value, 2)} {unit}" + (f", {field.ratio:.2g}×" if over and field.ratio else ""))
    if field.ties:
        lines.append(f"= {len(field.ties)} more" if len(field.ties) > 1 else f"= {field.ties[0]}")
    return "\n".join(lines)


def rounded(value, digits):
    return number(float(f"{value:.{digits}g}"))


def draw_values(drawing, axes, columns, lines, points, unit, figure):
    """Each field in a grey of its value, with a bar that says which."""
    values = points.middle if not figure.over else points.ratio
    norm = LogNorm(values.min(), values.max()) if spreads(values) else Normalize(min(0, values.min()), values.max())
    shades = plt.get_cmap("Greys")
    for field, value in zip(points.itertuples(), values):
        x, y = columns.index(field.x), lines.index(field.y)
        colour = shades(0.08 + 0.8 * norm(value))
        axes[field.panel].add_patch(plt.Rectangle((x - 0.49, y - 0.49), 0.98, 0.98, facecolor=colour))
        axes[field.panel].text(x, y, rounded(value, 3), ha="center", va="center", fontsize=7, color=ink(colour[:3]))
    label = figure.value_label or charts.value_label(points.attrs["value"], figure).replace("\n", " ")
    title = label + (f" ({unit})" if unit and not figure.over else "")
    drawing.suptitle(charts.wrapped(title, 13 * drawing.get_figwidth()), fontsize=9)
