# SPDX-License-Identifier: BSD-3-Clause
"""The tournament: who is fastest, by how much, and how sure that is."""

import unittest

import numpy as np
import pandas as pd
from small_records import PLOTS  # noqa: F401  puts plots/ on the path

from quotes import tournament


def rows(times):
    """`times`: {(method, peer): a number or a function of the seed}, each repetition off by up to 5 %."""
    random = np.random.default_rng(2)
    return pd.DataFrame([
        {"work": "near", "polygons": 500, "seed": seed, "repetition": repetition, "method": method, "peer": peer,
         "ns": (time(seed) if callable(time) else time) * random.uniform(0.95, 1.05)}
        for (method, peer), time in times.items() for seed in range(1, 7) for repetition in range(1, 6)])


class Tournament(unittest.TestCase):
    def test_the_fastest_and_by_how_much(self):
        table = tournament.tournament(rows({("ours", ""): 100, ("A", "a"): 500, ("B", "b"): 300}), "ours", ["A", "B"])
        (line,) = table.itertuples()
        self.assertEqual(line.fastest, "B")
        self.assertAlmostEqual(line.ratio, 3, delta=0.1)
        self.assertLess(line.low, 3)
        self.assertGreater(line.high, 3)
        self.assertLess(line.high - line.low, 0.3)

    def test_seeds_that_differ_widen_the_interval(self):
        def interval(spread):
            table = tournament.tournament(rows({("ours", ""): 100, ("A", "a"): lambda seed: 300 * spread ** (seed % 2)}),
                                          "ours", ["A"])
            return table.high[0] - table.low[0]
        self.assertGreater(interval(3), 3 * interval(1))

    def test_seeds_are_drawn_together(self):
        # Both take longer on some traces: what is drawn is the same trace for both, so that their ratio stays.
        table = tournament.tournament(rows({("ours", ""): lambda seed: 100 * seed, ("A", "a"): lambda seed: 300 * seed}),
                                      "ours", ["A"])
        self.assertLess(table.high[0] - table.low[0], 0.3)

    def test_a_seed_that_one_side_lacks_is_left_out(self):
        runs = rows({("ours", ""): lambda seed: 100 * seed, ("A", "a"): lambda seed: 300 * seed})
        runs = runs[(runs.method == "ours") | (runs.seed != 6)]
        self.assertAlmostEqual(tournament.tournament(runs, "ours", ["A"]).ratio[0], 3, delta=0.1)

    def test_who_answers_otherwise_stays_in_with_the_number(self):
        runs = rows({("ours", ""): 100, ("A", "a"): 300})
        runs["differing"] = np.where(runs.method == "A", runs.seed, 0)
        (line,) = tournament.tournament(runs, "ours", ["A"]).itertuples()
        self.assertEqual((line.fastest, line.differing), ("A", sum(range(1, 7))))

    def test_a_cell_without_peers_is_left_out(self):
        self.assertEqual(len(tournament.tournament(rows({("ours", ""): 100}), "ours", ["A"])), 0)


if __name__ == "__main__":
    unittest.main()
