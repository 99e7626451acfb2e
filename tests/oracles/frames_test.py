# SPDX-License-Identifier: BSD-3-Clause
"""The study of frames, small, by bvlab_frames: every volume in both frames and every fan-out answers as recursion over
binary trees does, and counts what it should. bvlab says who has them."""

import csv
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

DEFINITION = """
name = "few"
kind = "frames"
repetitions = 1
[parameters]
mesh = ["star:200"]
objects = 4
frames = 12
sides = [1.5]
fan_outs = [2, 16]
"""


class Frames(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        (self.folder / "few.toml").write_text(DEFINITION)

    def run_by(self, program):
        return subprocess.run([os.environ[program], "run", self.folder / "few.toml", "--record", self.folder / "few"],
                              capture_output=True, text=True, check=False)

    def test_every_volume_in_both_frames(self):
        done = self.run_by("BVLAB_FRAMES")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.folder / "few" / "few.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        listed = subprocess.run([os.environ["BVLAB"], "list", "volumes"], capture_output=True, text=True, check=True)
        volumes = {line.split()[0] for line in listed.stdout.splitlines() if line.strip()}
        self.assertEqual({(row["volume"], row["frame"], row["fan_out"]) for row in rows},
                         {(v, f, n) for v in volumes for f in ("relative", "world") for n in ("2", "16")})
        for row in rows:
            self.assertEqual(row["differing"], "0", row)
            self.assertGreater(int(row["touching"]), 0)
            self.assertGreater(int(row["n_v"]), int(row["n_p"]))
            for cost in ("pose_ns", "test_ns", "begin_ns", "time_ns"):
                self.assertGreater(float(row[cost]), 0, row)
            self.assertGreater(int(row["n_u"]), 0)

    def test_bvlab_says_who_has_them(self):
        done = self.run_by("BVLAB")
        self.assertEqual(done.returncode, 2)
        self.assertIn("bvlab_frames", done.stderr)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1)


if __name__ == "__main__":
    unittest.main()
