# SPDX-License-Identifier: BSD-3-Clause
"""The law where its answer is known, and that its test on what it has not seen looks at nothing else."""

import contextlib
import io
import tempfile
import unittest
import warnings
from pathlib import Path

import numpy as np
import pandas as pd

from small_records import small_record

from bvlab_scripts import law, law_unseen
from bvlab_plots import records


def runs_of(**changes):
    """Pairs that are always near, whose list takes half of the recursion's tests."""
    given = dict(near_runs=99, tests=9900, again=4950, growth=0.0, stillness=1.0, persistence=0.0, frames=100)
    return pd.DataFrame([{**given, **changes}])


class Law(unittest.TestCase):
    def test_a_still_list_is_rebuilt_every_other_or_every_third_run(self):
        for defer, share in ((0, 3 / 4), (1, 2 / 3)):
            self.assertAlmostEqual(law.list_over_recursion(runs_of(), defer, 0.5)[0], share)
            self.assertAlmostEqual(law.window_over_recursion(runs_of(), defer, 0.5, 40)[0], share)

    def test_a_list_that_is_never_still_is_never_rebuilt(self):
        # Straight on, so that no run is a shorter way than the first.
        never = runs_of(stillness=0.0, persistence=1.0)
        self.assertAlmostEqual(law.list_over_recursion(never, 0, 1)[0], (1 + 99 / 2) / 100)
        self.assertAlmostEqual(law.window_over_recursion(never, 0, 1, 20)[0], 1 / 2)
        # It gains as much in every run.
        grows = runs_of(stillness=0.0, growth=0.1, persistence=1.0)
        length = 1 + 0.1 * (np.arange(20, 100) - 1)
        self.assertAlmostEqual(law.window_over_recursion(grows, 0, 1, 20)[0], length.mean() / 2, places=2)  # nearly straight on


    def test_says_nothing_where_nothing_was_near(self):
        never = pd.concat([runs_of(), runs_of(near_runs=0, tests=0, again=0, growth=np.nan, stillness=np.nan)], ignore_index=True)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            found = law.list_over_recursion(never, 0, 0.5), law.window_over_recursion(never, 1, 0.5, 40)
        for each in found:
            self.assertEqual(np.isnan(each).tolist(), [False, True])


class Unseen(unittest.TestCase):
    """Nothing that is predicted is known beforehand."""

    def predictions(self, change):
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
            keep = dict(seed=3, volume=["sphere"], query=["contacts"], setting=["wander, 0.02 / 2", "pile"])
            runs = law_unseen.read(small_record("law-unseen", Path(folder) / "record", keep, {}, None, change))
            said = law_unseen.all_predictions(runs, law_unseen.Fit(0.5, *law_unseen.regressed(
                runs.sources[law_unseen.PREFIX], law_unseen.alone(runs.sources[law_unseen.PREFIX]))))
        return runs.measured, said

    def test_a_prediction_does_not_change_with_what_it_predicts(self):
        def other_end(_, rows):
            changed = (rows.seed == rows.seed.min()) & (rows.frames == rows.frames.max())
            for column in {"n_v", "tests", "again", "grown", "kept"} & set(rows):
                rows[column] = rows[column] * np.where(changed & (rows.index % 2 == 0), 3, np.where(changed, 2, 1))
            return rows
        before, said = self.predictions(None)
        after, said_then = self.predictions(other_end)
        own = (before.seed == before.seed.min()).to_numpy()
        self.assertTrue((before.tests_saved != after.tests_saved)[own].any())
        for source in (law_unseen.PREFIX, law_unseen.OTHERS):
            for name, values in said[source].items():
                where = own if source == law_unseen.OTHERS else np.full(len(own), True)
                np.testing.assert_array_equal(values[where], said_then[source][name][where], f"{name}, {source}")
        self.assertFalse(np.array_equal(said[law_unseen.ITSELF][law_unseen.LAW], said_then[law_unseen.ITSELF][law_unseen.LAW]))

    def test_counts_of_a_window_are_what_is_beyond_the_prefix(self):
        before, _ = self.predictions(None)
        self.assertTrue((before.n_v > 0).all() and (before.n_v_recursive > 0).all())
        self.assertTrue(np.isfinite(before.tests_saved).all())

    def test_refuses_a_record_without_prefixes(self):
        with self.assertRaises(records.Refused), contextlib.redirect_stdout(io.StringIO()):
            law_unseen.read(law_unseen.COHERENCE)


if __name__ == "__main__":
    unittest.main()
