# SPDX-License-Identifier: BSD-3-Clause
"""bvlab as its callers see it: what every test of the program from outside stands on."""

import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

BVLAB = os.environ["BVLAB"]

# A closed and an open mesh, and one of a single triangle.
TETRAHEDRON = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n"
TRIANGLE = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"


def lines_of(kind):
    return subprocess.run([BVLAB, "list", kind], check=True, capture_output=True, text=True).stdout.splitlines()


def names_of(kind):
    """The names that `bvlab list KIND` lists, but for scenes that have to be brought from elsewhere first."""
    names = [line.split()[0] for line in lines_of(kind)]
    return [name for name in names if not name.startswith("public:")]


WIDE_KERNELS = ("siblings", "mixed")


def volumes_of(kernel):
    """The volumes that a kernel is compiled for, as `bvlab list kernels` says."""
    (line,) = [line for line in lines_of("kernels") if line.startswith(kernel)]
    return line.split("--volume ")[1].split(", ") if "--volume " in line else names_of("volumes")


def ways():
    """Arguments for every volume under every strategy, on trees of every fan-out, in both frames and on all kernels
    in turn."""
    trees = [[], ["--fan-out", "4", "--frame", "body"], ["--fan-out", "16"], ["--frame", "body"],
             ["--fan-out", "8", "--frame", "body"], ["--kernel", "siblings"]]
    pairs = [(volume, strategy) for volume in names_of("volumes") for strategy in names_of("strategies")]
    return [["--volume", volume, "--strategy", strategy, *trees[k % len(trees)]]
            for k, (volume, strategy) in enumerate(pairs)] + \
        [["--kernel", "mixed", "--volume", volume] for volume in volumes_of("mixed")]


def poses(frames, objects, step=0.1):
    """A trace of shape (frames, objects, 7): unturned objects in a row, `step` apart."""
    trace = np.zeros((frames, objects, 7))
    trace[..., 0] = step * np.arange(objects)
    trace[..., 3] = 1
    return trace


class ProgramTest(unittest.TestCase):
    """Each test has a folder of its own, in which bvlab runs."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="bvlab-")
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def write(self, name, content):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if isinstance(content, np.ndarray):
            np.save(path, content)
        elif isinstance(content, bytes):
            path.write_bytes(content)
        else:
            path.write_text(content)
        return name

    def run_bvlab(self, *arguments, **options):
        options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "timeout": 600} | options
        return subprocess.run(
            [BVLAB, *map(str, arguments)], cwd=self.folder, text=True, check=False, **options
        )

    def files(self):
        """Every file and folder, and what the files hold."""
        return {
            str(path.relative_to(self.folder)): path.read_bytes() if path.is_file() else None
            for path in self.folder.rglob("*")
        }

    def refuse(self, *arguments, mentions, exit=2, **options):
        """One line that holds every mention, nothing else, nothing left behind."""
        before = self.files()
        done = self.run_bvlab(*arguments, **options)
        with self.subTest(arguments=arguments):
            self.assertEqual(done.returncode, exit, done.stderr)
            self.assertFalse(done.stdout)
            self.assertRegex(done.stderr, r"\Abvlab: [^\n]+\n\Z")
            for mention in [mentions] if isinstance(mentions, str) else mentions:
                self.assertIn(mention, done.stderr)
            self.assertEqual(self.files(), before)
        return done.stderr

    def take(self, *arguments, **options):
        """Done without a word of complaint; what was said on standard output."""
        done = self.run_bvlab(*arguments, **options)
        self.assertEqual((done.returncode, done.stderr), (0, ""), arguments)
        return done.stdout

    def array(self, name, dtype, shape):
        """A result, which must be of this type and shape and in C order."""
        array = np.load(self.folder / name)
        self.assertEqual((array.dtype, array.shape), (np.dtype(dtype), shape), name)
        with open(self.folder / name, "rb") as file:
            np.lib.format.read_magic(file)
            self.assertFalse(np.lib.format.read_array_header_1_0(file)[1], "C order")
        return array
