# SPDX-License-Identifier: BSD-3-Clause
"""Calls of the module: they let other threads go on, Ctrl-C ends them, and their help is a page to start from."""

import ast
import os
import pydoc
import signal
import threading
import time
import unittest
from pathlib import Path

import numpy as np

import bvlab
import bvlab._running
import scenes

PACKAGE = Path(os.environ["BVLAB_SOURCE"]) / "experiments" / "python" / "bvlab"


class Calls(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.mesh = bvlab.Mesh(*scenes.torus(60, 40))
        # Long, since it stands for work that nobody wants to wait for.
        cls.long = np.tile(scenes.walk(frames=100, objects=6, side=1), (1000, 1, 1))

    def interrupted(self, call, wait=0.3):
        """The processor time that goes on after Ctrl-C."""
        pressed = []

        def press():
            time.sleep(wait)
            pressed.append(time.process_time())
            signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)
        threading.Thread(target=press).start()
        start = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            call()
        self.assertLess(time.monotonic() - start, wait + 5)
        return time.process_time() - pressed[0]

    def test_ctrl_c_ends_a_replay(self):
        self.interrupted(lambda: bvlab.replay(self.mesh, self.long, query="contacts"))
        self.interrupted(lambda: bvlab.replay(self.mesh, self.long, kernel="siblings", volume="slab-box"))

    def test_ctrl_c_ends_a_prediction(self):
        """Within a tenth of a second, in whichever of its parts: recursion in every frame, windows, coherence."""
        for wait in (0.3, 1, 3):
            for query in ("touching", "distance"):
                self.assertLess(self.interrupted(lambda: bvlab.predict(self.mesh, self.long, query=query), wait), 0.1)

    def test_ctrl_c_ends_boxes(self):
        trace = np.random.default_rng(1).random((300, 20000, 6), dtype=np.float32)
        trace[..., 3:] = trace[..., :3] + 0.1
        self.interrupted(lambda: bvlab.boxes(trace, answers=False))

    def test_other_threads_go_on(self):
        ticks, done = [], threading.Event()

        def tick():
            while not done.is_set():
                ticks.append(time.monotonic())
                time.sleep(0.002)
        threading.Thread(target=tick).start()
        start = time.monotonic()
        bvlab.replay(self.mesh, self.long[:1000], query="contacts", answers=False)
        end = time.monotonic()
        done.set()
        inside = sum(start < each < end for each in ticks)
        self.assertGreater(inside, (end - start) / 0.002 / 20)

    def test_a_world_of_several_threads(self):
        world = bvlab.World([self.mesh] * 6, volume="obb", strategy=list(bvlab.strategies())[-1])
        faults = []

        def work(i):
            try:
                for frame in range(30):
                    world.move(i, self.long[frame, i])
                    world.update()
                    for ask in (world.touching, world.contacts, lambda: world.distances(0.1)):
                        try:
                            ask()
                        except RuntimeError as fault:  # another thread has moved a body meanwhile
                            self.assertIn("call update() first", str(fault))
            except Exception as fault:  # noqa: BLE001
                faults.append(fault)
        threads = [threading.Thread(target=work, args=[i]) for i in range(6)]
        for each in threads:
            each.start()
        for each in threads:
            each.join()
        self.assertEqual(faults, [])
        wanted = bvlab.replay(self.mesh, self.long[29:30]).answers[0]
        np.testing.assert_array_equal(world.touching(), bvlab.pairs_of(6)[wanted == 1])

    def test_what_progress_raises_ends_a_run(self):
        import tempfile

        def stop(done, of):
            raise RuntimeError("enough")
        with tempfile.TemporaryDirectory() as folder, self.assertRaisesRegex(RuntimeError, "enough"):
            bvlab.run({"name": "x", "parameters": {"mesh": "torus", "frames": 2}}, f"{folder}/x", counts=True,
                      progress=stop)

    def test_a_record_is_let_go_at_the_end_of_a_run(self):
        import tempfile
        definition = {"name": "x", "parameters": {"mesh": "torus", "polygons": 50, "frames": 2, "objects": 2},
                      "axis": [{"name": "seed", "values": [1]}]}
        with tempfile.TemporaryDirectory() as folder:
            record = f"{folder}/x"

            def again(done, of):
                bvlab.run(definition, record, counts=True, progress=False)
            with self.assertRaisesRegex(ValueError, "another run of this program"):
                bvlab.run(definition, record, counts=True, progress=again)
            for seeds in ([1], [1, 2], [1, 2]):
                definition["axis"][0]["values"] = seeds
                bvlab.run(definition, record, counts=True, progress=False)
            self.assertEqual(len(bvlab.record(record)), 2)
            with self.assertRaises(ValueError):
                bvlab.run({**definition, "parameters": {"mesh": "none.off"}}, f"{folder}/y", counts=True, progress=False)
            self.assertFalse((Path(folder) / "y").exists())
            for bad in ("", "a\0b"):
                with self.assertRaisesRegex(ValueError, "no path"):
                    bvlab.run(definition, bad, counts=True, progress=False)

    def test_ctrl_c_while_another_program_has_the_record(self):
        import fcntl
        import subprocess
        import sys
        import tempfile
        with tempfile.TemporaryDirectory() as folder:
            held = os.open(folder, os.O_RDONLY)
            fcntl.flock(held, fcntl.LOCK_EX)
            code = f"import bvlab; bvlab.run({{'name': 'x', 'parameters': {{'mesh': 'torus', 'frames': 2}}}}, {folder!r})"
            with subprocess.Popen([sys.executable, "-B", "-c", code], stderr=subprocess.PIPE, text=True) as waiting:
                self.assertIn("waiting for another run to end", waiting.stderr.readline())
                waiting.send_signal(signal.SIGINT)
                self.assertIn("KeyboardInterrupt", waiting.stderr.read())
            os.close(held)

    def test_a_fit_that_a_volume_lacks(self):
        """As the program refuses it: a sphere has one fit."""
        poses = self.long[:2, :2]
        for call in (lambda **words: bvlab.replay(self.mesh, poses, **words), lambda **words: bvlab.predict(self.mesh, poses, **words),
                     lambda **words: bvlab.World(self.mesh, objects=2, **words)):
            with self.assertRaisesRegex(ValueError, "^--fit tight: sphere has only one fit: published$"):
                call(volume="sphere", fit="tight")
            call(volume="obb", fit="tight")

    def test_predictions_of_nothing(self):
        """Of one frame, or of no pairs, no strategy is faster than another."""
        for frames, objects in ((1, 3), (0, 3), (5, 1), (5, 0), (1, 1)):
            told = bvlab.predict(self.mesh, self.long[:frames, :objects])
            self.assertIsNone(told["fastest"], (frames, objects))
            self.assertEqual(set(told["candidates"]), set(told["strategies"]))

    def test_a_path_that_is_no_text(self):
        """Its bytes are named as they are."""
        import tempfile
        with tempfile.TemporaryDirectory() as folder:
            path = os.fsdecode(os.fsencode(folder) + b"/\xff\xfe.off")
            with self.assertRaisesRegex(ValueError, r"\\xff\\xfe\.off: "):
                bvlab.read(path)
            scenes.write_off(path, self.mesh)
            self.assertEqual(len(bvlab.read(path)), len(self.mesh))
            definition = os.fsdecode(os.fsencode(folder) + b"/\xff.toml")
            Path(definition).write_text("name = \"x\"\n[parameters]\nfrobs = 3\n")
            with self.assertRaisesRegex(ValueError, r"\\xff\.toml: line 3: unknown parameter"):
                bvlab.run(definition, folder + "/x")
            record = os.fsdecode(os.fsencode(folder) + b"/\xfe")
            parameters = {"mesh": "torus", "polygons": 50, "frames": 2, "objects": 2}
            made = bvlab.run({"name": "x", "parameters": parameters}, record, counts=True, progress=False)
            self.assertEqual(made, Path(record))
            self.assertEqual(len(bvlab.record(record)), 1)

    def test_copies(self):
        """Of a mesh and of a result, by copy and by pickle."""
        import copy
        import pickle

        class Named(bvlab.Mesh):
            pass
        named = Named(self.mesh)
        named.name = "a"
        result = bvlab.replay(self.mesh, self.long[:3, :2], query="contacts", count=True, series=True, frame_seconds=True)
        distances = bvlab.replay(self.mesh, self.long[:3, :3], query="distance", nearest=True, pairs=[(0, 2), (1, 0)])
        boxes = bvlab.boxes(np.zeros((2, 3, 6)))
        ways = [copy.copy, copy.deepcopy, *(lambda each, p=p: pickle.loads(pickle.dumps(each, p)) for p in range(2, 6))]
        for way in ways:
            mesh = way(self.mesh)
            self.assertIsInstance(mesh, bvlab.Mesh)
            np.testing.assert_array_equal(mesh.vertices, self.mesh.vertices)
            np.testing.assert_array_equal(mesh.faces, self.mesh.faces)
            one, other = way([self.mesh, self.mesh]) if way is not copy.copy else (mesh, mesh)
            self.assertIs(one, other)
            for given in (result, distances, boxes):
                again = way(given)
                np.testing.assert_array_equal(again.answers, given.answers)
                self.assertEqual(again.totals, given.totals)
                self.assertEqual(repr(again), repr(given))
                self.assertEqual(again.n_v, given.n_v)
                np.testing.assert_array_equal(again.nearest, given.nearest)
                np.testing.assert_array_equal(again.pairs, given.pairs)
            np.testing.assert_array_equal(way(result).series, result.series)
            np.testing.assert_array_equal(way(result).frame_seconds, result.frame_seconds)
            np.testing.assert_array_equal(bvlab.replay(mesh, self.long[:3, :2], query="contacts").answers, result.answers)
        self.assertEqual(copy.copy(named).name, "a")
        self.assertIsInstance(copy.copy(named), Named)
        for nothing in (bvlab.Mesh.__new__(bvlab.Mesh), bvlab.Result.__new__(bvlab.Result)):
            for way in ways:
                self.assertRaises(TypeError, way, nothing)
        for bad in ((), (1, 2), (None, 3, *(None,) * 5), (None,) * 5, 3, "x", (None, {}, *(None,) * 3, "x", None),
                    (None, {}, *(None,) * 3, 2, [(0, 1, 2)])):
            with self.assertRaises((ValueError, TypeError)):
                bvlab.Result.__new__(bvlab.Result).__setstate__(bad)

    def test_what_a_configuration_sets(self):
        poses = self.long[:2, :2]
        for given in ({"volume": "obb"}, {"strategy": "raise"}, {"leaf_size": 3}, {"fan_out": 2}, {"frame": "world"},
                      {"volume": "sphere"}, {"strategy": "recursive"}, {"leaf_size": 1}, {"kernel": "gathered"},
                      {"build": "top-down-principal"}, {"fit": "published"}):
            (name,) = given
            with self.assertRaisesRegex(ValueError, f"{name}: is set by the configuration"):
                bvlab.replay(self.mesh, poses, configuration="recommended", **given)
            with self.assertRaisesRegex(ValueError, f"{name}: is set by the configuration"):
                bvlab.World([self.mesh] * 2, configuration="recommended", **given)

    def test_definitions_that_are_none(self):
        for bad in ({"name": "x", "parameters": {"cube": 1}}, {}, {"name": None}, {"name": "x", 3: 4},
                    {"name": "x", "parameters": {"mesh": object()}}, "none.toml", os.curdir):
            with self.assertRaises(ValueError) as caught:
                bvlab.run(bad, "/nowhere/at/all")
            self.assertNotIn("\n", str(caught.exception))

    def test_definitions_as_dictionaries(self):
        import tomllib
        given = {"name": "a \"quoted\" \\ name\n\x7f ü \U0001f600", "repetitions": 3, "x": 0.1, "y": 1e-300, "whole": 1.0, "no": False,
                 "parameters": {"list": [1, "two", 3.5], "degrees": np.float64(0.25), "range": [0, 1, 2]},
                 "axis": [{"name": "reading", "value": [{"name": "a", "moving": 1}, {"name": "b"}]},
                          {"name": "seed", "values": [1, 2]}], "a key": {"b.c": 1}}
        self.assertEqual(tomllib.loads(bvlab._running.toml_of(given)), given)

    def test_help(self):
        text = pydoc.render_doc(bvlab, renderer=pydoc.plaintext)
        for name in bvlab.__all__:
            self.assertIn(name, text)
            self.assertTrue(getattr(bvlab, name).__doc__.strip(), name)

    def test_stubs_name_what_there_is(self):
        stubs = ast.parse((PACKAGE / "_bvlab.pyi").read_text())
        private = bvlab._bvlab
        for node in stubs.body:
            if isinstance(node, ast.FunctionDef):
                self.same_arguments(node, getattr(private, node.name).__doc__)
            elif isinstance(node, ast.ClassDef) and node.name != "HasFaces":
                kind = getattr(private, node.name)
                own = {each.name: each for each in node.body if isinstance(each, ast.FunctionDef)}
                there = {name for name in vars(kind) if not name.startswith("_")}
                self.assertEqual(there, {name for name in own if not name.startswith("_")}, node.name)
                for name, each in own.items():
                    if not each.decorator_list and name != "__len__":
                        self.same_arguments(each, getattr(kind, name).__doc__)
        public = {name for name in vars(private) if not name.startswith("_")}
        self.assertLessEqual(public, {node.name for node in stubs.body if hasattr(node, "name")})

    def same_arguments(self, node, text):
        """The first line of pybind11's help is the signature."""
        line = (text or "").splitlines()[0]
        arguments = [each.arg for each in node.args.args + node.args.kwonlyargs if each.arg != "self"]
        for name in arguments:
            self.assertIn(f"{name}: ", line, node.name)
        self.assertEqual(line.count(": "), len(arguments) + ("self: " in line), line)


if __name__ == "__main__":
    unittest.main()
