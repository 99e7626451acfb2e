#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Parts that stand, as clash detection has them: which touch, with some pairs left out; meshes and results kept in files."""

import pickle

import numpy as np

import bvlab

CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
FACES = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
         [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]

# A wall of bricks in survey coordinates, each with a mesh in its place: one frame, poses that do nothing.
places = [(x, 0, z) for z in range(4) for x in range(12)]
bricks = [bvlab.Mesh(CORNERS + place + [388096, 5948996, 35], FACES) for place in places]
stand = np.zeros((1, len(bricks), 7))
stand[..., 3] = 1

# Of so many bodies, only pairs whose boxes overlap are queried.
result = bvlab.replay(bricks, stand)
print(f"{len(bricks)} bricks: {result.answers.sum()} of {len(result.pairs)} pairs touch, {result.totals['near']} were queried")

# Bricks of one layer are built together, and so are the two at each end of the lowest.
layers = [z for _, _, z in places]
between = bvlab.replay(bricks, stand, groups=layers)
print(f"between layers: {between.answers.sum()}")
some = bvlab.replay(bricks, stand, pairs=[[0, 1], [0, 12], [0, 24]])
print("bricks 0 and 1, 12, 24:", *some.answers[0])
world = bvlab.World(bricks, without=[[0, 1], [10, 11]])
world.move(np.arange(len(bricks)), stand[0])
world.update()
print(f"without two pairs: {len(world.touching())}")

kept = pickle.loads(pickle.dumps((bricks, result)))
again = bvlab.replay(kept[0], stand)
print(f"after pickle: {'the same' if (again.answers == kept[1].answers).all() else 'other'} answers")
