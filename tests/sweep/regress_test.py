# SPDX-License-Identifier: BSD-3-Clause
"""experiments/regress: a program beside itself is as fast and answers alike; one that answers otherwise is marked."""

import os
import pathlib
import subprocess
import tempfile
import unittest

REGRESS = pathlib.Path(__file__).resolve().parents[2] / "experiments" / "regress"
BVLAB = os.environ["BVLAB"]
# The program, but that one verdict of each replay is another.
LIAR = """#!/usr/bin/python3
import subprocess, sys
done = subprocess.run([{bvlab!r}, *sys.argv[1:]])
if sys.argv[1] == "replay":
    out = sys.argv[sys.argv.index("--out") + 1]
    with open(out, "r+b") as file:
        file.seek(-1, 2)
        last = file.read(1)[0]
        file.seek(-1, 2)
        file.write(bytes([last ^ 1]))
sys.exit(done.returncode)
"""

# Counts a million instructions of whatever it runs.
VALGRIND = """#!/bin/sh
shift 2
echo "==1== Collected : 1000000" >&2
exec "$@"
"""


def run(*words, **environment):
    return subprocess.run([REGRESS, *map(str, words)], capture_output=True, text=True, check=False,
                          env=os.environ | environment)


class Regress(unittest.TestCase):
    def test_beside_itself(self):
        done = run("--programs", BVLAB, BVLAB, "--small", "--rounds", 1, "--limit", 10000)
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [line for line in done.stdout.splitlines() if line.startswith(("nine", "boxes", "worlds"))]
        self.assertGreaterEqual(len(rows), 4)
        self.assertNotIn("DIFFER", done.stdout)

    def test_other_answers(self):
        with tempfile.TemporaryDirectory() as folder:
            liar = pathlib.Path(folder) / "liar"
            liar.write_text(LIAR.format(bvlab=BVLAB))
            liar.chmod(0o755)
            done = run("--programs", BVLAB, liar, "--small", "--rounds", 1, "--limit", 10000)
        self.assertEqual(done.returncode, 1, done.stderr)
        for line in done.stdout.splitlines():
            if line.startswith(("nine", "boxes", "worlds")):
                self.assertEqual("ANSWERS DIFFER" in line, line.startswith("nine"), line)

    def test_instructions(self):
        with tempfile.TemporaryDirectory() as folder:
            valgrind = pathlib.Path(folder) / "valgrind"
            valgrind.write_text(VALGRIND)
            valgrind.chmod(0o755)
            done = run("--programs", BVLAB, BVLAB, "--small", "--instructions", PATH=f"{folder}:{os.environ['PATH']}")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [line.split() for line in done.stdout.splitlines() if line.startswith(("nine", "boxes", "worlds"))]
        self.assertGreaterEqual(len(rows), 4)
        for row in rows:
            self.assertEqual(row[-3:], ["1.000", "1.000", "1.000"], row)

    def test_refused(self):
        for words, said in ((["no-such-commit"], "no such commit"), (["--rounds", "0"], "--rounds"),
                            (["--programs", "/", "/"], "no program"), (["--programs", BVLAB, BVLAB, "HEAD"], "--programs"),
                            (["--limit", "x"], "--limit")):
            done = run(*words)
            self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), (words, done.stderr))
            self.assertIn(said, done.stderr)


if __name__ == "__main__":
    unittest.main()
