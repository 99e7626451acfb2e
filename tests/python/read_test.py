# SPDX-License-Identifier: BSD-3-Clause
"""Files into meshes and parts: scale, names, poses, warnings, and Ctrl-C while a pipe is waited for."""

import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import warnings
from pathlib import Path

import numpy as np

import bvlab
import scenes

OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no base\nf 1 2 3\no lid\nf 2 3 4\nf 1 3 4\n"


class Read(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)

    def write(self, name, text):
        (self.root / name).write_text(text)
        return self.root / name

    def test_scale(self):
        path = self.write("a.obj", OBJ)
        np.testing.assert_array_equal(bvlab.read(path, scale=0.5).vertices, 0.5 * bvlab.read(path).vertices)
        for scale in (0, -1, float("nan"), float("inf")):
            for read in (bvlab.read, bvlab.read_parts):
                with self.assertRaisesRegex(ValueError, "scale: must be finite and above 0"):
                    read(path, scale=scale)
        np.save(self.root / "poses.npy", [[[0, 0, 0, 1, 0, 0, 0], [0.75, 0, 0, 1, 0, 0, 0]]])
        words = ["replay", "--trace", self.root / "poses.npy", "--mesh", path, "--query", "distance",
                 "--out", self.root / "out.npy"]
        for scale in (1, 0.5):
            self.assertEqual(scenes.program(*words, "--scale", scale)[0], 0)
            self.assertAlmostEqual(np.load(self.root / "out.npy")[0, 0], 0 if scale == 1 else 0.25)
        self.assertEqual(scenes.program(*words, "--scale", "0")[::2],
                         (2, "bvlab: scale: must be finite and above 0\n"))

    def test_parts(self):
        path = self.write("a.obj", OBJ)
        base, lid = bvlab.read_parts(path, scale=2)
        self.assertEqual((base.name, lid.name), ("base", "lid"))
        self.assertEqual((len(base.mesh), len(lid.mesh)), (1, 2))
        np.testing.assert_array_equal(lid.pose, [0, 0, 0, 1, 0, 0, 0])
        self.assertEqual(lid.mesh.vertices.max(), 2)
        world = bvlab.World([base.mesh, lid.mesh])
        for i, part in enumerate((base, lid)):
            world.move(i, part.pose)
        world.update()
        self.assertEqual(world.touching().tolist(), [[0, 1]])

    def test_names_that_no_file_has(self):
        for name in ("a\0b.obj", b"a\0b.obj", "\ud800.obj", Path("a\0b.obj")):
            for read in (bvlab.read, bvlab.read_parts):
                with self.assertRaisesRegex(ValueError, "^[^\n]*obj[^\n]*: is no name of a file$"):
                    read(name)
        with self.assertRaises(TypeError):
            bvlab.read(1)

    def test_what_is_said_is_a_warning(self):
        path = self.write("a.obj", OBJ + "f 1 2\n")
        said = f"{path}: line 10: a face of fewer than three corners is left out; triangles are numbered without it"
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            self.assertEqual(len(bvlab.read(path)), 3)
        self.assertEqual([str(each.message) for each in caught], [said])
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with self.assertRaises(UserWarning):
                bvlab.read(path)

    def test_ctrl_c_while_a_pipe_is_waited_for(self):
        for writes in (None, b"", b"v 0 0 0\n"):
            path = self.root / f"{writes}.obj"
            os.mkfifo(path)
            code = f"import bvlab; print('ready', flush=True); bvlab.read({str(path)!r})"
            with subprocess.Popen([sys.executable, "-B", "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                  text=True) as waiting:
                waiting.stdout.readline()
                writer = None if writes is None else os.open(path, os.O_WRONLY)
                if writes:
                    os.write(writer, writes)
                time.sleep(0.3)
                start = time.monotonic()
                waiting.send_signal(signal.SIGINT)
                said = waiting.stderr.read()
                waiting.wait()
            self.assertLess(time.monotonic() - start, 2)
            self.assertTrue(said.endswith("KeyboardInterrupt\n"), said)
            self.assertNotIn("lost sys.stderr", said)
            self.assertNotIn("Interrupted system call", said)
            if writer:
                os.close(writer)

    def test_a_signal_that_raises_nothing(self):
        path = self.root / "a.obj"
        os.mkfifo(path)
        before = signal.signal(signal.SIGALRM, lambda *_: None)
        self.addCleanup(signal.signal, signal.SIGALRM, before)
        with subprocess.Popen(["/bin/sh", "-c", f"sleep 0.4; cat > '{path}'"], stdin=subprocess.PIPE) as writer:
            writer.stdin.write(OBJ.encode())
            writer.stdin.close()
            signal.setitimer(signal.ITIMER_REAL, 0.1)
            self.assertEqual(len(bvlab.read(path)), 3)


if __name__ == "__main__":
    unittest.main()
