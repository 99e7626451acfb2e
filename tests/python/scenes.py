# SPDX-License-Identifier: BSD-3-Clause
"""Small scenes for the tests, and the program beside the module."""

import json
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np

import bvlab

PROGRAM = os.environ["BVLAB"]


def walk(frames, objects, side, seed=1, step=0.15, turn=0.2):
    """A random walk in a cube: (frames, objects, 7)."""
    draw = np.random.default_rng(seed)
    at = np.clip(draw.uniform(-side, side, (1, objects, 3)) + np.cumsum(draw.normal(0, step, (frames, objects, 3)), 0),
                 -side, side)
    q = draw.normal(size=(1, objects, 4)) + np.cumsum(draw.normal(0, turn, (frames, objects, 4)), 0)
    return bvlab.poses(at, q, order="wxyz")


def torus(around=16, along=10, radius=0.4):
    """(vertices, faces) of a torus of 2 * around * along triangles."""
    u, v = np.meshgrid(np.arange(around), np.arange(along), indexing="ij")
    a, b = 2 * np.pi * u / around, 2 * np.pi * v / along
    vertices = np.stack([(1 + radius * np.cos(b)) * np.cos(a), (1 + radius * np.cos(b)) * np.sin(a),
                         radius * np.sin(b)], -1).reshape(-1, 3)
    at = lambda i, j: (i % around) * along + j % along  # noqa: E731
    faces = np.stack([np.stack([at(u, v), at(u + 1, v), at(u + 1, v + 1)], -1),
                      np.stack([at(u, v), at(u + 1, v + 1), at(u, v + 1)], -1)], 2).reshape(-1, 3)
    return vertices, faces


def write_off(path, mesh):
    """Every digit of it."""
    lines = ["OFF", f"{len(mesh.vertices)} {len(mesh.faces)} 0"]
    lines += [" ".join(map(repr, map(float, v))) for v in mesh.vertices]
    lines += ["3 " + " ".join(map(str, f)) for f in mesh.faces]
    Path(path).write_text("\n".join(lines) + "\n")


def program(*words):
    """Runs it; (exit, standard output, standard error)."""
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


class Files:
    """Meshes and a motion as files, for the program."""

    def __init__(self, meshes, poses):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name)
        self.words = ["--trace", self.root / "poses.npy"]
        np.save(self.root / "poses.npy", poses)
        for i, mesh in enumerate(meshes):
            write_off(self.root / f"{i}.off", mesh)
            self.words += ["--mesh", self.root / f"{i}.off"]

    def replay(self, *words, count="on"):
        """(answers, totals)"""
        exit, out, error = program("replay", *self.words, *words, "--count", count, "--out", self.root / "out.npy",
                                   "--json", self.root / "totals.json")
        assert exit == 0, error
        return np.load(self.root / "out.npy"), json.loads((self.root / "totals.json").read_text())
