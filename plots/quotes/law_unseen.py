# SPDX-License-Identifier: BSD-3-Clause
"""The law on what it has not seen: its errors, its opponents, and where it fails."""

import numpy as np

import law_bullet
import law_unseen
from law_unseen import ALONE, FULL, ITSELF, LAST, LATER, LAW, OTHERS, PREFIX, REGRESSION
from quoting import RESULTS, Interval, claim, quotes, stated


@quotes("law-unseen", RESULTS,
        "the law predicts the speedup of the hundred that follow to a median of {law:.1f} % (interval over seeds {interval:.1f}; "
        "95 % of cells within {most:.0f} %). Here &kappa; matters: 0 gives {zero:.1f} %, 1 gives {one:.1f} %. R and c alone give "
        "{alone:.1f} %, regressions {regressions:.0f} %, last run's cost (the speedup measured in these frames) {last:.1f} %.",
        "it is off by {easy:.1f} % (95 %: {easy_most:.0f} %), and last run's cost, at {easy_last:.1f} %, is as good.",
        "It fails in the pile ({pile:.0f} %, and {pile_itself:.0f} % with the inputs of the run itself: bodies fall, meet and come to "
        "rest, and the law knows one rate of growth), where less than half of the front survives ({less:.0f} %; R and c alone {less_alone:.0f} %), "
        "and it is worse where walks persist ({persisting:.1f} %) than where they do not ({walks:.1f} %).",
        "does better by taking the speedup that was measured there ({others_last:.1f} %; 95 %: {others_last_most:.0f} %) than by the law "
        "({others:.1f} %).",
        "the law names the fewest tests, or at most 1.1 times as many, in {right:.0f} % of the cells, last run's cost in "
        "{right_last:.0f} %, and other seeds' in {right_others:.0f} %; but the best of the three makes {beyond:.2f} times (median) "
        "the tests of the best of all six strategies.",
        "Of the eight hypotheses the numbers {held} held",
        "the second by less than seeds vary")
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
    return {"law": off(LAW), "interval": Interval(interval(LAW)), "most": off(LAW, share=0.95), "zero": off("kappa 0"),
            "one": off("kappa 1"), "alone": off(ALONE), "regressions": Interval([off(REGRESSION), off(FULL)]), "last": off(LAST),
            "easy": off(LAW, where=easy), "easy_most": off(LAW, where=easy, share=0.95), "easy_last": off(LAST, where=easy),
            "pile": off(LAW, where=pile), "pile_itself": off(LAW, ITSELF, pile), "less": off(LAW, where=less),
            "less_alone": off(ALONE, where=less), "persisting": off(LAW, where=regimes["walks that persist"]),
            "walks": off(LAW, where=regimes["walks that do not"]), "others": off(LAW, OTHERS), "others_last": off(LAST, OTHERS),
            "others_last_most": off(LAST, OTHERS, share=0.95), "right": right(LAW, PREFIX), "right_last": right(LAST, PREFIX),
            "right_others": right(LAST, OTHERS), "beyond": law_unseen.best_of_all(runs).median(),
            "held": [number for number, holds, _ in law_unseen.hypotheses(runs, said, fit) if holds]}


stated(RESULTS, "what was set before the run", "from the first 20 frames of a run", "at most 1.1 times as many", "Here &kappa; matters: 0",
       "%, 1 gives")
stated(RESULTS, "a share that is asked about", "95 % of cells within", "(95 %:", "; 95 %:")


@quotes("law-bullet", RESULTS,
        "the law from the first frames is off by {law:.1f} % in tests, last run's cost by {last:.1f} % and R and c alone by {alone:.1f} %; in time the law by "
        "{time:.1f} % and last run's cost by {last_time:.1f} %. Other seeds' speedups are off by {others:.1f} %. It names the fewest tests, or at most 1.1 times "
        "as many, in {right:.0f} % of the cells",
        "Of its five hypotheses the numbers {held} held")
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
