# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of experiments/sweep stand on: a definition, a program that keeps a diary, and records to compare."""

import contextlib
import csv
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SWEEP = ROOT / "experiments" / "sweep"
BVLAB = os.environ.get("BVLAB", str(ROOT / "build/release/bvlab"))
TIMES = ["time_ns", "first_ns", "build_ns", "alone", "wall_per_processor"]
PARTS = 6

# Names that need quotes, a series, coherence, and more than one repetition.
DEFINITION = """
name = "small"
repetitions = 2
measures = ["coherence"]
[parameters]
mesh = "torus"
polygons = 200
objects = 4
frames = 60
[[axis]]
name = "seed"
values = [1, 2, 3, 4]
[[axis]]
name = "density"
[[axis.value]]
name = "dense, of course"
side = "2body"
[[axis.value]]
name = "\\"sparse\\""
side = "6body"
[[axis]]
name = "strategy"
values = ["recursive", "deferred", "by-cost", "adaptive"]
[series]
density = "dense, of course"
"""

# Writes down when which part was run, and stays a while where it is told to, so that it can be killed.
DIARY = """#!/usr/bin/env bash
set -u
part=$(sed -n 's|.*--part \\([0-9]*\\)/.*|\\1|p' <<<"$*")
[ -n "$part" ] || exec "{bvlab}" "$@"
echo "begins $part $(date +%s.%N)" >>"{folder}/diary"
if [ -e "{folder}/fails-$part" ]; then
  rm "{folder}/fails-$part"
  kill -9 $$
fi
"{bvlab}" "$@"
status=$?
sleep "$(cat "{folder}/lasts" 2>/dev/null || echo 0)"
echo "ends $part $(date +%s.%N)" >>"{folder}/diary"
exit $status
"""


def skip(why):
    print(f"skipped: {why}")
    sys.exit(77)


class SweepTest(unittest.TestCase):
    """Each test has a folder of its own, in which the sweep runs."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="bvlab sweep-", ignore_cleanup_errors=True)
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        (self.folder / "small.toml").write_text(DEFINITION)
        program = self.folder / "diarist"
        program.write_text(DIARY.format(bvlab=BVLAB, folder=self.folder))
        program.chmod(0o755)

    def command(self, *more):
        words = [SWEEP, "small.toml", "--record", "swept", "--parts", PARTS, "--bvlab", "diarist", "--progress", 100000, *more]
        return list(map(str, words))

    def sweep(self, *more):
        done = subprocess.run(self.command(*more), cwd=self.folder, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "swept\n", ""))

    def begin(self, *more):
        self.process = subprocess.Popen(self.command(*more), cwd=self.folder, start_new_session=True,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        return self.process

    def diary(self, word):
        path = self.folder / "diary"
        lines = path.read_text().splitlines() if path.exists() else []
        return [(int(line.split()[1]), float(line.split()[2])) for line in lines if line.startswith(word)]

    def finished(self):
        return sorted(int(path.parent.name) for path in self.folder.glob("swept/parts/*/finished"))

    def wait_for(self, condition, seconds=300):
        """While the sweep that was begun is at work."""
        end = time.monotonic() + seconds
        while not condition():
            if self.process.poll() is not None:
                self.fail(f"the sweep ended: {self.process.communicate()}")
            self.assertLess(time.monotonic(), end, "nothing happened")
            time.sleep(0.05)

    def kill(self, process):
        """It and its engine, at once."""
        children = subprocess.run(["ps", "-o", "pgid=", "--ppid", str(process.pid)], capture_output=True, text=True)
        for group in {process.pid, *map(int, children.stdout.split())}:
            with contextlib.suppress(ProcessLookupError):  # its guard may have been faster
                os.killpg(group, signal.SIGKILL)
        process.communicate()

    def run_whole(self, *more):
        subprocess.run([BVLAB, "run", "small.toml", "--record", "whole", *more], cwd=self.folder, check=True,
                       stdout=subprocess.DEVNULL)

    def rows(self, record, *but):
        with open(self.folder / record / "small.csv", newline="", encoding="utf-8") as file:
            return [{key: value for key, value in row.items() if key not in but} for row in csv.DictReader(file)]

    def assert_same_record(self, timed):
        """Rows in the same order, to the digit, but for times; and no other files."""
        names = [{path.name for path in (self.folder / record).iterdir()} for record in ("whole", "swept")]
        self.assertEqual(*names)
        for table in ("small.frames.csv", "small.coherence.csv", "definition.toml"):
            texts = [(self.folder / record / table).read_bytes() for record in ("whole", "swept")]
            self.assertEqual(*texts)
        whole, swept = (self.rows(record, *(TIMES if timed else [])) for record in ("whole", "swept"))
        self.assertEqual(len(whole), 4 * 2 * 4 * (2 if timed else 1))
        self.assertEqual(whole, swept)
        self.assertEqual({row["differing"] for row in swept}, {"0"})
