# SPDX-License-Identifier: BSD-3-Clause
"""A value over that of another variant in the same cell."""

import re

import numpy as np
import pandas as pd

from bvlab_plots import records
from bvlab_plots.refused import Refused
from bvlab_plots.selection import BEST, CONDITION, VARIANT, columns_of, has_value, tied


def cell_columns(rows, but):
    """The settings that distinguish cells, but for some."""
    return [column for column in rows.attrs["settings"] if column not in but and rows[column].nunique() > 1]


def base_of(rows, over):
    """The rows that others are set in relation to, and the columns in which these may be others."""
    if over in BEST:
        base = rows[BEST[over](rows)]
        if base.empty:
            raise Refused(f"over {over}: there is none in these rows")
        return base, tied(rows, VARIANT)
    base, names = rows, []
    for part in re.split(r",\s*(?=\w+\s*=)", over):
        match = CONDITION.match(part)
        if not match or match[2] != "=":
            raise Refused(f"over '{over}': name=value, or one of {', '.join(BEST)}")
        columns_of(rows, match[1], "over")
        base, names = base[has_value(base, match[1], match[3], f"over {part.strip()}")], [*names, match[1]]
    ours = base.peer == ""
    return base[ours] if ours.any() and "peer" not in names else base, tied(rows, names)


def denominators(rows, base, keys, best):
    """For each row the base's value where the keys are the same: the median of its repetitions, and of the best the
    least of the cells'."""
    which = keys + ([*cell_columns(rows, {*keys, "variant"}), "variant"] if best else [])
    values = base.groupby(which, dropna=False).value.median() if which else pd.Series([base.value.median()])
    if best:
        values = values.groupby(level=keys).min() if keys else pd.Series([values.min()])
    if not keys:
        return np.full(len(rows), values.iloc[0])
    return rows[keys].merge(values.rename("base").reset_index(), how="left", on=keys).base.to_numpy()


def ratios(rows, over):
    """The rows with `ratio`, their value over that of the base in the same cell, which is the same in all that was set
    but the variant."""
    base, variant = base_of(rows, over)
    cells = cell_columns(rows, variant)
    # A peer has no leaf size and the like: it is compared in the rest.
    peers = rows[rows.peer != ""]
    shared = [c for c in cells if c not in VARIANT and not peers[c].astype(str).isin(["", "nan"]).any()]
    under = pd.Series(np.nan, rows.index)
    for part in (rows[rows.peer == ""], peers):
        keys = shared if over in BEST or part is peers else cells
        under[part.index] = denominators(part, base, keys, over in BEST)
    return over_known(rows, under, f"in cells without {over}", f"over {over}: no cell holds it beside another",
                      f"over {over}")


def over_known(rows, under, without, nowhere, over):
    """The rows with `ratio`, their value over `under`, where that is known and not 0; the others are said."""
    absent, zero = under.isna(), under == 0
    if absent.all():
        raise Refused(nowhere)
    if (absent | zero).all():
        raise Refused(f"{over}: it is 0 in every cell")
    records.say_left_out(rows[absent].variant, without)
    records.say_left_out(rows[zero].variant, f"{over}, which is 0 in their cells")
    return rows.assign(ratio=rows.value / under)[~absent & ~zero]


def ratios_to(rows, others):
    """The rows with `ratio`, their value over the median of another record's in the cell that was set alike."""
    shared = [c for c in rows.attrs["settings"] if c in others.attrs["settings"]]
    keys = [c for c in shared if rows[c].nunique() > 1 or others[c].nunique() > 1 or
            str(rows[c].iloc[0]) != str(others[c].iloc[0])]
    left, right = rows[keys].astype(str), others[keys].astype(str).assign(value=others.value)
    name = others.attrs["name"]
    return over_known(rows, pd.Series(denominators(left, right, keys, False), rows.index), f"in cells that {name} does not have",
                      f"over {name}: no cell is in both records", f"over {name}")
