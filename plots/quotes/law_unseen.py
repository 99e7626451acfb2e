# SPDX-License-Identifier: BSD-3-Clause
"""The law on what it has not seen: its errors, its opponents, and where it fails."""

import numpy as np

from bvlab_plots.hypotheses import told
from bvlab_scripts import law_bullet
from bvlab_scripts import law_fan_outs
from bvlab_scripts import law_unseen
from bvlab_scripts.law_unseen import ALONE, FULL, ITSELF, LAST, LATER, LAW, OTHERS, PREFIX, REGRESSION
from quoting import Interval, claim, quotes

# What the hypotheses of each definition say, in the order of their numbers.
UNSEEN = ["where half of the front survives and walks do not persist, the formula is off by at most 5 %, and in 95 % of the cells by 30 %",
          "where half of the front survives and walks do not persist, opponents are further off than the formula", "the formula is off by more than 5 % where walks persist",
          "the formula is off by more than 20 % where less than half survives", "in the pile first frames are off by more than 20 %, other seeds by less than 10 %",
          "other seeds are a better source than first frames in every motion model",
          "the formula names the best strategy in nine of ten cells, more often than last run's cost", "&kappa; does not depend on the motion models that it is fitted to"]
WIDE = ["at every fan-out the formula is off by at most 5 %", "the error of the formula halves from fan-out 2 to 16",
        "counts from binary trees suffice", "on binary trees opponents are further off",
        "the formula is off by more than 20 % where less than half survives", "the survival below which lists lose rises with the fan-out",
        "&kappa; is the same at every fan-out"]
HEAPS = ["the formula is off by more than 20 % in tests", "the speedup of the preceding frames is off by more than that",
         "the speedup of other seeds is within 10 %", "the formula predicts time better than tests",
         "the formula names the best strategy in less than nine of ten cells"]


@quotes("law-unseen")
def unseen(record):
    fit = law_unseen.fit_of_coherence()
    runs = law_unseen.read(record)
    said = law_unseen.all_predictions(runs, fit)
    rows, everywhere = runs.measured, np.full(len(runs.measured), True)
    regimes = law_unseen.regimes(runs)

    def off(name, source=PREFIX, where=everywhere, share=0.5):
        return runs.off(said[source][name], where, share)

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
            **told(law_unseen.hypotheses(runs, said, fit), UNSEEN)}


@quotes("law-bullet")
def heaps(record):
    runs = law_bullet.read(record)
    said = law_unseen.all_predictions(runs, law_unseen.fit_of_coherence())
    timed = law_bullet.times(record, runs, said)

    def off(name, source=PREFIX):
        return runs.off(said[source][name])
    right = law_unseen.choices(runs, {LAW: said[PREFIX][LAW]})[LAW] <= 1.1
    return {"law": off(LAW), "last": off(LAST), "alone": off(ALONE), "time": 100 * np.median(law_bullet.off(timed[LAW], timed.measured)),
            "last_time": 100 * np.median(law_bullet.off(timed[LAST], timed.measured)), "others": off(LAST, OTHERS),
            "right": 100 * right.mean(), **told(law_bullet.hypotheses(runs, said, timed), HEAPS)}


@quotes("law-fan-outs")
def wide_law(record):
    """The law at fan-outs 2 to 16."""
    fit = law_unseen.fit_of_coherence()
    runs = law_fan_outs.read(record)
    rows, fan_outs = runs.measured, law_fan_outs.fan_outs_of(runs)
    said = law_fan_outs.predictions(runs, fit)
    claim(fan_outs == [2, 4, 8, 16], "fan-outs 2, 4, 8 and 16")
    claim(rows.mesh.nunique() == 4 and rows.motion.nunique() == 5 and rows.seed.nunique() == 5, "four shapes, five motions, five seeds")

    def off(name, fan_out, share=0.5, regime="easy"):
        return runs.off(said[name], law_fan_outs.at(runs, fan_out, regime), share)
    shown = {LAW: "the formula", LAST: "the speedup measured in the 20 frames", law_fan_outs.BINARY: "the formula, from binary trees and F",
             ALONE: "R and c alone", law_fan_outs.SAME: "no change"}
    claim(all(off(LAW, f, 0.95) < off(name, f, 0.95) for f in fan_outs for name in (LAST, LATER, ALONE, law_fan_outs.SAME)),
          "the law's worst cells are the least bad")
    claim(all(off(law_fan_outs.BINARY, f) > 2 * off(LAW, f) for f in fan_outs[1:]), "binary trees and F alone are worse")
    claim(abs(off(LAST, 2) - off(LAW, 2)) < 0.1 and all(off(LAST, f) < off(LAW, f) for f in fan_outs[1:]),
          "in the median the speedup of the first frames predicts as well on binary trees and better on wider ones")
    lose = law_fan_outs.thresholds(runs)
    others = [law_fan_outs.at(runs, f, "less") | law_fan_outs.at(runs, f) for f in fan_outs]
    persisting = [(rows.fan_out == f).to_numpy() & ~other for f, other in zip(fan_outs, others)]
    claim(all(rows.persistence[where].gt(0).all() for where in persisting), "the cells of neither regime are those in which motion persists")
    own = law_fan_outs.own_kappas(runs)
    return {"rows": [[label, *(f"{off(name, f):.1f} ({off(name, f, 0.95):.0f})" for f in fan_outs)] for name, label in shown.items()],
            "law": Interval([off(LAW, f) for f in fan_outs]), "law_two": off(LAW, 2), "law_sixteen": off(LAW, 16),
            "last": Interval([off(LAST, f) for f in fan_outs]), "most": Interval([off(LAW, f, 0.95) for f in fan_outs]),
            "worse": Interval([off(LAST, f, 0.95) / off(LAW, f, 0.95) for f in fan_outs]), "last_most": Interval([off(LAST, f, 0.95) for f in fan_outs]),
            "binary": Interval([off(law_fan_outs.BINARY, f) for f in fan_outs[1:]]), "less": Interval([off(LAW, f, regime="less") for f in fan_outs]),
            "kappa": Interval(list(own.values())), "lose_two": lose[2][0], "lose_wide": Interval([lose[f][0] for f in fan_outs[1:]]),
            "cells": int(law_fan_outs.at(runs, 2).sum()), "less_cells": int(law_fan_outs.at(runs, 2, "less").sum()), **told(law_fan_outs.hypotheses(runs, said, fit.kappa), WIDE),
            "persisting_cells": int(persisting[0].sum()),
            "persisting": Interval([runs.off(said[LAW], where) for where in persisting])}
