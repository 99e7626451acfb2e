# SPDX-License-Identifier: BSD-3-Clause
"""`bvlab replay`: --nearest, --pairs, --without, --groups and --broad-phase; `bvlab scene parts`."""

import csv
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

BVLAB = os.environ["BVLAB"]


def run(*words):
    return subprocess.run([BVLAB, *map(str, words)], capture_output=True, text=True, check=False)


class PairsOfAReplay(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = Path(cls.temporary.name)
        # A unit cube, five times: at 0, 3, 3.5, 4 and 10 along x.
        corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
        faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
                 (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
        lines = ["OFF", "8 12 0", *(" ".join(map(str, c)) for c in corners)]
        lines += ["3 " + " ".join(map(str, f)) for f in faces]
        (cls.folder / "cube.off").write_text("\n".join(lines) + "\n")
        cls.poses = np.zeros((2, 5, 7))
        cls.poses[..., 3] = 1
        cls.poses[..., 0] = [0, 3, 3.5, 4, 10]
        np.save(cls.folder / "poses.npy", cls.poses)

    def replay(self, query, *words):
        for name in ("out.npy", "nearest.npy", "totals.json"):
            (self.folder / name).unlink(missing_ok=True)
        return run("replay", "--mesh", self.folder / "cube.off", "--trace", self.folder / "poses.npy", "--query", query,
                   "--out", self.folder / "out.npy", "--json", self.folder / "totals.json", *words)

    def answers(self, query, *words):
        done = self.replay(query, *words)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return np.load(self.folder / "out.npy")

    def refused(self, query, *words):
        done = self.replay(query, *words)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertFalse((self.folder / "out.npy").exists())
        return done.stderr

    def array(self, name, values, kind):
        np.save(self.folder / name, np.array(values, kind))
        return self.folder / name

    def test_nearest_pairs_are_records(self):
        place = self.folder / "nearest.npy"
        distances = self.answers("distance", "--nearest", place)
        nearest = np.load(place)
        self.assertEqual(nearest.shape, (2, 10))
        self.assertEqual(nearest.dtype, np.dtype([("triangles", "<u4", (2,)), ("points", "<f8", (2, 3))]))
        np.testing.assert_array_equal(distances[0], [2, 2.5, 3, 9, 0, 0, 6, 0, 5.5, 5])
        apart = nearest["points"][..., 1, :] - nearest["points"][..., 0, :]
        np.testing.assert_allclose(np.linalg.norm(apart, axis=-1), distances, atol=1e-14)
        np.testing.assert_allclose(nearest["points"][0, 0, :, 0], [1, 3])
        self.assertLess(nearest["triangles"].max(), 12)
        self.assertIn("--nearest", self.refused("touching", "--nearest", place))
        self.assertFalse(place.exists())

    def test_columns_follow_the_list(self):
        whole = self.answers("touching")
        np.testing.assert_array_equal(whole[0], [0, 0, 0, 0, 1, 1, 0, 1, 0, 0])
        for kind in (np.uint32, np.int64):
            pairs = self.array("pairs.npy", [[3, 1], [0, 1], [2, 3]], kind)
            np.testing.assert_array_equal(self.answers("touching", "--pairs", pairs)[0], [1, 0, 1])
            self.assertEqual(json.loads((self.folder / "totals.json").read_text())["pairs"], 3)
        without = self.array("without.npy", [[1, 2], [2, 1]], np.uint32)
        np.testing.assert_array_equal(self.answers("touching", "--without", without), np.delete(whole, 4, axis=1))
        self.assertEqual(self.answers("touching", "--pairs", pairs, "--without",
                                      self.array("without.npy", [[1, 3]], np.uint32)).tolist(), [[0, 1]] * 2)
        groups = self.array("groups.npy", [-1, 0, 0, 0, -1], np.int64)
        self.assertEqual(self.answers("touching", "--groups", groups).sum(), 0)
        self.assertEqual(self.answers("touching", "--groups", groups).shape, (2, 7))
        contacts = self.answers("contacts", "--pairs", pairs)
        self.assertEqual(set(map(tuple, contacts[:, 1:3].tolist())), {(1, 3), (2, 3)})
        nothing = self.array("pairs.npy", np.zeros((0, 2)), np.uint32)
        self.assertEqual(self.answers("distance", "--pairs", nothing).shape, (2, 0))

    def test_what_is_no_list_is_refused(self):
        good = self.array("good.npy", [[0, 1]], np.uint32)
        for option in ("--pairs", "--without"):
            self.assertIn("row 1: no object 5; there are 5",
                          self.refused("touching", option, self.array("f.npy", [[0, 1], [1, 5]], np.uint32)))
            self.assertIn("row 0: object 2 with itself",
                          self.refused("touching", option, self.array("f.npy", [[2, 2]], np.int64)))
            self.assertIn("has shape (2,) where (*, 2) is needed",
                          self.refused("touching", option, self.array("f.npy", [0, 1], np.uint32)))
            self.assertIn("holds '<f8'", self.refused("touching", option, self.array("f.npy", [[0, 1]], float)))
            self.assertIn("nowhere.npy", self.refused("touching", option, self.folder / "nowhere.npy"))
            self.assertIn("not with --pairs",
                          self.refused("touching", option, good, "--page", self.folder / "page.html"))
        self.assertIn("row 1: the same pair as in row 0",
                      self.refused("touching", "--pairs", self.array("f.npy", [[0, 1], [1, 0]], np.uint32)))
        self.assertIn("has groups of 1 objects; there are 5",
                      self.refused("touching", "--groups", self.array("f.npy", [0], np.uint32)))
        self.assertIn("--broad-phase", self.refused("distance", "--broad-phase", "on"))

    def test_a_broad_phase_changes_no_answer(self):
        for query in ("touching", "contacts"):
            whole = self.answers(query, "--broad-phase", "off")
            self.assertIsNone(json.loads((self.folder / "totals.json").read_text())["near"])
            np.testing.assert_array_equal(self.answers(query, "--broad-phase", "on"), whole)
            self.assertEqual(json.loads((self.folder / "totals.json").read_text())["near"], 6)

    def test_a_run_asks_about_chosen_pairs(self):
        pairs = self.array("asked.npy", [[3, 1], [0, 1], [2, 3]], np.uint32)
        definition = self.folder / "chosen.toml"
        definition.write_text(f"""
name = "chosen"
[parameters]
scene = "recorded"
trace = "{self.folder / 'poses.npy'}"
mesh = "{self.folder / 'cube.off'}"
asked_pairs = "{pairs}"
[[axis]]
name = "strategy"
values = ["recursive", "margins"]
""")
        done = run("run", definition, "--record", self.folder / "record", "--counts")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.folder / "record" / "chosen.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        found = [(row["asked_pairs"], row["pairs"], row["hits"]) for row in rows]
        self.assertEqual(found, [(str(pairs), "6", "4")] * 2)
        self.assertNotIn("joints", rows[0])
        # Of a recorded motion all is taken unless something else is said, and the rows say how much.
        self.assertEqual([(row["objects"], row["frames"]) for row in rows], [("5", "2")] * 2)
        definition.write_text(definition.read_text() + '[[axis]]\nname = "frames"\nvalues = [1, 2]\n')
        done = run("run", definition, "--record", self.folder / "lengths", "--counts")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.folder / "lengths" / "chosen.csv", newline="", encoding="utf-8") as file:
            self.assertEqual([row["frames"] for row in csv.DictReader(file)], ["1", "1", "2", "2"])
        definition.write_text(definition.read_text().replace("asked.npy", "nowhere.npy"))
        done = run("run", definition, "--record", self.folder / "other", "--counts")
        self.assertEqual(done.returncode, 2)
        self.assertIn("nowhere.npy", done.stderr)

    def test_parts_stand_in_their_order(self):
        folder, trace = self.folder / "parts", self.folder / "parts.npy"
        done = run("scene", "parts", "--objects", 30, "--out", trace, "--meshes", folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(np.load(trace).tolist(), [[[0, 0, 0, 1, 0, 0, 0]] * 30])
        files = sorted(folder.iterdir())
        self.assertEqual([file.name for file in files][:3], ["00-slab.off", "01-wall.off", "02-wall.off"])
        self.assertEqual(len(files), 30)
        done = run("replay", "--mesh", *files, "--trace", trace, "--recommended", "--json", self.folder / "totals.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertGreater(json.loads((self.folder / "totals.json").read_text())["touching"], 30)
        self.assertEqual(run("scene", "parts", "--joints", "glue", "--out", trace).returncode, 2)

    def test_parts_of_a_file(self):
        """Each a body with its pose and mesh; names lead nowhere else."""
        cube = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
        (self.folder / "a.obj").write_text(cube + "o base\nf 1 2 3\no ../../lid x\nf 3 2 1\nf 1 3 2\n")
        trace, folder = self.folder / "file.npy", self.folder / "of-file"
        done = run("scene", "file", self.folder / "a.obj", "--scale", 2, "--out", trace, "--meshes", folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(np.load(trace).tolist(), [[[0, 0, 0, 1, 0, 0, 0]] * 2])
        self.assertEqual(sorted(file.name for file in folder.iterdir()), ["0-base.off", "1-______lid_x.off"])
        self.assertEqual((folder / "0-base.off").read_text(), "OFF\n3 1 0\n0 0 0\n2 0 0\n0 2 0\n3 0 1 2\n")
        for words, said in ((["nowhere.obj", "--out", trace], "nowhere.obj: No such file"),
                            ([self.folder / "a.obj", "--out", self.folder / "a.obj"], "is the place of file"),
                            ([self.folder / "a.obj", "--out", trace, "--scale", 0], "scale: must be finite and above 0")):
            done = run("scene", "file", *words)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1))
            self.assertIn(said, done.stderr)


if __name__ == "__main__":
    unittest.main()
