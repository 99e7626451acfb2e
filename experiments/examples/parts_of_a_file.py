#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A file of several parts: which of them touch, and what the file's unit changes."""

import tempfile
from pathlib import Path

import bvlab

CUBE = [(x, y, z) for x in (0, 10) for y in (0, 10) for z in (0, 10)]
FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def cube(name, at, first):
    """A cube of 10 millimetres, as an object of an OBJ file."""
    return [f"o {name}", *(f"v {x + at} {y} {z}" for x, y, z in CUBE),
            *("f " + " ".join(str(first + corner) for corner in face) for face in FACES)]


with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "assembly.obj"
    path.write_text("\n".join(cube("plate", 0, 1) + cube("washer", 10, 9) + cube("bolt", 25, 17)) + "\n")
    for scale, unit in ((1, "mm"), (0.001, "m")):
        parts = bvlab.read_parts(path, scale=scale)
        world = bvlab.World([part.mesh for part in parts])
        for i, part in enumerate(parts):
            world.move(i, part.pose)
        world.update()
        for i, j in world.touching():
            print(f"{parts[i].name} and {parts[j].name} touch")
        pairs, distances = world.distances(below=6 * scale)
        for (i, j), distance in zip(pairs, distances):
            print(f"{parts[i].name} to {parts[j].name}: {distance:.3f} {unit}")
