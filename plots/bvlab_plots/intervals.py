# SPDX-License-Identifier: BSD-3-Clause
"""What is drawn of several values, and the interval beside it."""

from functools import partial

import numpy as np
import pandas as pd
from scipy import stats

STATISTICS = {"median": np.median, "mean": np.mean, "p99": partial(np.quantile, q=0.99), "worst": np.max, "least": np.min}
BEFORE = {"median": "quartiles", "mean": "95%"}  # the interval of a statistic where a figure names none
MANY = 5  # values, from which on a bootstrap says something
DRAWS = 2000
WORDS = {"median": "medians", "mean": "means", "p99": "99th percentiles", "worst": "largest values",
         "least": "least values"}
INTERVALS = {"quartiles": "quartiles", "range": "least to largest", "none": ""}


def chosen(figure):
    """The statistic of a figure and its interval."""
    statistic = figure.statistic or "median"
    return statistic, figure.interval or BEFORE.get(statistic, "none")


def bootstrap(values, statistic):
    """95 % by resampling, the same numbers for the same values; of fewer than MANY values their range."""
    values = np.asarray(values, float)
    if len(values) < MANY:
        return values.min(), values.max()
    random = np.random.default_rng(1)
    drawn = values[random.integers(0, len(values), (DRAWS, len(values)))]
    return tuple(np.quantile(STATISTICS[statistic](drawn, axis=1), [0.025, 0.975]))


def summary(values, statistic, interval):
    """low, middle, high."""
    values = np.asarray(values, float)
    middle = STATISTICS[statistic](values)
    if interval == "quartiles":
        low, high = np.quantile(values, [0.25, 0.75])
    elif interval == "range":
        low, high = values.min(), values.max()
    elif interval == "95%" and statistic == "mean" and len(values) > 1:
        low, high = middle + stats.t.ppf([0.025, 0.975], len(values) - 1) * stats.sem(values)
    elif interval == "95%":
        low, high = bootstrap(values, statistic)
    else:
        low = high = middle
    return pd.Series([min(low, middle), middle, max(high, middle)], ["low", "middle", "high"])


def in_words(figure, most):
    """What points and bars are, `most` being the most values that a point is made of: "medians; bars: quartiles"."""
    statistic, interval = chosen(figure)
    if most == 1:
        return "single runs, no interval"
    if interval == "none":
        return WORDS[statistic]
    if interval == "95%":
        by = "t" if statistic == "mean" else "bootstrap" if most >= MANY else "range: too few for more"
        return f"{WORDS[statistic]}; bars: 95 % ({by})"
    return f"{WORDS[statistic]}; bars: {INTERVALS[interval]}"
