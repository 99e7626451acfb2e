# SPDX-License-Identifier: BSD-3-Clause
"""What is left when bvlab is killed: of a result all or nothing, of a run every part it finished."""

import csv
import os
import random
import signal
import subprocess
import time
import unittest

import numpy as np
from program import BVLAB, TETRAHEDRON, TRIANGLE, ProgramTest

DEFINITION = """
name = "parts"
repetitions = 2
[parameters]
mesh = "torus"
polygons = 200
objects = 4
frames = 300
[[axis]]
name = "seed"
values = [1, 2, 3, 4, 5, 6, 7, 8]
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
values = ["recursive", "deferred"]
[series]
density = "dense, of course"
"""


def rows_of(path):
    if not path.exists():
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


class Results(ProgramTest):
    def start(self, *arguments):
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        return subprocess.Popen([BVLAB, *map(str, arguments)], cwd=self.folder, **quiet)

    def is_writing(self, process):
        """Whether it holds a file open that lies in the folder, under whatever name: not the mesh it reads."""
        try:
            folder = f"/proc/{process.pid}/fd"
            held = [os.readlink(f"{folder}/{number}") for number in os.listdir(folder)]
        except OSError:
            return False
        mesh = str(self.folder / "mesh.off")
        return any(name.startswith(str(self.folder)) and name != mesh for name in held)

    def kill_in_mid_write(self, attempt, *arguments):
        """Whether it was killed with a result half written."""
        with self.start(*arguments) as process:
            end = time.monotonic() + 60
            while process.poll() is None and not self.is_writing(process):
                self.assertLess(time.monotonic(), end)
            time.sleep(0.002 * attempt)
            process.send_signal(signal.SIGSTOP)  # it cannot finish between the look and the kill
            was_writing = self.is_writing(process)
            process.kill()
        return was_writing

    def test_all_or_nothing(self):
        self.write("mesh.off", TRIANGLE)
        arguments = ["scene", "random-walk", "--mesh", "mesh.off", "--objects", 20, "--frames", 50000]
        self.take(*arguments, "--out", "whole.npy")
        whole = (self.folder / "whole.npy").read_bytes()
        (self.folder / "whole.npy").unlink()
        mid_writes = 0
        for attempt in range(8):
            old = b"old" if attempt % 2 else None
            out = self.folder / "out.npy"
            out.unlink(missing_ok=True)
            if old:
                out.write_bytes(old)
            mid_writes += self.kill_in_mid_write(attempt, *arguments, "--out", out)
            left = out.read_bytes() if out.exists() else None
            self.assertTrue(left in (old, whole), "half a result")
            names = {path.name for path in self.folder.iterdir()} - {"mesh.off", "out.npy"}
            self.assertEqual(names, set(), "left behind")
        self.assertGreater(mid_writes, 0, "never killed in mid-write: the test shows nothing")


class Runs(ProgramTest):
    def record(self, name):
        rows = rows_of(self.folder / name / "parts.csv")
        measured = list(rows[0]).index("repetition") + 1 if rows else 0
        keys = [tuple(row.values())[:measured] for row in rows]
        frames = [tuple(row.values()) for row in rows_of(self.folder / name / "parts.frames.csv")]
        return rows, keys, frames

    def setUp(self):
        super().setUp()
        self.write("parts.toml", DEFINITION)

    def test_killed_at_any_moment(self):
        start = time.monotonic()
        self.take("run", "parts.toml", "--record", "undisturbed")
        seconds = time.monotonic() - start
        _, keys, frames = self.record("undisturbed")
        self.assertEqual(len(keys), 8 * 2 * 2 * 2)
        self.assertEqual(len(frames), 8 * 2 * 300)
        self.assertEqual(len(set(keys)), len(keys))
        chance = random.Random(20260101)
        killed, before = 0, []
        command = [BVLAB, "run", "parts.toml", "--record", "killed"]
        for attempt in range(60):
            quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE, "text": True}
            process = subprocess.Popen(command, cwd=self.folder, **quiet)
            if attempt >= 50:  # enough of killing
                process.wait()
            try:
                process.wait(timeout=chance.uniform(0, seconds / 4))
            except subprocess.TimeoutExpired:
                process.kill()
            complaint = process.communicate()[1]
            self.assertEqual(complaint, "")
            rows = self.record("killed")[0]
            # What was finished stands as it stood, times and all: it has not been run again.
            known = {tuple(row.items()) for row in rows}
            self.assertEqual([row for row in before if tuple(row.items()) not in known], [])
            before = rows
            if process.returncode == 0:
                break
            killed += 1
        self.assertEqual(process.returncode, 0)
        self.assertGreater(killed, 2)
        _, keys_after, frames_after = self.record("killed")
        # Rows stand as in a run that was never killed but for the order within a repetition, which is drawn.
        self.assertEqual(sorted(keys_after), sorted(keys))
        self.assertEqual([(key[0], key[-1]) for key in keys_after], [(key[0], key[-1]) for key in keys])
        self.assertEqual(frames_after, frames)
        names = {path.name for path in (self.folder / "killed").iterdir()}
        self.assertEqual(names, {path.name for path in (self.folder / "undisturbed").iterdir()})

    def test_what_a_killed_writer_left_is_removed(self):
        self.take("run", "parts.toml", "--record", "left")
        dead = subprocess.Popen(["true"])
        dead.wait()
        stale, busy = (self.folder / "left" / f"parts.csv.partial-{pid}.0" for pid in (dead.pid, os.getpid()))
        stale.touch()
        busy.touch()
        self.take("run", "parts.toml", "--record", "left")
        self.assertFalse(stale.exists())
        self.assertTrue(busy.exists())

    def test_a_finished_run_does_nothing(self):
        self.take("run", "parts.toml", "--record", "record")
        before = {path: path.stat() for path in (self.folder / "record").iterdir()}
        self.take("run", "parts.toml", "--record", "record")
        for path, status in before.items():
            self.assertEqual(path.stat().st_mtime_ns, status.st_mtime_ns, path)
            self.assertEqual(path.stat().st_ino, status.st_ino, path)

    def test_killed_between_the_two_tables(self):
        """The series is saved before the rows that say that a part is finished."""
        self.take("run", "parts.toml", "--record", "record")
        _, keys, frames = self.record("record")
        table = self.folder / "record" / "parts.csv"
        lines = table.read_text().splitlines(keepends=True)
        table.write_text("".join(lines[:-8]))
        self.take("run", "parts.toml", "--record", "record")
        _, keys_after, frames_after = self.record("record")
        self.assertEqual(sorted(keys_after), sorted(keys))
        self.assertEqual(sorted(frames_after), sorted(frames))


if __name__ == "__main__":
    unittest.main()
