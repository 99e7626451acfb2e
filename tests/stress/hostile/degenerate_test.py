# SPDX-License-Identifier: BSD-3-Clause
"""Input that is degenerate and legal: taken without a word, answered in full, in arrays of the
promised type, shape and order."""

import csv
import json
import os
import shutil
import unittest

import numpy as np
from program import TETRAHEDRON, TRIANGLE, ProgramTest, names_of, poses, ways

# More than one only where the program was built with TBB.
THREADS = os.environ.get("BVLAB_THREADS", "1")

MESHES = {
    "triangle.off": TRIANGLE,
    "tetrahedron.off": TETRAHEDRON,
    "open.off": "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n",
    "needle.off": "OFF\n3 1 0\n0 0 0\n1 0 0\n0.5 0 0\n3 0 1 2\n",
    "point.off": "OFF\n1 1 0\n0 0 0\n3 0 0 0\n",
    "twice.off": "OFF\n6 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 3 4 5\n",
    "crossed.off": "OFF\n6 2 0\n0 0 0\n1 0 0\n0 1 0\n.2 .2 -1\n.2 .2 1\n.3 .2 1\n3 0 1 2\n3 3 4 5\n",
}
TRIANGLES = {name: 2 if name in ("open.off", "twice.off", "crossed.off") else 1 for name in MESHES}
TRIANGLES["tetrahedron.off"] = 4


