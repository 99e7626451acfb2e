# SPDX-License-Identifier: BSD-3-Clause
"""Records as frames, and the figures that plots/draw draws; whoever calls sees nothing of how."""

import os
import subprocess
import sys
import unittest
from pathlib import Path

try:
    import matplotlib
    import pandas
except ImportError:
    raise unittest.SkipTest("pandas or matplotlib is missing") from None

import bvlab

RECORD = Path(os.environ["BVLAB_SOURCE"]) / "experiments" / "record" / "talk"


class Figures(unittest.TestCase):
    def test_frame(self):
        frame = bvlab.record(RECORD)
        self.assertIsInstance(frame, pandas.DataFrame)
        lines = (RECORD / "talk.csv").read_text().splitlines()
        self.assertEqual(len(frame), len(lines) - 1)
        self.assertLessEqual(set(lines[0].split(",")), set(frame))
        self.assertEqual(frame.attrs["name"], "talk")

    def test_figures(self):
        before, settings = set(sys.modules), dict(matplotlib.rcParams)
        drawn = bvlab.figures(RECORD)
        # Names that nobody else has.
        added = {name.split(".")[0] for name in set(sys.modules) - before}
        for name in ("records", "words", "style", "tables", "draw", "charts"):
            self.assertNotIn(name, added)
        self.assertEqual(settings, dict(matplotlib.rcParams))
        self.assertTrue(before)
        self.assertTrue(drawn)
        for name, figure in drawn.items():
            self.assertIsInstance(figure, matplotlib.figure.Figure, name)
            self.assertTrue(figure.axes[0].has_data(), name)
        self.assertEqual(list(bvlab.figures(RECORD)), list(drawn))

    def test_without_a_display(self):
        """A backend that needs a display may be configured; files are drawn without one."""
        code = (f"import bvlab; print(len(bvlab.record({str(RECORD)!r})) * len(bvlab.figures({str(RECORD)!r}))); "
                f"import matplotlib; matplotlib.use('svg'); bvlab.figures({str(RECORD)!r}); "
                "assert matplotlib.get_backend() == 'svg'; bvlab.record('none')")
        environment = {key: value for key, value in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY")}
        done = subprocess.run([sys.executable, "-B", "-c", code], env={**environment, "MPLBACKEND": "TkAgg"},
                              capture_output=True, text=True, check=False)
        self.assertGreater(int(done.stdout), 0, done.stderr)
        self.assertIn("ValueError: none", done.stderr)

    def test_one_figure(self):
        frame = bvlab.record(RECORD)
        setting = next(name for name in frame.attrs["settings"] if frame[name].nunique() > 1)
        others = ", ".join(name for name in frame.attrs["settings"] if name != setting and frame[name].nunique() > 1)
        self.assertEqual(len(bvlab.figures(RECORD, x=setting, pool=others)), 1)

    def test_refusals(self):
        for call in (lambda: bvlab.record("/nowhere"), lambda: bvlab.figures("/nowhere"), lambda: bvlab.record(os.curdir),
                     lambda: bvlab.figures(RECORD, x="no such column"), lambda: bvlab.figures(RECORD, colour="red"),
                     lambda: bvlab.figures("--help")):
            with self.assertRaises(ValueError) as caught:
                call()
            self.assertNotIn("\n", str(caught.exception))


if __name__ == "__main__":
    unittest.main()
