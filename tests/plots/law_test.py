# SPDX-License-Identifier: BSD-3-Clause
"""The law where its answer is known."""

import unittest
import warnings

import numpy as np
import pandas as pd

from small_records import PLOTS  # noqa: F401  puts plots/ on the path

from bvlab_scripts import law


def runs_of(**changes):
    """Pairs that are always near, whose list takes half of the recursion's tests."""
    given = dict(near_runs=99, tests=9900, again=4950, growth=0.0, stillness=1.0, persistence=0.0, frames=100)
    return pd.DataFrame([{**given, **changes}])


class Law(unittest.TestCase):
    def test_a_still_list_is_rebuilt_every_other_or_every_third_run(self):
        for defer, share in ((0, 3 / 4), (1, 2 / 3)):
            self.assertAlmostEqual(law.list_over_recursion(runs_of(), defer, 0.5)[0], share)

    def test_a_list_that_is_never_still_is_never_rebuilt(self):
        # Straight on, so that no run is a shorter way than the first.
        never = runs_of(stillness=0.0, persistence=1.0)
        self.assertAlmostEqual(law.list_over_recursion(never, 0, 1)[0], (1 + 99 / 2) / 100)

    def test_says_nothing_where_nothing_was_near(self):
        never = pd.concat([runs_of(), runs_of(near_runs=0, tests=0, again=0, growth=np.nan, stillness=np.nan)], ignore_index=True)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            found = law.list_over_recursion(never, 0, 0.5)
        self.assertEqual(np.isnan(found).tolist(), [False, True])


if __name__ == "__main__":
    unittest.main()