class Replay(ProgramTest):
    def setUp(self):
        super().setUp()
        for name, text in MESHES.items():
            self.write(name, text)

    def replay(self, meshes, trace, query, *more):
        self.write("poses.npy", trace)
        given = [word for mesh in meshes for word in ("--mesh", mesh)]
        given += ["--trace", "poses.npy", "--query", query, "--out", "out.npy", "--json", "out.json"]
        self.assertEqual(self.take("replay", *given, *more), "")
        totals = json.loads((self.folder / "out.json").read_text())
        frames, objects = trace.shape[:2]
        pairs = objects * (objects - 1) // 2
        self.assertEqual((totals["frames"], totals["pairs"]), (frames, pairs))
        if query == "touching":
            found = self.array("out.npy", "u1", (frames, pairs))
            self.assertEqual(totals["touching"], int(found.sum()))
        elif query == "contacts":
            found = self.array("out.npy", "u4", (totals["contacts"], 5))
            rows = [tuple(row) for row in found]
            self.assertEqual(rows, sorted(set(rows)))
        else:
            found = self.array("out.npy", "f8", (frames, pairs))
            self.assertTrue(np.all(found >= 0))
        return found

    def test_formats_of_answers_are_in_the_help(self):
        """What `replay` above finds in the files."""
        said = " ".join(self.take("replay", "--help").split())
        self.assertIn("touching uint8 and distance float64 (frames, pairs)", said)
        self.assertIn("contacts uint32 (k, 5) of frame, i, j, triangle of i, of j, sorted", said)

    def test_names_that_are_no_utf8(self):
        """What is written about them is: JSON and a page name them with U+FFFD in place of a byte."""
        mesh, trace = os.fsdecode(b"a\xff,b %20#?.off"), os.fsdecode(b"p\xfe&<.npy")
        shutil.copyfile(self.folder / "tetrahedron.off", self.folder / mesh)
        self.write(trace, poses(3, 2))
        self.take("replay", "--mesh", mesh, "--trace", trace, "--page", "page.html", "--json", "out.json")
        json.loads((self.folder / "out.json").read_bytes().decode("utf-8"))
        self.assertIn("a\ufffd,b %20#?.off", (self.folder / "page.html").read_bytes().decode("utf-8"))

    def test_every_mesh_in_every_way(self):
        trace = np.concatenate([poses(1, 3, 0), poses(1, 3, 0.5), poses(1, 3, 5)])
        for mesh, count in TRIANGLES.items():
            for way in ways():
                with self.subTest(mesh=mesh, way=way):
                    touching = self.replay([mesh], trace, "touching", *way)
                    shifted = 0 if mesh == "point.off" else 1
                    near = [shifted, int(mesh not in ("point.off", "crossed.off")), shifted]
                    if mesh in ("triangle.off", "needle.off", "twice.off", "tetrahedron.off"):
                        self.assertEqual(touching[1].tolist(), near)
                    self.assertEqual(touching[0].tolist(), [1, 1, 1])
                    self.assertEqual(touching[2].tolist(), [0, 0, 0])
                    contacts = self.replay([mesh], trace, "contacts", *way)
                    own = [(0, 0, 1, t, t) for t in range(count)]
                    self.assertLessEqual(set(own), {tuple(row) for row in contacts})
                    self.assertFalse(np.any(contacts[:, 0] == 2))
                    if "distance" in names_of("queries"):
                        distance = self.replay([mesh], trace, "distance", *way)
                        self.assertEqual((distance == 0).tolist(), (touching == 1).tolist())

    def test_every_build_and_leaf_size(self):
        trace = poses(2, 4, 0.5)
        every = list(MESHES)
        expected = self.replay(every, trace, "contacts")
        for build in names_of("builds"):
            for size in (1, 2, 1000):
                way = ["--build", build, "--leaf-size", size]
                found = self.replay(every, trace, "contacts", *way)
                np.testing.assert_array_equal(found, expected, str(way))

    def test_every_volume_fitted_tightly(self):
        trace = np.concatenate([poses(2, 4, 0), poses(2, 4, 0.5)])
        for query in names_of("queries"):
            for volume in {"obb", "rss", "shell"} & set(names_of("volumes")):
                way = ["--volume", volume, "--leaf-size", 2]
                expected = self.replay(list(MESHES), trace, query, *way)
                found = self.replay(list(MESHES), trace, query, *way, "--fit", "tight")
                np.testing.assert_array_equal(found, expected, f"{query} {volume}")

    def test_few_objects_and_frames(self):
        for query in names_of("queries"):
            for strategy in names_of("strategies"):
                for frames, objects in ((0, 0), (0, 1), (0, 5), (3, 0), (3, 1), (1, 2), (0, 2**30)):
                    way = ["--strategy", strategy, "--threads", THREADS, "--count", "on"]
                    with self.subTest(query=query, strategy=strategy, shape=(frames, objects)):
                        trace = np.zeros((frames, objects, 7))
                        trace[..., 3] = 1
                        self.replay(list(MESHES), trace, query, *way)

    def test_quaternions_of_any_length(self):
        trace = poses(2, 3, 0)
        expected = self.replay(["tetrahedron.off"], trace, "contacts")
        for length in (5e-324, 1e-200, 1e-10, 3.0, 1e200, 1.7e308):
            trace[..., 3] = length
            found = self.replay(["tetrahedron.off"], trace, "contacts")
            np.testing.assert_array_equal(found, expected, str(length))

    def test_the_ends_of_the_numbers(self):
        """Vertices far out, where squares overflow, and close in, where they vanish."""
        for size in ("1e-320", "1e-300", "1e-160", "1e-30", "1e30", "1e150", "1e300"):
            self.write("size.off", TRIANGLE.replace("1", size).replace(f"3 {size} 0", "3 1 0", 1)
                       .replace(f"0 {size} 2\n", "0 1 2\n"))
            trace = np.concatenate([poses(1, 2, 0), poses(1, 2, 3 * float(size))])
            for way in ways():
                touching = self.replay(["size.off"], trace, "touching", *way)
                self.assertEqual(touching.tolist(), [[1], [0]], (size, way))

    def test_meshes_too_small_or_large_for_volumes_are_told(self):
        """Answers are right; that volumes are of no use for them is said, once a mesh, and only then."""
        for size, told in (("1e-18", True), ("1e-12", False), ("1e12", False), ("1e19", True)):
            self.write("size.off", "OFF\n4 2 0\n0 0 0\nS 0 0\n0 S 0\n0 0 S\n3 0 2 1\n3 0 1 3\n".replace("S", size))
            self.write("poses.npy", np.concatenate([poses(1, 2, 0), poses(1, 2, 3 * float(size))]))
            for command in ("replay", "predict"):
                to = ["--out", "out.npy", "--json", "out.json"] if command == "replay" else ["--json", "out.json"]
                done = self.run_bvlab(command, "--mesh", "size.off", "--trace", "poses.npy", "--query", "touching", *to)
                self.assertEqual(done.returncode, 0, done.stderr)
                if command == "replay":
                    self.assertEqual(self.array("out.npy", "u1", (2, 1)).tolist(), [[1], [0]])
                lines = [line for line in done.stderr.splitlines() if "every pair of triangles" in line]
                self.assertEqual([("size.off" in line) for line in lines], [True] * told, done.stderr)

    def test_files_named_with_commas_in_definitions(self):
        """A mesh's file may be named as it likes; several names have commas between."""
        for name in ("a,b %20#?.off", "b.off"):
            self.write(name, TETRAHEDRON)
        text = ('name = "commas"\nrepetitions = 1\n[parameters]\nframes = 2\nobjects = 2\n'
                '[[axis]]\nname = "mesh"\nvalues = ["./a,b %20#?.off", "./b.off,./b.off"]\n')
        self.write("commas.toml", text)
        done = self.run_bvlab("run", "commas.toml", "--record", "record")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = (self.folder / "record" / "commas.csv").read_text().splitlines()
        self.assertEqual(len(rows), 3)

    def test_lists_of_files_in_definitions(self):
        """With blanks after their commas, or as a list: the same files, in parameters, in axes and in values."""
        self.write("a.off", TETRAHEDRON)
        self.write("b.off", TETRAHEDRON.replace("1", "2"))
        trace = poses(3, 3, 1.5)
        self.write("trace.npy", trace)
        rows = {}
        for nth, mesh in enumerate(('"./a.off,./b.off"', '"./a.off, ./b.off"', '" ./a.off ,\t./b.off "', '["./a.off", "./b.off"]')):
            for where in (f"[parameters]\nmesh = {mesh}\n", f'[[axis]]\nname = "mesh"\nvalues = [{mesh}]\n',
                          f'[[axis]]\nname = "way"\n[[axis.value]]\nname = "a"\nmesh = {mesh}\n'):
                more = "" if where.startswith("[par") else "[parameters]\n"
                self.write("x.toml", 'name = "x"\n' + (where + more if not more else more) +
                           'scene = "recorded"\ntrace = "trace.npy"\nframes = 3\nobjects = 3\npeer = "none"\n' + (where if more else ""))
                record = f"record-{nth}-{len(rows)}"
                done = self.run_bvlab("run", "x.toml", "--record", record)
                self.assertEqual(done.returncode, 0, done.stderr)
                lines = (self.folder / record / "x.csv").read_text().splitlines()
                row = dict(zip(lines[0].split(","), next(csv.reader(lines[1:]))))
                rows[record] = row["polygons"], row["hits"], row["pairs"], row["peer"]
        self.assertEqual(len(set(rows.values())), 1, rows)
        self.assertEqual(self.replay(["a.off", "b.off"], trace, "touching").sum(), int(next(iter(rows.values()))[1]))

    def test_skipped_work_is_told(self):
        """Of what a strategy need not do, by counting what it did and what recursion does."""
        far = poses(5, 3, 50)
        for strategy in names_of("strategies"):
            self.replay(["tetrahedron.off"], far, "contacts", "--strategy", strategy, "--count", "on")
            skipped = json.loads((self.folder / "out.json").read_text())["skipped"]
            parts = {what: (part["done"], part["of"]) for what, part in skipped.items()}
            looks = {"margins": 3}  # once a pair
            with self.subTest(strategy=strategy):
                considered, pairs = parts["pairs_considered"]
                self.assertEqual(pairs, 5 * 3)
                self.assertEqual(considered, looks.get(strategy, pairs))
                self.assertEqual(parts["volume_tests"][1], 5 * 3)
                self.assertEqual(parts["triangle_tests"], (0, 0))
                # One root in seven of what each of three bodies has, in each of five frames.
                self.assertEqual(parts["volumes_posed"][1], 5 * 3 * 7)
                self.assertLessEqual(parts["volumes_posed"][0], 5 * 3)

    def test_totals_on_standard_output(self):
        self.write("poses.npy", poses(2, 2))
        said = self.take("replay", "--mesh", "triangle.off", "--trace", "poses.npy")
        self.assertEqual(json.loads(said)["frames"], 2)

    def test_result_on_standard_output(self):
        self.write("poses.npy", poses(3, 4))
        given = ["replay", "--mesh", "triangle.off", "--trace", "poses.npy", "--json", "out.json"]
        self.take(*given, "--out", "out.npy")
        expected = (self.folder / "out.npy").read_bytes()
        with open(self.folder / "said.npy", "wb") as said:
            done = self.run_bvlab(*given, "--out", "/dev/stdout", stdout=said)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual((self.folder / "said.npy").read_bytes(), expected)

    def test_a_link_stays(self):
        self.write("poses.npy", poses(3, 4))
        (self.folder / "elsewhere").mkdir()
        (self.folder / "elsewhere" / "out.npy").write_text("old")
        (self.folder / "out.npy").symlink_to("elsewhere/out.npy")
        given = ["--mesh", "triangle.off", "--trace", "poses.npy", "--json", "out.json"]
        self.take("replay", *given, "--out", "out.npy")
        self.assertTrue((self.folder / "out.npy").is_symlink())
        self.array("elsewhere/out.npy", "u1", (3, 6))

    def test_a_link_to_a_file_that_is_not_there_yet(self):
        self.write("poses.npy", poses(3, 4))
        (self.folder / "elsewhere").mkdir()
        for name, target in (("out.npy", "elsewhere/out.npy"), ("same.json", "elsewhere/out.npy"),
                             ("lost.npy", "nowhere/out.npy"), ("self.npy", "self.npy")):
            (self.folder / name).symlink_to(target)
        given = ["replay", "--mesh", "triangle.off", "--trace", "poses.npy"]
        self.refuse(*given, "--out", "out.npy", "--json", "same.json", mentions=["out.npy", "--out", "--json"])
        self.refuse(*given, "--out", "lost.npy", "--json", "out.json", mentions=["nowhere", "No such file"])
        self.refuse(*given, "--out", "self.npy", "--json", "out.json", mentions=["self.npy", "symbolic links"])
        self.take(*given, "--out", "out.npy", "--json", "out.json")
        self.assertTrue((self.folder / "out.npy").is_symlink())
        self.array("elsewhere/out.npy", "u1", (3, 6))


