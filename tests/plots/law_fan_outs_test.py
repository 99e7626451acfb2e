# SPDX-License-Identifier: BSD-3-Clause
"""The law at every fan-out: what binary trees let expect of others, and every hypothesis is answered."""

import contextlib
import io
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import pandas as pd
from small_records import small_record

from bvlab_plots.arguments import exit_status
from bvlab_plots.refused import Refused
from bvlab_scripts import law_fan_outs


def at_rest(fan_out):
    """100 entries, of which a run opens none, and a recursion that opens 99 pairs."""
    return dict(mesh="torus", motion="rest", query="contacts", volume="obb", strategy="deferred", seed=1, fan_out=fan_out,
                entries=100.0, tests=199.0, growth=0.0, again=100.0)


class LawFanOuts(unittest.TestCase):
    def test_what_binary_trees_let_expect(self):
        source = pd.DataFrame([at_rest(2), {**at_rest(16), "tests": 107.0}])
        expected = law_fan_outs.transferred(source)
        self.assertEqual(expected.tests[0], 199)
        self.assertAlmostEqual(expected.tests[1], 100 * (1 + 0.99 / 15))
        self.assertEqual(list(expected.again), [100, 100])
        grown = law_fan_outs.transferred(source.assign(growth=0.3))
        # 30 entries gained: 30 pairs opened in two tests each, or 2 in sixteen.
        self.assertAlmostEqual(grown.again[0], 160)
        self.assertAlmostEqual(grown.again[1], 132)

    def test_runs_that_are_alike_are_refused(self):
        with self.assertRaises(Refused):
            law_fan_outs.binary_rows(pd.DataFrame([at_rest(2), at_rest(2)]))

    def test_a_record_is_judged(self):
        with tempfile.TemporaryDirectory() as folder:
            record = small_record("law-fan-outs", Path(folder) / "record", dict(seed=2, mesh=2, volume=["obb"]), {}, None)
            said = io.StringIO()
            words = ["law_fan_outs.py", str(record), "--out", folder]
            with mock.patch.object(sys, "argv", words), contextlib.redirect_stdout(said):
                self.assertEqual(exit_status(law_fan_outs.main), 0)
            self.assertTrue(list(Path(folder).glob("law-fan-outs.*")))
        for number in range(1, 8):
            self.assertRegex(said.getvalue(), rf"\n  {number}: (holds|fails): .*\d")
        for fan_out in (2, 4, 8, 16):
            self.assertIn(f"\nF = {fan_out}, half of the binary front survives", said.getvalue())


if __name__ == "__main__":
    unittest.main()
