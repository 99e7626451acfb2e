# SPDX-License-Identifier: BSD-3-Clause
"""What strategies cost, predicted: how far off, how often the right one is named, and what that costs."""

import numpy as np

from bvlab_plots.hypotheses import told
from bvlab_scripts import predict
from bvlab_scripts.predict import HALF, KEEPING, LESS
from quoting import claim, quotes

# What the hypotheses of the definition say, in the order of their numbers.
HYPOTHESES = ["volume tests of all strategies together are off by less than 5 %", "volume tests of each strategy by itself are off by less than 5 %",
              "triangle tests are off by less than 5 %", "the strategy that is named is within 1.1 of the fastest in nine of ten cells",
              "no strategy that is always taken is within 1.1 more often", "times are off by less than 10 %",
              "lists are predicted too short where less than half survives", "a prediction takes less than two thirds of the time of playing all"]


def cells_of(record):
    return predict.read(record)


@quotes("predict")
def predict_table(record):
    cells = cells_of(record)

    def line(strategies, regime):
        tests = predict.errors(cells, regime=regime, strategies=strategies)
        others = [predict.middle(predict.errors(cells, what, regime, strategies)) for what in ("n_p", "time_ns")]
        return f"{predict.middle(tests):.1f} ({100 * tests.quantile(0.95):.0f}), " + ", ".join(f"{each:.1f}" for each in others)
    names = [*dict.fromkeys(cells.rows.strategy)]
    return {"rows": [[name, *(line([name], regime) for regime in (HALF, LESS))] for name in names]}


@quotes("predict")
def predictions(record):
    cells = cells_of(record)
    rows = cells.rows
    share = {s: predict.near(predict.always(rows, s)) for s in dict.fromkeys(rows.strategy)}
    best = max(share, key=share.get)
    claim(rows.strategy.nunique() == 7, "seven strategies")
    lists = rows[rows.strategy.isin(["separation-list", "deferred"]) & (rows.regime == LESS)]
    claim(predict.off(lists).median() < 0, "lists are predicted too short where less than half survives")
    off = {s: predict.middle(predict.errors(cells, regime=HALF, strategies=[s])) for s in KEEPING}
    claim(max(off, key=off.get) == "margins", "margins are farthest off where half survives")
    claim(all(predict.off(rows[rows.strategy == "recursive"]) == 0), "recursion's counts are exact")
    return {"cells": len(cells.chosen), "settings": rows.setting.nunique(), "half_cells": int((cells.chosen.regime == HALF).sum()),
            "half": predict.middle(predict.errors(cells, regime=HALF)), "less": predict.middle(predict.errors(cells, regime=LESS)),
            "named": predict.near(cells.chosen.times), "worst": cells.chosen.times.max(), "always": share[best], "best": f"`{best}`",
            "taken": 100 * np.median(cells.taken),
            **told(predict.hypotheses(cells), HYPOTHESES)}
