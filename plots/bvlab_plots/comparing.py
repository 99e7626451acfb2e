# SPDX-License-Identifier: BSD-3-Clause
"""Two records compared, cell by cell: ratios of medians with intervals, and counts that are not the same."""

import numpy as np
import pandas as pd

from bvlab_plots.expression import Expression
from bvlab_plots.figures import default_value
from bvlab_plots.intervals import DRAWS, MANY
from bvlab_plots.refused import Refused
from bvlab_plots.words import number, value_text

SAME = ["hits", "differing", "n_u", "n_v", "n_p", "front", "pairs", "overlaps", "false_positives", "false_negatives",
        "wrong", "outside"]  # counts, which do not depend on the machine


def ratio_of(before, after):
    """low, middle, high of median(after) / median(before)."""
    before, after = np.asarray(before, float), np.asarray(after, float)
    middle = np.median(after) / np.median(before)
    if min(len(before), len(after)) < MANY:
        return after.min() / before.max(), middle, after.max() / before.min()
    random = np.random.default_rng(1)
    drawn = [np.median(values[random.integers(0, len(values), (DRAWS, len(values)))], axis=1) for values in (after, before)]
    return np.quantile(drawn[0] / drawn[1], 0.025), middle, np.quantile(drawn[0] / drawn[1], 0.975)


def verdict(low, high, several):
    if not several:
        return "once"  # one run each: there is no interval
    return "faster" if high < 1 else "slower" if low > 1 else "as before"


def keyed(rows, keys):
    """{text of the settings: rows}: 0.1 of one record is 0.1 of another."""
    found = rows.groupby([rows[key].astype(str) for key in keys], sort=False, dropna=False)
    return {key if isinstance(key, tuple) else (key,): part for key, part in found}


def compared(before, after, text=""):
    """A line for each cell of both: its settings, ratio, low, high, verdict, and `different`, the counts that are."""
    shared = [c for c in before.attrs["settings"] if c in after.attrs["settings"]]
    text = text or default_value(before)
    values = [Expression(text, rows).of(rows).astype(float) for rows in (before, after)]
    if any(value.isna().all() for value in values):
        raise Refused(f"'{text}' is known for no row of one of them: --value says what is compared")
    before, after = (rows.assign(compared=value) for rows, value in zip((before, after), values))
    counts = [c for c in SAME if c in before and c in after and c not in text]
    others, lines = keyed(after, shared), []
    for key, part in keyed(before, shared).items():
        if key not in others:
            lines.append(dict(zip(shared, key), verdict="gone"))
            continue
        other = others.pop(key)
        mine, theirs = part.compared.dropna(), other.compared.dropna()
        different = [c for c in counts if not same(part[c], other[c])]
        low, middle, high = ratio_of(mine, theirs) if len(mine) and len(theirs) and mine.median() > 0 else (np.nan,) * 3
        judged = verdict(low, high, min(len(mine), len(theirs)) > 1) if np.isfinite(middle) else "not measured"
        lines.append(dict(zip(shared, key), ratio=middle, low=low, high=high, verdict=judged, different=", ".join(different)))
    found = pd.DataFrame(lines + [dict(zip(shared, key), verdict="new") for key in others])
    if not {"faster", "slower", "as before", "once", "not measured"} & set(found.verdict):
        raise Refused("no cell is in both records")
    found.attrs.update(shared=shared, text=text)
    return found.assign(different=found.get("different", pd.Series("", found.index)).fillna(""))


def same(one, other):
    if one.dtype == object or other.dtype == object:
        return set(one.astype(str)) == set(other.astype(str))
    return set(one.dropna().astype(float)) == set(other.dropna().astype(float))


def text_of(found, before, after, everything):
    """As lines: a cell that has changed each, then how many did what."""
    varied = [c for c in found.attrs["shared"] if found[c].nunique() > 1]
    mine, theirs = (rows.attrs["name"] for rows in (before, after))
    if mine == theirs:
        mine, theirs = (rows.attrs["record"] for rows in (before, after))
    lines = [f"{found.attrs['text']} of {theirs} over {mine}: ratio of medians, 95 %", *made_otherwise(before, after)]
    for name, rows in (("before", before), ("after", after)):
        if rows.attrs["unfinished"]:
            lines.append(f"{name}: UNFINISHED, {rows.attrs['unfinished']}")
        if "alone" in rows and (rows["alone"] == "no").any():
            lines.append(f"{name}: {(rows['alone'] == 'no').sum()} of {len(rows)} rows measured beside other work")
    shown = found if everything else found[~found.verdict.isin(["as before", "once", "not measured"]) | (found.different != "")]
    for row in shown.sort_values("ratio", kind="stable").itertuples():
        cell = ", ".join(filter(None, (value_text(c, numeric(found.at[row.Index, c])) for c in varied))) or "all"
        ratio = f"{number(row.ratio):>6} [{number(row.low)}, {number(row.high)}]" if np.isfinite(row.ratio) else "     -"
        lines.append(f"{row.verdict:<12} {ratio:<24} {cell}" + (f"; different: {row.different}" if row.different else ""))
    lines.append(", ".join(f"{count} {verdict}" for verdict, count in found.verdict.value_counts().items()) +
                 (f"; {(found.different != '').sum()} different" if (found.different != "").any() else "") +
                 f"; geometric mean {geometric(found.ratio)}")
    return "\n".join(lines) + "\n"


def made_otherwise(before, after):
    """A line for all in which the machines that made two records differ, where it moves times."""
    machines = [rows.attrs["machine"] for rows in (before, after)]
    lines = []
    for what, keys in (("TWO MACHINES", ["node", "processor", "cores"]), ("compiled otherwise", ["compiler", "flags"]),
                       ("clocks differ", ["clock"])):
        unlike = [key for key in keys if machines[0].get(key) != machines[1].get(key)]
        if unlike:
            lines.append(f"{what}: " + "; ".join(
                f"{key} {' before, '.join(str(each.get(key, 'unknown')) for each in machines)} after" for key in unlike))
    return lines


def geometric(ratios):
    known = ratios[np.isfinite(ratios) & (ratios > 0)]
    return number(float(f"{np.exp(np.log(known).mean()):.3g}")) if len(known) else "unknown"


def numeric(text):
    try:
        return float(text)
    except ValueError:
        return text
