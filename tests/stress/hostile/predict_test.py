# SPDX-License-Identifier: BSD-3-Clause
"""`bvlab predict`: beside what the strategies then do, and where its input is unusable."""

import csv
import json
import unittest

import numpy as np

from program import ProgramTest, poses

KEYS = {"n_v", "n_p", "seconds"}


def wandering(frames, objects, step, seed):
    """Bodies in a row, half a unit apart, each taking a step in any direction in every frame."""
    trace = poses(frames, objects, 0.5)
    trace[..., :3] += np.random.default_rng(seed).normal(0, step, (frames, objects, 3)).cumsum(axis=0)
    return trace


class Predict(ProgramTest):
    def setUp(self):
        super().setUp()
        self.take("scene", "random-walk", "--objects", "2", "--frames", "1", "--polygons", "80", "--shape", "torus",
                  "--meshes", "meshes", "--out", "none.npy")
        self.mesh = str(next((self.folder / "meshes").iterdir()))

    def counted(self, strategy, query):
        self.take("replay", "--mesh", self.mesh, "--trace", "trace.npy", "--strategy", strategy, "--query", query,
                  "--count", "on", "--json", "counted.json")
        return json.loads((self.folder / "counted.json").read_text())

    def predicted(self, query, *words):
        self.take("predict", "trace.npy", "--mesh", self.mesh, "--query", query, "--json", "said.json", *words)
        return json.loads((self.folder / "said.json").read_text())

    def test_recursion_is_counted(self):
        self.write("trace.npy", wandering(40, 4, 0.02, 1))
        for query in ("touching", "contacts"):
            said = self.predicted(query)["strategies"]
            for strategy in ("recursive", "recursive-both"):
                done = self.counted(strategy, query)
                self.assertEqual((said[strategy]["n_v"], said[strategy]["n_p"]), (done["n_v"], done["n_p"]), strategy)

    def test_lists_are_near(self):
        """All contacts, so that no hit cuts a run short: within a tenth of what lists do."""
        self.write("trace.npy", wandering(120, 4, 0.01, 2))
        said = self.predicted("contacts", "--stride", "1")["strategies"]
        for strategy in ("separation-list", "deferred", "by-cost"):
            self.assertAlmostEqual(said[strategy]["n_v"] / self.counted(strategy, "contacts")["n_v"], 1, delta=0.1,
                                   msg=strategy)

    def test_a_list_at_rest_is_run_through(self):
        """Nothing moves: by cost a list of n entries is built by 2n - 1 tests and kept for ever."""
        self.write("trace.npy", np.repeat(wandering(1, 3, 0.01, 3), 100, axis=0))
        said = self.predicted("contacts", "--stride", "100")["strategies"]
        self.assertEqual(said["by-cost"]["n_v"], self.counted("by-cost", "contacts")["n_v"])

    def test_table_and_csv_say_the_same(self):
        self.write("trace.npy", wandering(20, 3, 0.01, 4))
        table = self.take("predict", "trace.npy", "--mesh", self.mesh).splitlines()
        self.take("predict", "--trace", "trace.npy", "--mesh", self.mesh, "--csv", "said.csv")
        with open(self.folder / "said.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([line.split()[:3] for line in table[1:-1]], [[r["strategy"], r["n_v"], r["n_p"]] for r in rows])
        fastest = min(rows, key=lambda row: float(row["seconds"]))["strategy"]
        self.assertEqual(table[-1], f"fastest: {fastest}")
        self.assertTrue(all(KEYS < set(row) for row in rows))

    def test_unusable(self):
        self.write("trace.npy", poses(3, 2))
        self.write("torn.npy", np.zeros((3, 2, 6)))
        usable = ["predict", "trace.npy", "--mesh", self.mesh]
        for words, said in ((["predict", "none.txt", "--mesh", self.mesh], "none.txt"),
                            (["predict", "torn.npy", "--mesh", self.mesh], "torn.npy"),
                            (["predict", "trace.npy"], "--mesh"), (usable + ["--query", "distance"], "--query"),
                            (usable + ["--volume", "cube"], "cube"), (usable + ["--stride", "0"], "--stride")):
            self.refuse(*words, mentions=said)


if __name__ == "__main__":
    unittest.main()