class Boxes(ProgramTest):
    def boxes(self, trace, *more):
        self.write("boxes.npy", trace)
        given = ["--trace", "boxes.npy", "--out", "out.npy", "--json", "out.json", *more]
        self.assertEqual(self.take("boxes", *given), "")
        totals = json.loads((self.folder / "out.json").read_text())
        return self.array("out.npy", "u4", (totals["overlaps"], 3)).tolist()

    def test_every_method(self):
        point = np.zeros((2, 3, 6))
        corner = np.array([[[0, 0, 0, 1, 1, 1], [1, 1, 1, 2, 2, 2], [1, 1, 1, 1, 1, 1]]], float)
        all_pairs = [[0, 0, 1], [0, 0, 2], [0, 1, 2]]
        for method in names_of("methods"):
            for coherent in ("on", "off"):
                way = ["--method", method, "--coherent", coherent]
                for dtype in ("f4", "f8"):
                    with self.subTest(way=way, dtype=dtype):
                        for shape in ((0, 0, 6), (0, 3, 6), (3, 0, 6), (3, 1, 6)):
                            self.assertEqual(self.boxes(np.zeros(shape, dtype), *way), [])
                        found = self.boxes(point.astype(dtype), *way)
                        self.assertEqual(found, all_pairs + [[1, i, j] for _, i, j in all_pairs])
                        self.assertEqual(self.boxes(corner.astype(dtype), *way), all_pairs)
                        largest = np.finfo(dtype).max
                        wide = np.zeros((1, 2, 6), dtype)
                        wide[..., :3], wide[..., 3:] = -largest, largest
                        self.assertEqual(self.boxes(wide, *way), [[0, 0, 1]])


