# SPDX-License-Identifier: BSD-3-Clause
"""How coherence relates to speedup: a law for lists, fits to it and to margins, and how far they are off.

The law (the talk's 2n, n, n argument, carried on). A recursion that ends in n pairs makes 2n - 1 tests (R;
fewer where a hit ends it), a run through the front that it leaves makes c: n, 2 more for every entry gained,
and fewer where a hit found again ends it. From then on the list never shrinks. In its first run it gains the
share g of n. It gains more as the bodies come farther from where it was built than they have been: in its a-th
run g (D(a) - D(a - 1))^kappa, where D(a) is how far a walk gets in a steps, of which each is the last one again
with the probability p that the scene calls persistence (root mean square, D(1) = 1):

    D(a)^2 = a (1 + p) / (1 - p) - 2 p (1 - p^a) / (1 - p)^2.

A run takes c times its length over n. Where exp(-lambda) is the stillness (of runs weighted with their ends), it
gains nothing with probability exp(-lambda (D(a) - D(a - 1))^kappa), and the talk's rules say when it is rebuilt. Only
kappa is fitted; R, c, g and lambda are measured from recursive fronts of one frame and the next.
"""

import numpy as np
import pandas as pd

from bvlab_plots import records

LISTS = {"separation-list": 0, "deferred": 1}
FRONTLESS = ["recursive", "recursive-both", "witness"]
# The fit sees the bunny and the knot, when all bodies move or one does. Everything else is left out of it.
FITTED_MESHES = ["bunny", "knot"]
FITTED_MOTION_MODELS = ["all bodies, all freedoms", "one body, one freedom"]


def read(record):
    """One row per trace, volume and strategy: counts, median time, and the coherence of the trace."""
    rows = records.right(record, needs=["entries"])
    records.say_left_out(rows[rows.peer != ""].peer, "which keep no front")
    rows = rows[rows.peer == ""]
    unknown = rows.entries.isna()
    records.say_left_out(rows[unknown].variant, "whose coherence was not measured")
    cell = [c for c in rows.attrs["settings"] if c not in ("strategy", "variant")]
    rows = rows[~unknown].groupby(cell + ["strategy"], sort=False, as_index=False, dropna=False)
    rows = rows.median(numeric_only=True)
    recursive = rows[rows.strategy == "recursive"][cell + ["time_ns", "n_v", "n_p"]]
    return with_measures(rows.merge(recursive, on=cell, suffixes=("", "_recursive")))


def with_measures(rows):
    """What is made of sums: measures of coherence, and how many times as little a strategy does."""
    rows = rows.copy()
    rows["survival"] = rows.kept / rows.entries
    rows["stillness"] = rows.still_entries / rows.entries
    rows["growth"] = rows.grown / rows.entries
    rows["leaves"] = rows.motion_leaf / rows.near_runs
    rows["gaps"] = rows.motion_gap / rows.near_runs
    rows["tests_saved"] = rows.n_v_recursive / rows.n_v
    rows["all_saved"] = (rows.n_v_recursive + rows.n_p_recursive) / (rows.n_v + rows.n_p)
    rows["time_saved"] = rows.time_ns_recursive / rows.time_ns
    return rows


def strategies_of(rows):
    """Those that keep a front."""
    return [strategy for strategy in dict.fromkeys(rows.strategy) if strategy not in FRONTLESS]


def fitted(rows):
    """Which rows the fit may see."""
    seen = rows.mesh.isin(FITTED_MESHES)
    if "motion_model" in rows:
        seen &= rows.motion_model.isin(FITTED_MOTION_MODELS)
    if "motion" in rows:  # motions of one kind only are left out
        seen &= ~rows.motion.str.match(r"^0 /|.*/ 0$")
    return seen


def way_out(persistence, steps):
    """How far a walk gets in `steps` steps, in lengths of a step."""
    p = np.minimum(persistence, 1 - 1e-4)
    return np.sqrt(np.maximum(steps * (1 + p) / (1 - p) - 2 * p * (1 - p**steps) / (1 - p) ** 2, 0))


