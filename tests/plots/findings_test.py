# SPDX-License-Identifier: BSD-3-Clause
"""The sentence that the report says of a record, against rows of which it is known."""

import unittest

import pandas as pd
from drawing import PLOTS  # noqa: F401  (makes plots/ importable)

from bvlab_plots import findings


def rows_of(lines, **settings):
    """Lines of scene, strategy, peer, time."""
    rows = pd.DataFrame(lines, columns=["scene", "strategy", "peer", "frame_ns"])
    rows["variant"] = rows.strategy.where(rows.peer == "", rows.peer)
    rows["differing"] = settings.get("differing", 0)
    rows.attrs.update(kind="", settings=["scene", "strategy", "peer"], units={"frame_ns": "ns"})
    return rows


class Findings(unittest.TestCase):
    def test_best_of_ours_and_of_peers(self):
        rows = rows_of([("a", "raise", "", 10), ("a", "deferred", "", 20), ("a", "", "fcl", 40),
                        ("b", "raise", "", 30), ("b", "deferred", "", 20), ("b", "", "fcl", 60),
                        ("c", "raise", "", 10), ("c", "deferred", "", 20), ("c", "", "fcl", 50)])
        self.assertEqual(findings.sentence_of(rows),
                         "raise has the least time per frame in 2 of 3 settings, deferred in 1; the best peer's is "
                         "4 times our best (median over settings; 3 to 5).")

    def test_wrong_answers_do_not_win(self):
        rows = rows_of([("a", "raise", "", 10), ("a", "deferred", "", 20), ("a", "", "fcl", 5)], differing=[0, 0, 3])
        self.assertEqual(findings.sentence_of(rows), "raise has the least time per frame.")

    def test_nothing_is_said_of_one_variant(self):
        self.assertEqual(findings.sentence_of(rows_of([("a", "raise", "", 10), ("b", "raise", "", 20)])), "")


if __name__ == "__main__":
    unittest.main()
