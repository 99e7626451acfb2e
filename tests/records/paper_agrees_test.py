# SPDX-License-Identifier: BSD-3-Clause
"""README.md, results.md and the paper quote the same numbers: two pieces of code that read the same records agree."""

import contextlib
import io
import sys
import unittest

from repository import ROOT

import quoting
from quotes import boxes, costs, hierarchies, nine_bunnies, relation, stability, strategies
from quoting import Interval

sys.path.insert(0, str(ROOT / "paper"))
import generate  # noqa: E402

# What the paper calls it; the quotes that have it, of which records; their name for it, and by what they multiply it.
# An interval is nameLeast and nameMost there, a list two names.
SAME = [
    ("publishedList", nine_bunnies.speedups, "published_list", 1), ("publishedDeferred", nine_bunnies.speedups, "published_deferred", 1),
    ("oneBodyList", nine_bunnies.speedups, "list", 1), ("oneBodyDeferred", nine_bunnies.speedups, "deferred", 1),
    ("bunniesFrames", nine_bunnies.speedups, "frames", 1),
    ("lawKappa", relation.relation, "kappa", 1), ("lawErrorFitted", relation.relation, "fitted", 100),
    ("lawErrorLeftOut", relation.relation, "unseen", 100), ("lawErrorPersisting", relation.relation, "persisting", 100),
    ("lawTailFitted", relation.relation, "fitted_most", 100), ("lawTailLeftOut", relation.relation, "unseen_most", 100),
    ("lawTailKept", relation.relation, "half", 100), ("lawErrorLost", relation.relation, "less", 100),
    ("aloneErrorFitted aloneErrorLeftOut", relation.relation, "still", 100),
    ("crossingContactsTests", relation.relation, "contacts", 1), ("crossingTouchingTests", relation.relation, "touching", 1),
    ("marginsFactor", relation.margins, "factor", 1), ("marginsPower", relation.margins, "power", 1),
    ("marginsFitted", relation.margins, "fitted", 1), ("marginsTailFitted", relation.margins, "fitted_most", 1),
    ("marginsLeftOut", relation.margins, "unseen", 1), ("marginsTailLeftOut", relation.margins, "unseen_most", 1),
    ("rebuildsRaiseContacts", strategies.best_rebuilds, "raise_contacts", 1),
    ("rebuildsRaiseTouching", strategies.best_rebuilds, "raise_touching", 1),
    ("rebuildsCostContacts", strategies.best_rebuilds, "cost_contacts", 1),
    ("rebuildsCostTouching", strategies.best_rebuilds, "cost_touching", 1),
    ("tightnessRootLeast", hierarchies.tightness, "top", 1), ("tightnessLeafLeast", hierarchies.tightness, "leaves", 1),
    ("fitsBottomUp", hierarchies.fits, "clustering", 1), ("fitsAreaLeast", hierarchies.fits, "sah_least", 1),
    ("fitsAreaMost", hierarchies.fits, "sah_most", 1), ("posingHull", hierarchies.posing, "hull", 100),
    ("firstLater", hierarchies.best_of_ours, "most", 1), ("firstAll", hierarchies.best_of_ours, "most_with_first", 1),
    ("costTriangle", costs.cost, "triangle", 1), ("costSphere", costs.cost, "test_least", 1),
    ("costPredicted", costs.cost, "inner", 1), ("costRest", costs.cost, "left", 1),
    ("errorTenthSaves", costs.distance_error, "saved", 1),
    ("stabilityExactAnswers", stability.stability, "exact", 1), ("stabilityDoubleWrong", stability.stability, "float64", 1),
    ("stabilitySingleWrong", stability.stability, "float32", 1), ("stabilityLevels", stability.stability, "levels", 1),
    ("stillBest", boxes.every_peer, "times", 1), ("startingOverMost", boxes.displacement, "over most", 1),
]
RECORDS = {nine_bunnies.speedups: "nine-bunnies", relation.relation: "coherence", relation.margins: "coherence",
           strategies.best_rebuilds: "best-rebuilds", hierarchies.tightness: "tightness", hierarchies.fits: "fits",
           hierarchies.posing: "posing", hierarchies.best_of_ours: "hierarchies", costs.cost: "cost-model",
           costs.distance_error: "distance-error", stability.stability: "stability-map", boxes.every_peer: "boxes-peers",
           boxes.displacement: "boxes-displacement"}


class Agreement(unittest.TestCase):
    @unittest.skipUnless(hasattr(generate, "numbers_of"), "the paper does not tell its numbers")
    def test_pages_and_paper_agree(self):
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            paper = generate.numbers_of(quoting.RECORDS)
            ours = {function: function(quoting.record_of(name)) for function, name in RECORDS.items()}
        for name, function, key, factor in SAME:
            key, _, part = key.partition(" ")
            value = ours[function][key]
            if part:
                pairs = [(name, value.most)]
            elif isinstance(value, Interval):
                pairs = [(f"{name}Least", value.least), (f"{name}Most", value.most)]
            else:
                pairs = list(zip(name.split(), value if isinstance(value, list) else [value]))
            for macro, number in pairs:
                with self.subTest(macro):
                    self.assertAlmostEqual(float(paper[macro]) * factor / number, 1, places=2)


if __name__ == "__main__":
    unittest.main()
