# SPDX-License-Identifier: BSD-3-Clause
"""Axes: where values stand on them, which values they name, and that no name lies on another."""

import math

import numpy as np
from matplotlib.ticker import MaxNLocator, NullLocator

from bvlab_plots.words import number


def spreads(values, least=25):
    """Whether the data asks for a logarithmic axis: the largest is at least `least` times the smallest."""
    values = np.asarray(values, float)
    positive = values[values > 0]
    if len(positive) < 2 or (values < 0).any():
        return False
    return np.log(positive.max()) - np.log(positive.min()) >= np.log(least)


class Scale:
    """Where values stand on an axis: zero has a place of its own on a logarithmic one."""

    def __init__(self, values, log):
        values = np.asarray(values, float)
        positive = values[(values > 0) & np.isfinite(values)]
        self.log = log and len(positive) > 0
        self.zero = positive.min() / 5 if self.log else 0
        self.has_zero = self.log and bool((values <= 0).any())

    def begins(self):
        """A power of ten below all values, or zero's place: where bars can begin on a logarithmic axis."""
        return self.zero if self.has_zero else 10.0 ** math.floor(math.log10(self.zero * 5) - 1e-9)

    def at(self, values):
        return np.maximum(np.asarray(values, float), self.zero) if self.log else np.asarray(values, float)


def numeric_ticks(values, across):
    """Ticks at the values themselves where they are few. A peer may have none: NaN is in no set of its kind."""
    there = sorted({value for value in values if not math.isnan(value)})
    if len(there) > 9 and not across.log:
        return None, None, False
    ticks = there
    if len(there) > 9:
        low, high = min(v for v in there if v > 0), max(there)
        tens = decades(low, high)
        ticks = [0] * across.has_zero + (tens if len(tens) > 1 else log_ticks(low, high))
    return across.at(ticks), [number(tick) for tick in ticks], across.log


def decades(low, high, most=6):
    """Powers of ten between two numbers, not too many."""
    powers = range(math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9) + 1)
    return [10.0**p for p in powers[::max(1, math.ceil(len(powers) / most))]]


def log_ticks(low, high):
    """Two to seven round numbers on a logarithmic axis."""
    steps = (1, 2, 5) if high / low < 100 else (1, 3) if high / low < 1000 else (1,)
    ticks = [step * 10.0**p for p in range(-15, 16) for step in steps if low <= step * 10.0**p <= high]
    if len(ticks) < 2:
        ticks = [tick for tick in MaxNLocator(5).tick_values(low, high) if low <= tick <= high]
    return ticks[::max(1, math.ceil(len(ticks) / 7))]


def name_log_ticks(axis, ticks=()):
    """Names these values of a logarithmic matplotlib axis, or some round ones of its range, and no others."""
    ticks = ticks or log_ticks(*axis.get_view_interval())
    axis.set_ticks(ticks, [number(tick) for tick in ticks])
    axis.set_minor_locator(NullLocator())


def share_y(axes, scale):
    """One range for all panels, unless that would leave most of them empty; plain numbers on short logarithmic axes."""
    ranges = np.array([axis.get_ylim() for axis in axes if axis.dataLim.height > 0] or [axes[0].get_ylim()])
    whole = ranges[:, 0].min(), ranges[:, 1].max()
    span = (lambda low, high: math.log(high / low)) if scale.log else (lambda low, high: high - low)
    alike = all(span(*each) > 0.45 * span(*whole) for each in ranges)
    for axis in axes:
        low, high = whole if alike or not axis.dataLim.height > 0 else axis.get_ylim()
        axis.set_ylim(low, high)
        if not scale.log:
            continue
        zero = [scale.zero] if scale.has_zero and low <= scale.zero else []
        ticks = [tick for tick in log_ticks(low, high) if not zero or tick > 1.5 * scale.zero]
        axis.set_yticks(zero + ticks, ["0"] * len(zero) + [number(tick) for tick in ticks])
        axis.yaxis.set_minor_locator(NullLocator())


def settle(drawing, axes):
    """No label of a tick lies on another: names are turned, numbers left out."""
    drawing.draw_without_rendering()
    for axis in axes:
        labels = [label for label in axis.get_xticklabels() if label.get_text() and label.get_visible()]
        if not overlapping(labels):
            continue
        if any(label.get_text().strip("$")[:1].isalpha() for label in labels):
            for label in labels:
                label.set(rotation=40, ha="right", rotation_mode="anchor", fontsize=7)
            continue
        kept = []
        for label in labels:
            if overlapping(kept[-1:] + [label]):
                label.set_visible(False)
            else:
                kept.append(label)


def overlapping(labels):
    boxes = [label.get_window_extent() for label in labels]
    return any(one.x1 + 4 > other.x0 and other.x1 + 4 > one.x0 for one, other in zip(boxes, boxes[1:]))
