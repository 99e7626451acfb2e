# SPDX-License-Identifier: BSD-3-Clause
"""experiments/fit_candidates expects of each candidate the cost that the program says when it chooses."""

import importlib.machinery
import importlib.util
import os
import re
import tomllib
import types
import unittest
from pathlib import Path

import numpy as np

import bvlab
import scenes

EXPERIMENTS = Path(os.environ["BVLAB_SOURCE"]) / "experiments"
DEFINITION = tomllib.loads((EXPERIMENTS / "definitions/recommended-costs.toml").read_text(encoding="utf-8"))


def tool():
    loader = importlib.machinery.SourceFileLoader("fit_candidates", str(EXPERIMENTS / "fit_candidates"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("fit_candidates", loader))
    loader.exec_module(module)
    return module


class Expected(unittest.TestCase):
    def test_costs_are_those_of_the_program(self):
        meshes = [bvlab.Mesh(*scenes.torus())]
        poses = scenes.walk(frames=2000, objects=4, side=1.6)
        _, totals = scenes.Files(meshes, poses).replay("--recommended")
        said = re.search(r"expected ns per pair: (.*)\)", totals["recommended"])[1]
        said = {name: float(cost) for name, cost in (each.rsplit(" ", 1) for each in said.split(", "))}
        axis = next(axis["value"] for axis in DEFINITION["axis"] if axis["name"] == "candidate")
        candidates = [each for each in axis if each["name"] != "recommended"]
        self.assertGreaterEqual(len(said), 2)  # those that may pay are tried
        self.assertLessEqual(set(said), {each["name"] for each in candidates})
        candidates = [each for each in candidates if each["name"] in said]
        lanes = int(re.search(r"--fan-out (\d+)", bvlab.kernels()["siblings"])[1])  # of a register, leaves have no more
        fit = tool()
        problem = types.SimpleNamespace(candidates=list(said))
        costs = dict(zip(problem.candidates, fit.compiled(problem, "touching")))
        for each in candidates:
            with self.subTest(each["name"]):
                row = types.SimpleNamespace(query="touching", **{name: value for name, value in each.items() if name != "name"})
                row.leaf_size = min(row.leaf_size, lanes)
                if row.build == "top-down-surface-area":  # of the record, from before trees were made on demand
                    row.build = "on-demand"
                expected = fit.counts(row, meshes, poses) @ costs[each["name"]]
                np.testing.assert_allclose(expected, said[each["name"]], rtol=0.006)


if __name__ == "__main__":
    unittest.main()
