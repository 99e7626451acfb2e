# SPDX-License-Identifier: BSD-3-Clause
"""Collision detection of moving triangle meshes, exact and counted: the bvlab program for Python.

Does my mesh touch?

    import bvlab
    mesh = bvlab.Mesh(vertices, faces)              # (n, 3) real, (m, 3) integer; or bvlab.read("mine.obj")
    parts = bvlab.read_parts("mine.glb")            # of each node its .mesh, .name and .pose
    world = bvlab.World([mesh, mesh])               # two bodies
    world.move(0, [0, 0, 0, 1, 0, 0, 0])            # x y z qw qx qy qz, object to world
    world.move(1, [2, 0, 0, 1, 0, 0, 0])
    world.update()
    world.touching()                                # uint32 (k, 2): pairs whose surfaces share a point
    world.contacts()                                # uint32 (k, 4): the pairs of triangles
    world.distances(below=1.5)                      # pairs no farther apart, and their distances
    world.distances(below=1.5, nearest=True)        # ... and which triangles and points are nearest
    bvlab.World([mesh, mesh], without=[(0, 1)])     # neighbours are left out; also pairs=, groups=

What does a motion cost, and what does coherence save?

    poses = bvlab.poses(positions, quaternions, order="wxyz")       # or bvlab.poses(matrices)
    result = bvlab.replay([mesh], poses, volume="obb", strategy="deferred", query="touching", count=True)
    result.answers                                  # uint8 (frames, pairs): as `bvlab replay --out`
    result.totals                                   # seconds, n_u, n_v, n_p, front ...: as --json
    bvlab.predict([mesh], poses)["candidates"]      # strategies that may be the fastest

From an idea to a figure:

    folder = bvlab.run({"name": "mine", "parameters": {...}, "axis": [...]}, record="mine")
    frame = bvlab.record("mine")                    # a pandas frame
    bvlab.figures("mine")["by-degrees"]             # the figures that plots/draw draws, of matplotlib

Boxes: bvlab.boxes(trace, method="auto"). Names, with what they are: bvlab.volumes(), strategies(),
queries(), frames(), kernels(), methods(), configurations(), builds(), precisions(), parameters(),
formula_meshes(), peers(), studies(), study_parameters().
A volume or a strategy of your own: bvlab.compile_in(volumes=["mine.hpp:Mine<float>"]).

Lengths are in the units of the meshes, angles in quaternions, times in seconds. What the program
refuses is a ValueError with its line. The GIL is released while C++ runs.
"""

from ._bvlab import Mesh, Result, World, boxes, named_mesh, predict, read, replay
from ._compiling import compile_in
from ._names import (builds, configurations, formula_meshes, frames, kernels, methods, parameters, peers, precisions,
                     queries, strategies, studies, study_parameters, volumes)
from ._parts import Part, read_parts
from ._poses import pairs_of, poses
from ._records import figures, record
from ._running import run

__all__ = ["Mesh", "Part", "Result", "World", "boxes", "builds", "compile_in", "configurations", "figures", "formula_meshes",
           "frames", "kernels", "methods", "named_mesh", "pairs_of", "parameters", "peers", "poses", "precisions", "predict", "queries",
           "read", "read_parts", "record", "replay", "run", "strategies", "studies", "study_parameters", "volumes"]

for _each in (Mesh, Result, World, boxes, named_mesh, predict, read, replay):
    _each.__module__ = __name__  # where they are to be found
