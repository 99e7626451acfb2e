# SPDX-License-Identifier: BSD-3-Clause
"""How coherence relates to speedup: the law, its errors and its opponents, and margins."""

from functools import cache

import numpy as np
import pandas as pd

import law
from quoting import RESULTS, claim, quotes, stated


@cache
def measured(record):
    rows = law.read(record)
    return rows, law.fit_kappa(rows)


def off_by(rows, predicted):
    """|predicted / measured - 1| of each cell of lists."""
    return (pd.Series(predicted, rows.index) / rows.tests_saved - 1).abs()


@quotes("coherence", RESULTS,
        "with &kappa; = {kappa:.2f}, the only constant fitted, the speedup in volume tests to a median of {fitted:.1f} % (95 % of "
        "cells within {fitted_most:.0f} %), and of what was left out {unseen:.1f} % ({unseen_most:.0f} %; for persisting motions "
        "{persisting:.1f} %, median).",
        "&kappa; matters little to these medians (0 gives {zero:.1f} %, 1 gives {one:.1f} %).",
        "The talk's 2n and n give {constant:.0f} %; R and c alone, as if lists stayed as they were, {still:.1f} %. Of the cells in "
        "which at least half of the front is there again 95 % lie within {half:.0f} % of it; where less is, it is off by {less:.0f} % "
        "(median), and says no more than that lists lose.",
        "The lists lose below a survival of the front of {contacts:.2f} (contacts) or {touching:.2f} (touching).")
def relation(record):
    rows, kappa = measured(record)
    lists = rows[rows.strategy.isin(law.LISTS)]
    unseen = ~law.fitted(lists)
    off = off_by(lists, law.predicted(lists, kappa))

    def medians(predicted):
        error = off_by(lists, predicted)
        return [100 * error[~unseen].median(), 100 * error[unseen].median()]
    half = lists.survival >= 0.5
    still = lists.assign(growth=0.0, stillness=1.0)
    claim(rows.mesh.nunique() == 6 and rows.motion.nunique() == 9 and rows.motion_model.nunique() == 3, "six shapes, nine motions, "
          "three motion models")
    claim(rows.strategy.nunique() == 7 and rows.volume.nunique() == 2, "seven strategies, two volumes")
    claim(lists[~half].tests_saved.median() < 1, "lists lose where less than half of the front is there again")
    crossings = {query: law.crossing(rows[rows["query"] == query], "separation-list", "tests_saved")[0]
                 for query in dict.fromkeys(rows["query"])}
    fitted, left_out = (law.errors(rows, kappa)[name] for name in ("fitted", "left out"))
    return {"kappa": kappa, "fitted": 100 * fitted[0], "fitted_most": 100 * fitted[1], "unseen": 100 * left_out[0],
            "unseen_most": 100 * left_out[1], "persisting": 100 * off[lists.motion_model == "all bodies, persisting"].median(),
            "zero": medians(law.predicted(lists, 0)), "one": medians(law.predicted(lists, 1)),
            "constant": 100 * law.constant_errors(rows)[0], "still": medians(law.predicted(still, kappa)),
            "half": 100 * off[half].quantile(0.95), "less": 100 * off[~half].median(), **crossings}


@quotes("coherence", RESULTS,
        "{factor:.2f} m<sup>{power:.2f}</sup> of the recursion's tests for a motion of m leaf sizes a frame, within a factor of "
        "{fitted:.1f} to {unseen:.1f} (medians; 95 %: {fitted_most:.1f} and {unseen_most:.1f}); in time they beat the recursion below "
        "{leaves:.1f} leaf sizes ({misjudged:.0f} % of the cells misjudged by that).")
def margins(record):
    rows, _ = measured(record)
    factor, power = law.fit_margins(rows)
    group = rows[(rows.strategy == "margins") & (rows.leaves > 0)]
    left = np.minimum(1, factor * group.leaves**power)
    off = np.exp(np.abs(np.log(left * group.all_saved)))
    medians = law.margins_errors(rows, (factor, power))
    # Below which motion, not above which survival.
    at, misjudged, _ = law.crossing(rows.assign(survival=-rows.leaves), "margins", "time_saved")
    return {"factor": factor, "power": power, "fitted": medians["fitted"], "unseen": medians["left out"],
            "fitted_most": off[law.fitted(group)].quantile(0.95), "unseen_most": off[~law.fitted(group)].quantile(0.95),
            "leaves": -at, "misjudged": 100 * misjudged}


stated(RESULTS, "the argument's own constants", "(0 gives", "1 gives", "The talk's 2n and n", "(D(a) - D(a-1))")
stated(RESULTS, "a share that is asked about", "(95 % of cells", "95 % lie", "(medians; 95 %:")
