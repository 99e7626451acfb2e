# SPDX-License-Identifier: BSD-3-Clause
"""The law on what it has not seen: its errors, its opponents, and where it fails."""

import numpy as np

from bvlab_scripts import law_bullet
from bvlab_scripts import law_unseen
from bvlab_scripts.law_unseen import ALONE, FULL, ITSELF, LAST, LATER, LAW, OTHERS, PREFIX, REGRESSION
from quoting import Interval, claim, quotes


@quotes("law-unseen")
def unseen(record):
    fit = law_unseen.fit_of_coherence()
    runs = law_unseen.read(record)
    said = law_unseen.all_predictions(runs, fit)
    rows, everywhere = runs.measured, np.full(len(runs.measured), True)
    regimes = law_unseen.regimes(runs)

    def off(name, source=PREFIX, where=everywhere, share=0.5):
        return 100 * np.quantile(law_unseen.off_by(said[source][name], runs)[where], share)

    def interval(name, where=everywhere):
        return law_unseen.middle_and_most(law_unseen.off_by(said[PREFIX][name], runs)[where], rows.seed.to_numpy()[where])[0][1:]
    easy, pile, less = (regimes[name] for name in ("half or more, not persisting", "model: pile", "survival: less than half"))
    claim(rows.setting.nunique() == 12 and rows.seed.nunique() == 5, "twelve settings, five seeds")
    claim(runs.totals.strategy.nunique() == 6, "six strategies")
    claim(off(LAW, where=pile) == max(off(LAW, where=mask) for name, mask in regimes.items() if name.startswith("model")),
          "the law is worst in the pile")
    nearest = [law_unseen.off_by(said[PREFIX][name], runs)[easy] for name in (LAW, LAST)]
    low, high = law_unseen.drawn_difference(*nearest, rows.seed.to_numpy()[easy], np.median)
    claim(low < 0 < high, "the law and last run's cost differ by less than seeds vary")
    claim(interval(LAW, easy)[0] < off(LAST, where=easy) < interval(LAW, easy)[1], "last run's cost is as good there")
    claim(min(off(name) for name in (ALONE, REGRESSION, FULL, LAST, LATER)) > interval(LAW)[1], "opponents are worse")

    def right(name, source):
        return 100 * (law_unseen.choices(runs, {name: said[source][name]})[name] <= 1.1).mean()
    shown = {"the formula": off(LAW), "the same, &kappa; = 0": off("kappa 0"), "the same, &kappa; = 1": off("kappa 1"), "R and c alone": off(ALONE),
             "regressions": Interval([off(REGRESSION), off(FULL)]), "the speedup measured in the 20 frames": off(LAST)}
    return {"rows": [[name, format(value, ".1f")] for name, value in shown.items()], "law": off(LAW),
            "interval": Interval(interval(LAW)), "most": off(LAW, share=0.95), "last": off(LAST),
            "easy": off(LAW, where=easy), "easy_most": off(LAW, where=easy, share=0.95), "easy_last": off(LAST, where=easy),
            "pile": off(LAW, where=pile), "pile_itself": off(LAW, ITSELF, pile), "less": off(LAW, where=less),
            "less_alone": off(ALONE, where=less), "persisting": off(LAW, where=regimes["walks that persist"]),
            "walks": off(LAW, where=regimes["walks that do not"]), "others": off(LAW, OTHERS), "others_last": off(LAST, OTHERS),
            "others_last_most": off(LAST, OTHERS, share=0.95), "right": right(LAW, PREFIX), "right_last": right(LAST, PREFIX),
            "right_others": right(LAST, OTHERS), "beyond": law_unseen.best_of_all(runs).median(),
            "held": [number for number, holds, _ in law_unseen.hypotheses(runs, said, fit) if holds]}


@quotes("law-bullet")
def heaps(record):
    runs = law_bullet.read(record)
    said = law_unseen.all_predictions(runs, law_unseen.fit_of_coherence())
    timed = law_bullet.times(record, runs, said)

    def off(name, source=PREFIX):
        return 100 * np.median(law_unseen.off_by(said[source][name], runs))
    right = law_unseen.choices(runs, {LAW: said[PREFIX][LAW]})[LAW] <= 1.1
    held = [number for number, holds, _ in law_bullet.hypotheses(runs, said, timed) if holds]
    return {"law": off(LAW), "last": off(LAST), "alone": off(ALONE), "time": 100 * np.median(law_bullet.off(timed[LAW], timed.measured)),
            "last_time": 100 * np.median(law_bullet.off(timed[LAST], timed.measured)), "others": off(LAST, OTHERS),
            "right": 100 * right.mean(), "held": held}
