# SPDX-License-Identifier: BSD-3-Clause
"""Every notebook runs from its first cell to its last; what it shows is left in build/notebooks, for the report."""

import os
import subprocess
import sys
import unittest
from pathlib import Path

import bvlab

NOTEBOOKS = Path(os.environ["BVLAB_SOURCE"]) / "experiments" / "python" / "notebooks"
OUT = Path(os.environ["BVLAB_SOURCE"]) / "build" / "notebooks"


class Notebooks(unittest.TestCase):
    @unittest.skipUnless("recursive-both" in bvlab.strategies(), "a build of few strategies: there is no predict")
    def test_they_run(self):
        notebooks = sorted(NOTEBOOKS.glob("*.ipynb"))
        self.assertEqual(len(notebooks), 3)
        environment = {name: value for name, value in os.environ.items() if name != "MPLBACKEND"}
        done = subprocess.run([sys.executable, "-m", "nbconvert", "--execute", "--to", "html", "--log-level", "ERROR",
                               "--ExecutePreprocessor.kernel_name=python3", "--ExecutePreprocessor.timeout=300",
                               "--output-dir", str(OUT), *map(str, notebooks)], capture_output=True, text=True,
                              env=environment)
        self.assertEqual(done.returncode, 0, done.stderr[-3000:])
        for each in notebooks:
            page = (OUT / f"{each.stem}.html").read_text()
            self.assertIn("data:image/png", page.replace("image/png;base64", "data:image/png"), each.name)

    def test_nothing_is_kept_that_they_showed(self):
        import json
        for each in NOTEBOOKS.glob("*.ipynb"):
            for cell in json.loads(each.read_text())["cells"]:
                self.assertFalse(cell.get("outputs"), each.name)
                self.assertIsNone(cell.get("execution_count"), each.name)


if __name__ == "__main__":
    unittest.main()
