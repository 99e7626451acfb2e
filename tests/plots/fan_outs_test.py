# SPDX-License-Identifier: BSD-3-Clause
"""fan_outs judges its hypotheses by numbers that are known."""

import itertools
import subprocess
import tempfile
import unittest
from pathlib import Path

import pandas as pd
from drawing import PLOTS

from bvlab_scripts import fan_outs


def cells(list_at_rest):
    """A record in which recursion makes 1000 F / (F - 1) tests and a list at rest 1000, all others as many as recursion."""
    rows = []
    for motion, volume, fan_out, frame in itertools.product(
            ["rest", fan_outs.SLOW, "0.003 / 0.3", *fan_outs.FAST], ["sphere", "obb", "kdop14", "rss"], [2, 4, 8, 16], ["world", "body"]):
        recursion = 1000 * fan_out / (fan_out - 1)
        for strategy in ["recursive", *fan_outs.KEEPING]:
            tests = list_at_rest if motion == "rest" and strategy == "separation-list" else recursion
            rows.append(dict(mesh="bunny", motion=motion, volume=volume, fan_out=fan_out, frame=frame, strategy=strategy, n_v=tests,
                             time_ns=tests, entries=list_at_rest, pairs=1))
    return pd.DataFrame(rows).set_index([*fan_outs.CELL, "strategy"])


class FanOuts(unittest.TestCase):
    def test_known_ratios(self):
        rest = fan_outs.at_rest(cells(1000)).groupby("fan_out").first()
        for fan_out, ratio in rest.items():
            self.assertAlmostEqual(ratio, fan_out / (fan_out - 1))

    def test_judgements(self):
        found = {number: holds for number, holds, _ in fan_outs.judged(cells(1000))}
        # What saves nothing does not hold where savings are expected, and does where none are.
        self.assertEqual(found, {1: True, 2: False, 3: True, 4: True, 5: False, 6: True, 7: False})
        self.assertFalse(next(fan_outs.judged(cells(500)))[1])

    def test_within_a_third_is_within_a_third(self):
        for gain, holds in ((0.65, False), (0.7, True), (1.3, True), (1.4, False)):
            table = cells(1000)
            here = (table.index.get_level_values("strategy") == "margins") & (table.index.get_level_values("fan_out") == 16)
            table.loc[here, "n_v"] /= gain
            self.assertEqual({number: found for number, found, _ in fan_outs.judged(table)}[4], holds, gain)

    def test_what_is_no_record_of_its_own(self):
        with tempfile.TemporaryDirectory() as folder:
            for record in (Path(folder) / "none", Path(folder)):
                done = subprocess.run([PLOTS / "script", "fan-outs", record], capture_output=True, text=True)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertRegex(done.stderr, r"\Afan-outs: [^\n]*\n\Z")


if __name__ == "__main__":
    unittest.main()
