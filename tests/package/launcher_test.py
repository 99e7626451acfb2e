# SPDX-License-Identifier: BSD-3-Clause
"""The command of a package for any x86-64 starts the program for the most that the processor can do, with the same
words, and ends as it does. Programs are scripts here; what they answer is held alike by experiments/matrix --package.

usage: launcher_test.py COMPILER SOURCE
"""

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

COMPILER, SOURCE = sys.argv[1], Path(sys.argv[2])
LEVELS = ["x86-64", "x86-64-v2", "x86-64-v3", "x86-64-v4"]
PROGRAM = "#!/bin/sh\necho LEVEL\nfor word; do echo \"$word\"; done\n[ \"$1\" != killed ] || kill -KILL $$\nexit 7\n"


def supported():
    """As the dynamic linker says; the kernel does not list every flag of a level."""
    said = subprocess.run(["/lib64/ld-linux-x86-64.so.2", "--help"], capture_output=True, text=True, check=True).stdout
    return [LEVELS[0], *(level for level in LEVELS[1:] if re.search(rf"{level} \(supported", said))]


class Launcher(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.work = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.work)
        subprocess.run([COMPILER, "-std=c++20", "-O2", "-Wall", "-Wextra", "-Werror", "-static", SOURCE, "-o",
                        cls.work / "bvlab"], check=True)

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(dir=self.work, prefix="a folder "))
        (self.folder / "bin").mkdir()
        shutil.copy(self.work / "bvlab", self.folder / "bin/bvlab")

    def install(self, *levels):
        for level in levels:
            program = self.folder / "libexec/bvlab" / level / "bvlab"
            program.parent.mkdir(parents=True)
            program.write_text(PROGRAM.replace("LEVEL", level))
            program.chmod(0o755)

    def start(self, *words, command=None, processor=None):
        environment = {name: value for name, value in os.environ.items() if name != "BVLAB_PROCESSOR"}
        if processor is not None:
            environment["BVLAB_PROCESSOR"] = processor
        return subprocess.run([command or self.folder / "bin/bvlab", *words], env=environment, capture_output=True, text=True)

    def test_the_highest_that_the_processor_supports(self):
        self.install(*LEVELS)
        self.assertEqual(self.start().stdout.split(), [supported()[-1]])

    def test_what_is_not_installed_is_passed_over(self):
        self.install("x86-64")
        self.assertEqual(self.start().stdout.split(), ["x86-64"])

    def test_words_and_exits_are_the_programs(self):
        self.install("x86-64")
        done = self.start("two words", "", "*")
        self.assertEqual(done.stdout, "x86-64\ntwo words\n\n*\n")
        self.assertEqual((done.returncode, done.stderr), (7, ""))
        self.assertEqual(self.start("killed").returncode, -signal.SIGKILL)

    def test_by_a_link_from_elsewhere(self):
        self.install("x86-64")
        link = self.work / "link"
        link.symlink_to(self.folder / "bin/bvlab")
        self.assertEqual(self.start(command=link).stdout.split(), ["x86-64"])

    def test_a_level_may_be_asked_for(self):
        self.install(*LEVELS)
        for level in LEVELS:
            done = self.start(processor=level)
            if level in supported():
                self.assertEqual(done.stdout.split(), [level])
            else:
                self.assertEqual((done.returncode, done.stdout), (2, ""))

    def test_none_is_there(self):
        for processor, status in (None, 1), ("x86-64", 2), ("z80", 2), ("", 2):
            done = self.start(processor=processor)
            self.assertEqual((done.returncode, done.stdout), (status, ""))
            self.assertEqual(done.stderr.count("\n"), 1)

    def test_what_cannot_be_started_is_said(self):
        self.install("x86-64")
        (self.folder / "libexec/bvlab/x86-64/bvlab").chmod(0o644)
        done = self.start()
        self.assertEqual(done.returncode, 1)
        self.assertIn("Permission denied", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
