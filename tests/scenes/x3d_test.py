# SPDX-License-Identifier: BSD-3-Clause
"""`bvlab replay ... --x3d`: the scene that a viewer gets is the trace, and red is what touches."""

import os
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as xml
from pathlib import Path

import numpy as np

BVLAB = os.environ["BVLAB"]


def run(*words):
    return subprocess.run([BVLAB, *map(str, words)], capture_output=True, text=True, check=False)


def numbers(text, columns):
    return np.array(text.split(), float).reshape(-1, columns)


def turned(axis, angle, vector):
    """By Rodrigues' formula, shapes (n, 3), (n,) and (3,)."""
    cosine, sine = np.cos(angle)[:, None], np.sin(angle)[:, None]
    return vector * cosine + np.cross(axis, vector) * sine + axis * (axis @ vector)[:, None] * (1 - cosine)


def turned_by_quaternion(q, vector):
    q = q / np.linalg.norm(q, axis=1, keepdims=True)
    across = 2 * np.cross(q[:, 1:], vector)
    return vector + q[:, :1] * across + np.cross(q[:, 1:], across)


class X3d(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = Path(cls.temporary.name)
        (cls.folder / "mesh.off").write_text("OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n")

    def scene(self, poses, *words):
        np.save(self.folder / "a & b.npy", poses)
        place = self.folder / "scene.x3d"
        done = run("replay", "--mesh", self.folder / "mesh.off", "--trace", self.folder / "a & b.npy", "--x3d", place,
                   "--out", self.folder / "out.npy", "--json", self.folder / "totals.json", *words)
        self.assertEqual(done.returncode, 0, done.stderr)
        return {node.get("DEF"): node for node in xml.parse(place).iter() if node.get("DEF")}, xml.parse(place)

    def test_is_the_trace(self):
        random = np.random.default_rng(1)
        poses = random.normal(size=(40, 4, 7))
        poses[:, 3] = poses[0, 3]
        nodes, document = self.scene(poses)
        for body in range(3):
            places = numbers(nodes[f"place{body}"].get("keyValue"), 3)
            np.testing.assert_allclose(places, poses[:, body, :3], rtol=1e-8, atol=1e-8)
            turns = numbers(nodes[f"turn{body}"].get("keyValue"), 4)
            for vector in np.eye(3):
                np.testing.assert_allclose(turned(turns[:, :3], turns[:, 3], vector),
                                           turned_by_quaternion(poses[:, body, 3:], vector), atol=1e-7)
        self.assertNotIn("place3", nodes, "a body at rest needs no interpolator")
        np.testing.assert_allclose(numbers(nodes["body3"].get("translation"), 3)[0], poses[0, 3, :3], rtol=1e-8)
        uses = [node.get("USE") for node in document.iter("IndexedTriangleSet")]
        self.assertEqual(uses, [None, "mesh0", "mesh0", "mesh0"])
        titles = [node.get("content") for node in document.iter("meta") if node.get("name") == "title"]
        self.assertEqual(titles, ["a & b.npy"])
        for route in document.iter("ROUTE"):
            self.assertIn(route.get("fromNode"), nodes)
            self.assertIn(route.get("toNode"), nodes)

    def test_what_touches_is_red(self):
        poses = np.zeros((30, 3, 7))
        poses[..., 3] = 1
        poses[:, 1, 0] = 0.2 + 3 * np.abs(np.sin(np.arange(30) / 3))
        poses[:, 2, 0] = 10
        nodes, _ = self.scene(poses)
        touching = np.load(self.folder / "out.npy")[:, 0]
        self.assertGreater(touching.sum(), 3)
        self.assertLess(touching.sum(), 27)
        keys = numbers(nodes["touch1"].get("key"), 1)[:, 0] * 29
        red = (numbers(nodes["touch1"].get("keyValue"), 3) == [0.85, 0.1, 0.1]).all(axis=1)
        shown = [red[np.flatnonzero(keys < frame + 0.5)[-1]] for frame in range(30)]
        self.assertEqual(shown, list(touching.astype(bool)))
        self.assertNotIn("touch2", nodes)

    def test_refuses_what_it_cannot_write(self):
        np.save(self.folder / "one.npy", np.zeros((1, 1, 7)) + [0, 0, 0, 1, 0, 0, 0])
        words = ["replay", "--mesh", self.folder / "mesh.off", "--trace", self.folder / "one.npy"]
        for more in (["--x3d", self.folder / "no folder" / "scene.x3d"], ["--x3d", self.folder / "a.x3d", "--budget", 3]):
            done = run(*words, *more)
            self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)
            self.assertFalse((self.folder / "a.x3d").exists())


if __name__ == "__main__":
    unittest.main()
