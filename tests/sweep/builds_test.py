# SPDX-License-Identifier: BSD-3-Clause
"""Several builds, one record: every program has all cells and repetitions, whichever was broken off; and what cannot be."""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

from sweeping import BVLAB, DEFINITION, ROOT

BUILDS = ROOT / "experiments" / "builds"
BOXES = """
name = "small-boxes"
kind = "boxes"
repetitions = 2
[parameters]
frames = 4
sets = "adjacent"
counts = 64
motions = ["drift", "jitter"]
seed = [1, 2]
methods = ["sweep1", "brute-force"]
sorts = ["radix", "comparison"]
reference = "brute-force"
"""


class Builds(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="of builds ")))

    def builds(self, definition, *options):
        path = self.folder / "definition.toml"
        path.write_text(definition)
        return subprocess.run([sys.executable, BUILDS, path, "--record", self.folder / "record", *options],
                              capture_output=True, text=True, check=False)

    def rows(self, name):
        with open(self.folder / "record" / f"{name}.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def test_every_program_has_every_cell(self):
        done = self.builds(DEFINITION, "--rounds", "2", f"first={BVLAB}", f"second={BVLAB}")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = self.rows("small")
        for program in ("first", "second"):
            cells = {(row["seed"], row["density"], row["strategy"], row["repetition"])
                     for row in rows if row["program"] == program}
            self.assertEqual(len(cells), 4 * 2 * 4 * 4)
        self.assertEqual(len(rows), 2 * 4 * 2 * 4 * 4)
        self.assertEqual({row["differing"] for row in rows}, {"0"})
        machine = json.loads((self.folder / "record" / "machine.json").read_text())
        self.assertEqual(set(machine["programs"]), {"first", "second"})
        self.assertIn("flags", machine["programs"]["second"])
        self.assertFalse((self.folder / "record" / "parts").exists())

    def test_a_study_goes_as_a_whole(self):
        done = self.builds(BOXES, f"one={BVLAB}", f"two={BVLAB}")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = self.rows("small-boxes")
        self.assertEqual(len(rows), 2 * (2 * 2 * 4 * 2))
        self.assertEqual({row["differing"] for row in rows}, {"0"})
        self.assertEqual({row["sort"] for row in rows}, {"radix", "comparison"})
        self.assertEqual({row["seed"] for row in rows}, {"1", "2"})

    def test_what_cannot_be_is_one_line(self):
        for options in ([f"a={BVLAB}", f"a={BVLAB}"], ["a=nowhere"], [BVLAB], ["--rounds", "0", f"a={BVLAB}"]):
            done = self.builds(DEFINITION, *options)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertFalse((self.folder / "record" / "small.csv").exists())

    def test_what_a_program_refuses_is_said_in_its_words(self):
        done = self.builds(DEFINITION.replace('"recursive"', '"nothing of the kind"'), f"a={BVLAB}")
        self.assertEqual(done.returncode, 2)
        self.assertIn("nothing of the kind", done.stderr)


if __name__ == "__main__":
    unittest.main()
