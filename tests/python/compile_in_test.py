# SPDX-License-Identifier: BSD-3-Clause
"""A header of one's own, in one call: the module that is given knows it, the one that was there does not."""

import os
import unittest
from pathlib import Path

import numpy as np

import bvlab
import scenes

SOURCE, BUILD = Path(os.environ["BVLAB_SOURCE"]), Path(os.environ["BVLAB_BUILD"])


class CompileIn(unittest.TestCase):
    def test_refusals(self):
        for bad in ({}, {"volumes": "mine.hpp"}, {"volumes": "/nowhere/mine.hpp:Mine<float>"},
                    {"strategies": "x.hpp:a b"}):
            with self.assertRaises(ValueError) as caught:
                bvlab.compile_in(**bad)
            self.assertNotIn("\n", str(caught.exception))

    def test_a_capsule_and_a_period(self):
        mine = bvlab.compile_in(volumes=f"{SOURCE}/tests/example/capsule.hpp:Capsule<float>",
                                strategies=f"{SOURCE}/tests/example/periodic.hpp:Periodic", build=BUILD / "mine",
                                only_volumes=["sphere"], only_strategies=["recursive", "deferred"])
        self.assertIn("capsule", mine.volumes())
        self.assertNotIn("capsule", bvlab.volumes())
        self.assertIn("periodic", mine.strategies())
        self.assertNotIn("periodic", bvlab.strategies())
        poses = scenes.walk(frames=15, objects=3, side=1)
        here, there = bvlab.Mesh(*scenes.torus()), mine.Mesh(*scenes.torus())
        for query in ("touching", "contacts", "distance"):
            wanted = bvlab.replay(here, poses, query=query).answers
            for volume in ("capsule", "sphere"):
                for strategy in ("recursive", "deferred", "periodic"):
                    with self.subTest(query=query, volume=volume, strategy=strategy):
                        answers = mine.replay(there, poses, query=query, volume=volume, strategy=strategy).answers
                        if query == "distance":  # as near as distances are promised, see traversal/queries/distance.hpp
                            np.testing.assert_allclose(answers, wanted, rtol=2**-44, atol=0)
                        else:
                            np.testing.assert_array_equal(answers, wanted)
        # Also where they are counted, and in a world.
        counted = mine.replay(there, poses, volume="capsule", strategy="periodic", count=True)
        self.assertGreater(counted.n_v, 0)
        world = mine.World([there], objects=3, volume="capsule", strategy="periodic")
        touching = bvlab.replay(here, poses).answers
        for frame, each in enumerate(poses):
            world.move([0, 1, 2], each)
            world.update()
            np.testing.assert_array_equal(world.touching(), bvlab.pairs_of(3)[touching[frame] == 1])
        with self.assertRaises(ValueError):
            bvlab.replay([mine.Mesh], poses)


if __name__ == "__main__":
    unittest.main()
