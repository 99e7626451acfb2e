# SPDX-License-Identifier: BSD-3-Clause
"""How coherence relates to speedup: the law, its errors and its opponents, and margins."""

from functools import cache

import numpy as np

from bvlab_scripts import law
from quoting import claim, quotes


@cache
def measured(record):
    rows = law.read(record)
    return rows, law.fit_kappa(rows)


@quotes("coherence")
def relation(record):
    rows, kappa = measured(record)
    lists = rows[rows.strategy.isin(law.LISTS)]
    unseen = ~law.fitted(lists)
    off = law.off_by(lists, law.predicted(lists, kappa))

    def medians(predicted):
        return [100 * error.median() for error in law.in_parts(lists, law.off_by(lists, predicted)).values()]
    half = lists.survival >= 0.5
    claim(lists[~unseen].motion.nunique() == 7 and lists[~unseen].mesh.nunique() == lists[~unseen].motion_model.nunique() == 2,
          "the fit sees two shapes, two motion models and seven of the nine motions")
    still = lists.assign(growth=0.0, stillness=1.0)
    claim(rows.mesh.nunique() == 6 and rows.motion.nunique() == 9 and rows.motion_model.nunique() == 3, "six shapes, nine motions, "
          "three motion models")
    claim(rows.strategy.nunique() == 9 and rows.volume.nunique() == 2, "nine strategies, two volumes")
    claim(lists[~half].tests_saved.median() < 1, "lists lose where less than half of the front is there again")
    crossings = {query: law.crossing(rows[rows["query"] == query], "separation-list", "tests_saved")[0]
                 for query in dict.fromkeys(rows["query"])}
    fitted, left_out = law.errors(rows, kappa).values()
    # A still list is rebuilt every other or every third run.
    talk = law.off_by(lists, lists.strategy.map({"separation-list": 4 / 3, "deferred": 3 / 2}))
    opponents = {f"the formula, &kappa; = {kappa:.2f}": [100 * fitted[0], 100 * left_out[0]], "the formula, &kappa; = 0": medians(law.predicted(lists, 0)),
                 "the formula, &kappa; = 1": medians(law.predicted(lists, 1)), "R and c alone, a list that never grows": medians(law.predicted(still, kappa)),
                 "the talk's counts, 2n and n (all cells)": [100 * talk.median()]}
    volumes = lists[(lists["query"] == "contacts") & (lists.strategy == "deferred")].groupby(["motion", "volume"]).tests_saved.median()
    saved = {f"{name}_{volume}": volumes[motion, volume] for name, motion in (("slow", "0.0003 / 0.03"), ("fast", "0.03 / 5")) for volume in ("obb", "sphere")}
    claim(max(saved["fast_obb"], saved["fast_sphere"]) < 1 < min(saved["slow_obb"], saved["slow_sphere"]) and saved["fast_obb"] < saved["fast_sphere"],
          "deferring saves tests with both volumes in slow motion, and loses with both at 5 degrees, more with oriented boxes")
    return {**saved, "rows": [[name, ", ".join(f"{error:.1f}" for error in errors)] for name, errors in opponents.items()], "kappa": kappa,
            "fitted": 100 * fitted[0], "fitted_most": 100 * fitted[1], "unseen": 100 * left_out[0],
            "unseen_most": 100 * left_out[1], "persisting": 100 * off[lists.motion_model == "all bodies, persisting"].median(),
            "half": 100 * off[half].quantile(0.95), "less": 100 * off[~half].median(), **crossings}


@quotes("coherence")
def margins(record):
    rows, _ = measured(record)
    factor, power = law.fit_margins(rows)
    group = rows[(rows.strategy == "margins") & (rows.leaves > 0)]
    left = np.minimum(1, factor * group.leaves**power)
    seen, unseen = law.in_parts(group, np.exp(np.abs(np.log(left * group.all_saved)))).values()
    # Below which motion, not above which survival.
    at, misjudged = law.crossing(rows.assign(survival=-rows.leaves), "margins", "time_saved")
    return {"factor": factor, "power": power, "fitted": seen.median(), "unseen": unseen.median(),
            "fitted_most": seen.quantile(0.95), "unseen_most": unseen.quantile(0.95),
            "leaves": -at, "misjudged": 100 * misjudged}