class Triangles(ProgramTest):
    def test_without_area(self):
        pairs = np.zeros((4, 18))  # points at one place
        pairs[1, 9:] = 1  # at two
        pairs[2, [3, 6]] = 1, 2  # a point on a segment
        pairs[3, [3, 6]] = 1, 2
        pairs[3, [10, 13, 16]] = 1e-300  # and next to it
        self.write("pairs.npy", pairs)
        self.take("triangles", "--pairs", "pairs.npy", "--out", "out.npy", "--json", "out.json")
        self.assertEqual(self.array("out.npy", "u1", (4,)).tolist(), [1, 0, 1, 0])

    def test_none(self):
        self.write("pairs.npy", np.zeros((0, 18)))
        self.take("triangles", "--pairs", "pairs.npy", "--out", "out.npy", "--json", "out.json")
        self.array("out.npy", "u1", (0,))


class Scene(ProgramTest):
    def test_little_of_everything(self):
        self.write("mesh.off", TRIANGLE)
        for objects, frames in ((0, 0), (0, 3), (1, 0), (1, 1), (2, 3)):
            given = ["--objects", objects, "--frames", frames, "--mesh", "mesh.off"]
            self.take("scene", "random-walk", *given, "--out", "out.npy", "--meshes", "meshes")
            self.array("out.npy", "f8", (frames, objects, 7))
        given = ["--trace", "out.npy", "--mesh", "meshes/0-mesh.off", "--json", "totals.json"]
        self.take("replay", *given)


if __name__ == "__main__":
    unittest.main()
