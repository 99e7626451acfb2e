# SPDX-License-Identifier: BSD-3-Clause
"""`cmake --install` and `pip install .` both give a module that works where it is, without the source tree's paths."""

import importlib.util
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

BUILD, SOURCE = Path(os.environ["BVLAB_BUILD"]), Path(os.environ["BVLAB_SOURCE"])
USE = """
import bvlab, sys
assert bvlab.__file__.startswith(sys.argv[1]), bvlab.__file__
mesh = bvlab.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
assert bvlab.replay(mesh, [[[0, 0, 0, 1, 0, 0, 0]] * 2]).answers.tolist() == [[1]]
try:
    import pandas, matplotlib
except ImportError:
    sys.exit()
assert bvlab.figures(sys.argv[2])
"""


class Installed(unittest.TestCase):
    def works(self, folder):
        environment = {**os.environ, "PYTHONPATH": str(folder)}
        done = subprocess.run([sys.executable, "-c", USE, str(folder), str(SOURCE / "experiments/record/talk")],
                              env=environment, cwd="/", capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_cmake(self):
        with tempfile.TemporaryDirectory() as prefix:
            subprocess.run(["cmake", "--install", str(BUILD), "--component", "python", "--prefix", prefix], check=True,
                           stdout=subprocess.DEVNULL)
            self.works(next(Path(prefix).glob("lib/python*/site-packages")))

    @unittest.skipUnless(importlib.util.find_spec("pip"), "pip is missing")
    @unittest.skipUnless(BUILD == SOURCE / "build" / "release", "pip builds in build/release")
    def test_pip(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, "-m", "pip", "install", str(SOURCE), "--no-build-isolation",
                                   "--no-deps", "--no-index", "--target", folder], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.works(folder)


if __name__ == "__main__":
    unittest.main()
