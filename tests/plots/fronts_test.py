# SPDX-License-Identifier: BSD-3-Clause
"""fronts finds thresholds, worths and judgements that are known."""

import itertools
import subprocess
import tempfile
import unittest
from pathlib import Path

import pandas as pd
from drawing import PLOTS

from bvlab_scripts import fronts


def times(breaks_even, margins_below=2.0):
    """Times in which every frontless way takes 100 ns, a list 120, and margins 50 where at least so much survives, else 100 times `margins_below`."""
    rows = []
    for query, engine, mesh, share in itertools.product(fronts.QUERIES, [fronts.BINARY, "siblings"], ["bunny", "knot"], [0.1, 0.3, 0.5, 0.7, 0.9, 0.99]):
        row = dict.fromkeys(fronts.STRATEGIES, 120.0) | dict.fromkeys(fronts.FRONTLESS, 100.0)
        row["margins"] = 50.0 if share >= breaks_even else 100 * margins_below
        rows.append(dict(query=query, engine=engine, mesh=mesh, polygons=500, degrees=10 * (1 - share), survival=share) | row)
    return pd.DataFrame(rows).set_index([*fronts.CELL, "survival"]).rename_axis(columns="strategy")


class Fronts(unittest.TestCase):
    def test_thresholds_lie_where_margins_break_even(self):
        for breaks_even, between in ((0.9, (0.7, 0.9)), (0.3, (0.1, 0.3)), (1.5, (0.99, 2)), (0, (-1, 0.1))):
            for limit in fronts.thresholds(times(breaks_even)).values():
                self.assertTrue(between[0] < limit <= between[1], (breaks_even, limit))

    def test_worths(self):
        worth = fronts.worth(times(0.9), ["margins"])
        self.assertEqual(set(worth[fronts.survivals(worth) >= 0.9]), {2.0})
        self.assertEqual(set(worth[fronts.survivals(worth) < 0.9]), {0.5})

    def test_what_the_rule_loses(self):
        time = times(0.9)
        self.assertEqual(set(fronts.rule_off(time)), {1.0})
        # One threshold cannot follow margins that pay below it, too.
        time.loc[(fronts.survivals(time) == 0.3), "margins"] = 80.0
        lost = fronts.rule_off(time)
        self.assertEqual(set(lost[fronts.survivals(lost) == 0.3]), {1.25})

    def test_degrees_at_a_survival(self):
        # 0.5 and 0.7 survive at 5 and 3 degrees; between them degrees grow as their logarithm.
        self.assertAlmostEqual(fronts.degrees_at(times(0.9), "touching", 500, 0.6), (5 * 3) ** 0.5)

    def test_what_is_no_record_of_its_own(self):
        with tempfile.TemporaryDirectory() as folder:
            for record in (Path(folder) / "none", Path(folder)):
                done = subprocess.run([PLOTS / "script", "fronts", record], capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 2)
                self.assertRegex(done.stderr, r"\Afronts: [^\n]*\n\Z")


if __name__ == "__main__":
    unittest.main()