def by_age(rows, defer, kappa):
    """Of each run since a list was rebuilt, shape (frames, rows): how likely the list is kept until then, and its tests
    over those of the recursion, near pairs only, by the law."""
    near = rows.near_runs.where(rows.near_runs > 0).to_numpy(float)  # NaN where nothing was near
    full = rows.tests.to_numpy() / near
    once = rows.again.to_numpy() / near
    gain = rows.growth.to_numpy()
    rate = -np.log(np.clip(rows.stillness.to_numpy(), 1e-12, 1))
    persistence = rows.persistence.to_numpy(float)
    states = [np.ones(len(rows))] + [np.zeros(len(rows)) for _ in range(defer)]
    kept, cost, length = [np.ones(len(rows))], [np.ones(len(rows))], np.ones(len(rows))
    for age in range(1, int(rows.frames.max())):
        alive = sum(states) * (age < rows.frames.to_numpy())
        fresh = (way_out(persistence, age) - way_out(persistence, age - 1)) ** kappa
        kept.append(alive)
        cost.append(once * length / full)
        length = length + gain * fresh
        still = np.exp(-rate * fresh)
        states = [alive * (1 - still)] + [state * still for state in states[:-1]]
    return np.array(kept), np.array(cost)


def list_over_recursion(rows, defer, kappa):
    """Tests of a list over those of the recursion, near pairs only: the mean from one rebuild to the next."""
    kept, cost = by_age(rows, defer, kappa)
    return (kept * cost).sum(axis=0) / kept.sum(axis=0)


def predicted(rows, kappa):
    """The speedup in tests by the law; pairs that are not near take one test either way."""
    result = np.full(len(rows), np.nan)
    for name, defer in LISTS.items():
        of_list = (rows.strategy == name).to_numpy()
        part = rows[of_list]
        far = part.pair_runs - part.near_runs
        ratio = list_over_recursion(part, defer, kappa)
        result[of_list] = (far + part.tests) / (far + part.tests * ratio)
    return result


def fit_kappa(rows):
    """The kappa with the least squared error of log speedup, to two digits."""
    seen = rows[fitted(rows) & rows.strategy.isin(LISTS)]
    candidates = np.arange(0, 2.001, 0.02)
    errors = [np.mean(np.log(predicted(seen, g) / seen.tests_saved) ** 2) for g in candidates]
    return candidates[int(np.argmin(errors))]


def off_by(rows, predicted):
    """|predicted / measured - 1| of each row."""
    return (pd.Series(predicted, rows.index) / rows.tests_saved - 1).abs()


def in_parts(rows, values):
    """The values of rows that the fit may see, and of those that are left out of it, where there are any."""
    seen = fitted(rows)
    return {label: values[part] for label, part in (("fitted", seen), ("left out", ~seen)) if part.any()}


def errors(rows, kappa):
    """Median and 95th percentile of |predicted / measured - 1|, and of how many cells, fitted and left out."""
    rows = rows[rows.strategy.isin(LISTS)]
    parts = in_parts(rows, off_by(rows, predicted(rows, kappa)))
    return {label: (off.median(), off.quantile(0.95), len(off)) for label, off in parts.items()}


def crossing(rows, strategy, what):
    """The survival below which most cells lose: the threshold that misjudges the fewest, and the share that it misjudges."""
    group = rows[rows.strategy == strategy].sort_values("survival")
    wins = (group[what] > 1).to_numpy()
    # Below the threshold wins are misjudged, above it losses.
    wrong = np.concatenate([[0], np.cumsum(wins)]) + np.concatenate(
        [np.cumsum(~wins[::-1])[::-1], [0]])
    k = int(np.argmin(wrong))
    survival = group.survival.to_numpy()
    at = survival[0] if k == 0 else survival[-1] if k == len(survival) else survival[k - 1:k + 1].mean()
    return at, wrong[k] / len(group)


def fit_margins(rows):
    """What margins leave to do, as c leaves^alpha: least squares in logarithms, where they save."""
    group = rows[(rows.strategy == "margins") & fitted(rows)]
    group = group[(group.leaves > 0) & (group.all_saved > 1.1)]
    if len(group) < 3:
        return None
    alpha, log_c = np.polyfit(np.log(group.leaves), -np.log(group.all_saved), 1)
    return np.exp(log_c), alpha
