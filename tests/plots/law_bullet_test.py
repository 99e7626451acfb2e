# SPDX-License-Identifier: BSD-3-Clause
"""The law on heaps: unit costs that are in the times are found again, and every hypothesis is answered."""

import contextlib
import io
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
import pandas as pd
from small_records import small_record

from bvlab_scripts import law_bullet
from bvlab_plots.arguments import exit_status


class LawBullet(unittest.TestCase):
    def test_costs_are_found_again(self):
        random = np.random.default_rng(3)
        rows = pd.DataFrame(random.uniform(100, 1000, (40, 3)), columns=law_bullet.COSTS)
        rows["time_ns"] = rows[law_bullet.COSTS].to_numpy() @ [3, 2, 40]
        np.testing.assert_allclose(law_bullet.unit_costs(rows), [3, 2, 40], rtol=1e-6)

    def test_a_record_is_judged(self):
        keep = dict(seed=2, volume=["sphere"], setting=["wander, 0.002 / 0.2", "planner", "pile"])
        with tempfile.TemporaryDirectory() as folder:
            record = Path(small_record("law-unseen", Path(folder) / "record", keep, {}, None))
            rows = pd.read_csv(record / "law-unseen.csv")
            rows.assign(time_ns=np.nan).to_csv(record / "law-unseen.csv", index=False)
            with contextlib.redirect_stderr(io.StringIO()), mock.patch.object(sys, "argv", ["law_bullet.py", str(record)]):
                self.assertEqual(exit_status(law_bullet.main), 2, "counts alone are refused")
            rows["time_ns"] = (rows[law_bullet.COSTS].to_numpy() @ [3, 2, 40]).astype(int)
            rows.to_csv(record / "law-unseen.csv", index=False)
            said = io.StringIO()
            with mock.patch.object(sys, "argv", ["law_bullet.py", str(record)]), contextlib.redirect_stdout(said):
                self.assertEqual(exit_status(law_bullet.main), 0)
        for number in range(1, 6):
            self.assertRegex(said.getvalue(), rf"\n  {number}: (holds|fails): \d")
        self.assertIn("time   prefix", said.getvalue())


if __name__ == "__main__":
    unittest.main()
