# SPDX-License-Identifier: BSD-3-Clause
"""The module gives what the program gives, to the digit: answers, counts, names, defaults and refusals."""

import json
import tempfile
import unittest
from pathlib import Path

import numpy as np

import bvlab
import scenes

TIMES = {"seconds", "build_seconds", "first_seconds", "peak_bytes"}
QUERIES = ["touching", "contacts", "distance"]


class Same(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.meshes = [bvlab.Mesh(*scenes.torus()), bvlab.Mesh(*scenes.torus(9, 7, 0.6))]
        cls.poses = scenes.walk(frames=12, objects=5, side=1.6)
        cls.files = scenes.Files(cls.meshes, cls.poses)

    def same(self, words, **options):
        answers, totals = self.files.replay(*words)
        result = bvlab.replay(self.meshes, self.poses, count=True, **options)
        self.assertEqual(answers.dtype, result.answers.dtype)
        np.testing.assert_array_equal(answers, result.answers)
        self.assertEqual({k: v for k, v in totals.items() if k not in TIMES},
                         {k: v for k, v in result.totals.items() if k not in TIMES})
        self.assertEqual(set(totals), set(result.totals))
        return result

    def test_every_volume(self):
        for volume in bvlab.volumes():
            for query in QUERIES:
                with self.subTest(volume=volume, query=query):
                    result = self.same(["--volume", volume, "--query", query], volume=volume, query=query)
                    self.assertGreater(result.n_v, 0)

    def test_every_strategy(self):
        for strategy in bvlab.strategies():
            for query in QUERIES:
                with self.subTest(strategy=strategy, query=query):
                    self.same(["--strategy", strategy, "--query", query], strategy=strategy, query=query)

    def test_every_tree_and_frame(self):
        for fan_out in (2, 4, 8, 16):
            for frame in bvlab.frames():
                self.same(["--fan-out", fan_out, "--frame", frame, "--volume", "obb", "--query", "contacts"],
                          fan_out=fan_out, frame=frame, volume="obb", query="contacts")
        for query in QUERIES:
            self.same(["--kernel", "siblings", "--volume", "slab-box", "--query", query], kernel="siblings",
                      volume="slab-box", query=query)

    def test_configurations(self):
        for name in bvlab.configurations():
            for query in QUERIES:
                with self.subTest(configuration=name, query=query):
                    try:
                        result = bvlab.replay(self.meshes, self.poses, configuration=name, query=query)
                    except ValueError as fault:  # a volume or a strategy that was not compiled
                        exit, _, error = scenes.program("replay", *self.files.words, "--configuration", name,
                                                        "--query", query)
                        self.assertEqual((exit, error), (2, f"bvlab: {fault}\n"))
                        continue
                    answers, _ = self.files.replay("--configuration", name, "--query", query)
                    np.testing.assert_array_equal(answers, result.answers)

    def test_series_adds_up(self):
        result = bvlab.replay(self.meshes, self.poses, count=True, series=True, frame_seconds=True,
                              strategy=list(bvlab.strategies())[-1])
        for name in ("n_u", "n_v", "n_p"):
            self.assertEqual(result.series[name].sum(), result.totals[name])
        self.assertEqual(result.series["hits"].sum(), result.totals["touching"])
        self.assertAlmostEqual(result.series["front"].mean() / 10, result.front)
        self.assertEqual(result.frame_seconds.shape, (len(self.poses),))

    def test_boxes(self):
        draw = np.random.default_rng(3)
        lo = draw.uniform(0, 1, (3, 200, 3))
        trace = np.concatenate([lo, lo + draw.uniform(0, 0.2, lo.shape)], -1)
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            for dtype in (np.float32, np.float64):
                given = trace.astype(dtype)
                np.save(folder / "boxes.npy", given)
                for method in bvlab.methods():
                    with self.subTest(method=method, dtype=dtype):
                        exit, _, error = scenes.program("boxes", "--trace", folder / "boxes.npy", "--method", method,
                                                        "--out", folder / "out.npy", "--json", folder / "totals.json")
                        self.assertEqual(exit, 0, error)
                        result = bvlab.boxes(given, method=method)
                        np.testing.assert_array_equal(np.load(folder / "out.npy"), result.answers)
                        totals = json.loads((folder / "totals.json").read_text())
                        self.assertEqual({k: v for k, v in totals.items() if k not in TIMES},
                                         {k: v for k, v in result.totals.items() if k not in TIMES})

    def test_predict(self):
        json_file = self.files.root / "predicted.json"
        exit, _, error = scenes.program("predict", *self.files.words, "--volume", "obb", "--json", json_file)
        if "--strategy" in error or "--volume" in error:
            with self.assertRaises(ValueError):
                bvlab.predict(self.meshes, self.poses, volume="obb")
            self.skipTest("a program of few strategies")
        self.assertEqual(exit, 0, error)
        theirs, ours = json.loads(json_file.read_text()), bvlab.predict(self.meshes, self.poses, volume="obb")
        self.assertEqual(theirs["survival"], ours["survival"])
        self.assertEqual(list(theirs["strategies"]), list(ours["strategies"]))
        for name, each in theirs["strategies"].items():
            self.assertEqual((each["n_v"], each["n_p"]), (ours["strategies"][name]["n_v"], ours["strategies"][name]["n_p"]))
        self.assertIn(ours["fastest"], [None, *ours["strategies"]])
        self.assertLessEqual(set(ours["candidates"]), set(ours["strategies"]))

    def test_run(self):
        definition = {"name": "mine", "parameters": {"mesh": "torus", "polygons": 100, "objects": 3, "frames": 5},
                      "axis": [{"name": "strategy", "values": ["recursive", "deferred"]}]}
        with tempfile.TemporaryDirectory() as folder:
            folder, seen = Path(folder), []
            record = bvlab.run(definition, folder / "ours", counts=True, progress=lambda done, of: seen.append((done, of)))
            self.assertEqual(record, folder / "ours")
            self.assertEqual(seen[0][0], 0)
            self.assertEqual(seen[-1][0], seen[-1][1])
            exit, _, error = scenes.program("run", record / "definition.toml", "--record", folder / "theirs", "--counts")
            self.assertEqual(exit, 0, error)
            self.assertEqual((folder / "theirs" / "mine.csv").read_text(), (record / "mine.csv").read_text())

    def test_names(self):
        for kind in ("volumes", "strategies", "queries", "frames", "kernels", "methods", "configurations", "builds", "precisions",
                     "parameters", "peers", "studies", "study_parameters"):
            lines = scenes.program("list", kind.replace("_", "-"))[1].splitlines()
            lines = [line for line in lines if not line.startswith("left out")]
            self.assertEqual([line.split()[0] for line in lines], list(getattr(bvlab, kind)()), kind)

    def test_defaults(self):
        answers, totals = self.files.replay(count="off")
        result = bvlab.replay(self.meshes, self.poses)
        self.assertEqual({k: v for k, v in totals.items() if k not in TIMES},
                         {k: v for k, v in result.totals.items() if k not in TIMES})

    def test_refusals_are_the_program_s(self):
        for words, options in (
                (["--volume", "cube"], {"volume": "cube"}), (["--strategy", "none"], {"strategy": "none"}),
                (["--query", "what"], {"query": "what"}), (["--build", "up"], {"build": "up"}),
                (["--precision", "half"], {"precision": "half"}), (["--fit", "loose"], {"fit": "loose"}),
                (["--relative-error", "-1"], {"relative_error": -1}),
                (["--configuration", "best"], {"configuration": "best"}), (["--fan-out", "3"], {"fan_out": 3}),
                (["--frame", "moon"], {"frame": "moon"}), (["--kernel", "none"], {"kernel": "none"})):
            exit, _, error = scenes.program("replay", *self.files.words, *words)
            with self.assertRaises(ValueError) as caught:
                bvlab.replay(self.meshes, self.poses, **options)
            self.assertEqual((exit, error), (2, f"bvlab: {caught.exception}\n"))
        for options in ({"frame": "mine"}, {"kernel": "none"}, {"fan_out": 0, "frame": "body"}, {"threads": 5000},
                        {"threads": 0}):
            with self.assertRaises(ValueError) as caught:
                bvlab.replay(self.meshes, self.poses, **options)
            self.assertNotIn("\n", str(caught.exception))

    def test_read(self):
        path = self.files.root / "0.off"
        mesh = bvlab.read(path)
        np.testing.assert_array_equal(mesh.vertices, self.meshes[0].vertices)
        np.testing.assert_array_equal(mesh.faces, self.meshes[0].faces)
        for bad in (self.files.root / "none.off", self.files.root, self.files.root / "poses.npy"):
            exit, _, error = scenes.program("replay", "--trace", self.files.root / "poses.npy", "--mesh", bad)
            with self.assertRaises(ValueError) as caught:
                bvlab.read(bad)
            self.assertEqual((exit, error), (2, f"bvlab: {caught.exception}\n"))


if __name__ == "__main__":
    unittest.main()
