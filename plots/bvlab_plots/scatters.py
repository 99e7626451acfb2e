# SPDX-License-Identifier: BSD-3-Clause
"""Scatters: a point for each cell, and the line or the power law that fits each series best."""

import numpy as np
from scipy import stats

from bvlab_plots import captions, charts, style
from bvlab_plots.refused import Refused
from bvlab_plots.ticks import Scale, numeric_ticks, share_y, spreads
from bvlab_plots.words import plain


class Fit:
    """y = a + b x, or y = a x^b, by least squares (of logarithms), b with its 95 % interval by Student's t.

    seaborn's regplot draws a line, and gives no numbers."""

    def __init__(self, kind, x, y):
        self.kind = kind
        x, y = np.asarray(x, float), np.asarray(y, float)
        if kind == "power":
            kept = (x > 0) & (y > 0)
            x, y = np.log(x[kept]), np.log(y[kept])
        if len(x) < 3 or np.ptp(x) == 0:
            raise Refused(f"a fit needs three points of different x, there are {len(x)}")
        found = stats.linregress(x, y)
        self.slope, self.intercept, self.determination, self.points = found.slope, found.intercept, found.rvalue**2, len(x)
        half = stats.t.ppf(0.975, len(x) - 2) * found.stderr if len(x) > 2 else np.inf
        self.low, self.high = self.slope - half, self.slope + half
        error = stats.t.ppf(0.975, len(x) - 2) * found.intercept_stderr
        self.intercepts = self.intercept - error, self.intercept + error

    def at(self, x):
        if self.kind == "power":
            return np.exp(self.intercept) * np.asarray(x, float) ** self.slope
        return self.intercept + self.slope * np.asarray(x, float)

    def text(self):
        if self.kind == "power":
            return f"exponent {self.slope:.2f} [{self.low:.2f}, {self.high:.2f}], R² {self.determination:.2f}"
        return f"slope {self.slope:.3g} [{self.low:.3g}, {self.high:.3g}], R² {self.determination:.2f}"


def draw(figure, points):
    """A matplotlib figure of kind scatter."""
    attrs = points.attrs
    y_label, factor = charts.labelled_unit(attrs["value"], figure.y_label, points.middle, figure)
    x_label, x_factor = charts.labelled_unit(attrs["x"], figure.x_label, points.x)
    points = points.assign(x=points.x * x_factor, **{c: points[c] * factor for c in ("low", "middle", "high")})
    logs = figure.log or ("xy" if figure.fit == "power" else "")
    log_x = "x" in logs.replace("none", "") if logs else spreads(points.x)
    log_y = "y" in logs.replace("none", "") if logs else spreads(points.middle)
    scale, across = Scale(points.middle, log_y), Scale(points.x, log_x)
    looks, labels = style.joint_looks(points.key), dict(zip(points.key, points.series))
    drawing, axes = charts.panel_grid(figure, points, 0)
    fits = {panel: [] for panel in axes}
    for (line, panel, key), group in points.groupby(["panel_row", "panel", "key"], sort=False):
        axis = axes[line, panel]
        low, middle, high = (scale.at(group[c]) for c in ("low", "middle", "high"))
        axis.errorbar(across.at(group.x), middle, yerr=[middle - low, high - middle], label=labels[key], markersize=3.5,
                      elinewidth=0.5, **style.marker_style(looks[key]))
        if figure.fit:
            fit = Fit(figure.fit, group.x, group.middle)
            kept = group.x[group.x > 0] if log_x else group.x
            ends = (np.geomspace if log_x else np.linspace)(kept.min(), kept.max(), 60)
            axis.plot(ends, fit.at(ends), linewidth=1, **style.line_style(looks[key]))
            fits[line, panel].append((fit.text(), labels[key], looks[key]["color"]))
    for panel, axis in axes.items():
        annotate(axis, fits[panel])
    charts.finish(axes.values(), scale, points.assign(low=points.low), "", numeric_ticks(points.x, across), False, False)
    share_y(list(axes.values()), scale)
    note = captions.note_of(figure, points)
    if figure.fit:
        note += f" {'y = a x^b' if figure.fit == 'power' else 'y = a + b x'} by least squares" + \
            (" of logarithms" if figure.fit == "power" else "") + "; [ ]: 95 % (t)."
    return charts.labelled(figure, drawing, axes.values(), x_label, y_label, note)


def annotate(axis, fits):
    """Above the panel, in the series' colour: slope or exponent."""
    several = len(fits) > 1
    for i, (text, name, colour) in enumerate(reversed(fits)):
        axis.annotate(f"{plain(name)}: {text}" if several and name else text, (0, 1), (0, 2 + 7.5 * i),
                      xycoords="axes fraction", textcoords="offset points", fontsize=6, color=colour)
    if fits:
        axis.set_title(axis.get_title(), pad=5 + 7.5 * len(fits))
