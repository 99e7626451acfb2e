#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""From Python: two boxes, a motion, and which strategy needs the fewest volume tests for the same answers; and a world."""

import numpy as np

import bvlab

corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
         [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
mesh = bvlab.Mesh(corners, faces)

# One stands still, the other comes nearer along x, in 200 frames from 3 to 0.5.
positions = np.zeros((200, 2, 3))
positions[:, 1, 0] = np.linspace(3, 0.5, 200)
quaternions = np.zeros((200, 2, 4))
quaternions[..., 0] = 1
poses = bvlab.poses(positions, quaternions, order="wxyz")

tests = {}
for strategy in ("recursive", "deferred", "margins"):
    result = bvlab.replay([mesh], poses, volume="obb", strategy=strategy, query="touching", count=True)
    tests[strategy] = result.totals["n_v"]  # its digits follow the processor's registers
    print(f"{strategy}: touching from frame {int(np.argmax(result.answers[:, 0]))}")
# Where are they nearest in the first frame? A record of triangles and points.
result = bvlab.replay([mesh], poses, query="distance", nearest=True)
on_a, on_b = result.nearest["points"][0, 0]
print(f"apart by {result.answers[0, 0]:.1f} at first, from x = {on_a[0]:.1f} to x = {on_b[0]:.1f}")
print("fewest volume tests first:", *sorted(tests, key=tests.get))

# A world begins empty here: bodies come one by one, and leave.
world = bvlab.World()
for x in (0, 0.5, 1.25):
    world.add(mesh, [x, 0, 0, 1, 0, 0, 0])
    if len(world) > 1:
        world.update()
        print(f"a world of {len(world)}: {world.touching().tolist()}")
world.remove(0)
world.update()
print(f"without body 0: {world.touching().tolist()}")
