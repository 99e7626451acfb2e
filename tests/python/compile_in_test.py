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

    def test_a_capsule(self):
        mine = bvlab.compile_in(volumes=f"{SOURCE}/tests/example/capsule.hpp:Capsule<float>", build=BUILD / "mine",
                                only_volumes=["sphere"], only_strategies=["recursive", "deferred"])
        self.assertIn("capsule", mine.volumes())
        self.assertNotIn("capsule", bvlab.volumes())
        poses = scenes.walk(frames=5, objects=3, side=1)
        theirs = mine.replay(mine.Mesh(*scenes.torus()), poses, volume="capsule", query="distance")
        ours = bvlab.replay(bvlab.Mesh(*scenes.torus()), poses, query="distance")
        np.testing.assert_array_equal(theirs.answers, ours.answers)
        with self.assertRaises(ValueError):
            bvlab.replay([mine.Mesh], poses)


if __name__ == "__main__":
    unittest.main()
