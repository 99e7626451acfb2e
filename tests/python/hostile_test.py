# SPDX-License-Identifier: BSD-3-Clause
"""Arrays that change, shrink, raise or lie where they are used: an exception, or the right answer, and no fault.

Under the address sanitizer this is where memory that is not ours would be seen.
"""

import collections
import itertools
import os
import signal
import threading
import unittest

import numpy as np
from numpy.lib.stride_tricks import as_strided

import bvlab
import scenes

VERTICES, FACES = scenes.torus()
AT_REST = np.array([0, 0, 0, 1, 0, 0, 0.0])
POSES = scenes.walk(frames=3, objects=2, side=1)
SANITIZED = "ASAN_OPTIONS" in os.environ


def random_boxes(frames, boxes, side=0.02):
    trace = np.random.default_rng(1).random((frames, boxes, 6))
    trace[..., 3:] = trace[..., :3] + side
    return trace


def unaligned(array):
    """The same numbers, beginning at an odd address."""
    array = np.ascontiguousarray(array)
    data = np.zeros(array.nbytes + 1, np.uint8)
    moved = data[1:].view(array.dtype).reshape(array.shape)
    moved[...] = array
    assert moved.flags.c_contiguous and not moved.flags.aligned
    return moved


def read_only(array):
    array = array.copy()
    array.flags.writeable = False
    return array


def in_a_record(array):
    """A column of a packed table: steps from row to row are no multiple of its size."""
    table = np.zeros(len(array), np.dtype([("x", "i1"), ("y", array.dtype, array.shape[1:])]))
    table["y"] = array
    return table["y"]


def overlapping(array):
    """Rows that are one and the same memory, where rows are equal."""
    first = np.ascontiguousarray(array[:1])
    return as_strided(first, (len(array), *array.shape[1:]), (0, *first.strides[1:]))


LAYOUTS = [unaligned, read_only, in_a_record, np.asfortranarray, lambda a: a[::-1].copy()[::-1],
           lambda a: a.astype(a.dtype.newbyteorder()), lambda a: unaligned(a.astype(a.dtype.newbyteorder()))]


class During:
    """Calls `change` in the midst of a call that looks at signals: in this thread, between two frames.

    After so many seconds of processor time, which are more than arrays take to come in, and fewer than the call takes.
    """

    def __init__(self, change, after=0.03):
        self.change, self.after, self.ran = change, after, False

    def __enter__(self):
        def handler(_signal, _frame):
            self.ran = True
            self.change()
        self.before = signal.signal(signal.SIGPROF, handler)
        signal.setitimer(signal.ITIMER_PROF, self.after)
        return self

    def __exit__(self, *_):
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, self.before)


class Writing:
    """Another thread that goes on writing to an array while the block runs."""

    def __init__(self, array, *values):
        self.array, self.values, self.done = array, values, threading.Event()

    def __enter__(self):
        def write():
            while not self.done.is_set():
                for value in self.values:
                    self.array[...] = value
        self.thread = threading.Thread(target=write)
        self.thread.start()

    def __exit__(self, *_):
        self.done.set()
        self.thread.join()


class Converted:
    """What NumPy makes an array of by a function of ours."""

    def __init__(self, convert):
        self.convert = convert

    def __array__(self, dtype=None):
        return self.convert()


class Saying:
    """A sequence that says how long it is."""

    def __init__(self, length, entries):
        self.length, self.entries = length, entries

    def __len__(self):
        return self.length

    def __iter__(self):
        return iter(self.entries)

    def __getitem__(self, at):
        return next(itertools.islice(self.entries, at, None))


class Layouts(unittest.TestCase):
    def test_of_meshes(self):
        for layout in LAYOUTS:
            mesh = bvlab.Mesh(layout(VERTICES), layout(FACES.astype(np.int64)))
            np.testing.assert_array_equal(mesh.vertices, VERTICES)
            np.testing.assert_array_equal(mesh.faces, FACES)
        np.testing.assert_array_equal(bvlab.Mesh(overlapping(np.ones((5, 3))), FACES[:1] % 5).vertices, np.ones((5, 3)))

    def test_of_motions(self):
        mesh = bvlab.Mesh(VERTICES, FACES)
        wanted = bvlab.replay([mesh], POSES, query="distance").answers
        for layout in LAYOUTS:
            np.testing.assert_array_equal(bvlab.replay([mesh], layout(POSES), query="distance").answers, wanted)
        still = np.repeat(POSES[:1], 4, 0)
        np.testing.assert_array_equal(bvlab.replay([mesh], overlapping(still)).answers, bvlab.replay([mesh], still).answers)

    def test_of_boxes(self):
        for dtype in (np.float64, np.float32):
            boxes = random_boxes(3, 50, 0.2).astype(dtype)
            wanted = bvlab.boxes(boxes).answers
            for layout in LAYOUTS:
                np.testing.assert_array_equal(bvlab.boxes(layout(boxes)).answers, wanted)

    def test_of_moves(self):
        mesh = bvlab.Mesh(VERTICES, FACES)
        poses = np.stack([AT_REST, AT_REST + [0.1, 0, 0, 0, 0, 0, 0]])
        for layout in LAYOUTS:
            world = bvlab.World([mesh, mesh])
            world.move(layout(np.array([0, 1])), layout(poses))
            world.move(0, layout(poses)[0])
            world.update()
            self.assertEqual(world.touching().tolist(), [[0, 1]])

    def test_quaternions_of_any_length(self):
        mesh = bvlab.Mesh(VERTICES, FACES)
        turned = np.array(POSES)
        turned[..., 3:] = np.sign(POSES[..., 3:])
        wanted = bvlab.replay([mesh], turned, query="distance").answers
        for length in (5e-324, 2.0**-1022, 2.0**-400, 2.0**400, 2.0**1023):
            longer = turned.copy()
            longer[..., 3:] *= length
            np.testing.assert_array_equal(bvlab.replay([mesh], longer, query="distance").answers, wanted)

    def test_vertices_of_any_size(self):
        for size in (5e-324, 1e-308, 1e-150, 1e150, 1e300, 1e308):
            mesh = bvlab.Mesh(VERTICES * size, FACES)
            for query in ("touching", "contacts", "distance"):
                still = np.broadcast_to(AT_REST, (2, 2, 7))
                try:
                    answers = bvlab.replay([mesh], still, query=query).answers
                except ValueError as fault:  # what does not stand in float64 any more
                    self.assertNotIn("\n", str(fault))
                else:
                    self.assertFalse(query == "distance" and answers.any())
                    self.assertFalse(query == "touching" and not answers.all())


class Changes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.mesh = bvlab.Mesh(VERTICES, FACES)

    def changed_during(self, call, array, *changes):
        """The answers are those of the array as it was given, whatever it becomes meanwhile."""
        wanted = call(array)
        for change in changes:
            given = array.copy()
            with During(lambda: change(given)) as during:
                np.testing.assert_array_equal(call(given), wanted)
            self.assertTrue(during.ran)

    def test_in_the_midst_of_a_replay(self):
        poses = np.tile(scenes.walk(frames=100, objects=6, side=1), (20, 1, 1))
        self.changed_during(lambda each: bvlab.replay([self.mesh], each).answers, poses,
                            lambda each: each.fill(np.nan), lambda each: each.resize((0,), refcheck=False),
                            lambda each: each.fill(0))

    def test_in_the_midst_of_boxes(self):
        for dtype in (np.float64, np.float32):
            boxes = random_boxes(60, 5000, 0.05).astype(dtype)
            self.changed_during(lambda each: bvlab.boxes(each).answers, boxes, lambda each: each.fill(np.nan),
                                lambda each: each.resize((0,), refcheck=False),
                                lambda each: each.__setitem__(..., each[..., [3, 4, 5, 0, 1, 2]]))

    def test_by_another_thread(self):
        """Torn in the middle, they are refused, or answered as they were read."""
        boxes, poses = random_boxes(2, 3000), scenes.walk(frames=50, objects=4, side=1)
        vertices, faces = np.tile(VERTICES, (100, 1)), np.tile(FACES.astype(np.int64), (100, 1))
        rows, world = np.tile(AT_REST, (100, 1)), bvlab.World([self.mesh], objects=100)
        for array, values, call in (
                (boxes, (boxes.copy(), boxes[..., ::-1].copy(), np.nan), lambda: bvlab.boxes(boxes)),
                (poses, (poses.copy(), np.nan, 0), lambda: bvlab.replay([self.mesh], poses)),
                (vertices, (vertices.copy(), np.inf), lambda: bvlab.Mesh(vertices, FACES)),
                (faces, (faces.copy(), 2**40, -1), lambda: bvlab.Mesh(VERTICES, faces)),
                (rows, (rows.copy(), np.nan, 1e308, 0), lambda: world.move(np.arange(100), rows))):
            with Writing(array, *values):
                for _ in range(30):
                    try:
                        call()
                    except ValueError as fault:
                        self.assertNotIn("\n", str(fault))
        world.move(np.arange(100), np.tile(AT_REST, (100, 1)) + np.arange(100)[:, None] * [9, 0, 0, 0, 0, 0, 0])
        world.update()
        self.assertEqual(len(world.touching()), 0)

    def test_by_what_is_asked_for_the_other_argument(self):
        def both(poses, change):
            change()
            return poses
        for change in (lambda which: which.resize((0,), refcheck=False), lambda which: which.resize((10**5,), refcheck=False),
                       lambda which: which.fill(2**40)):
            world, which = bvlab.World([self.mesh, self.mesh]), np.array([0, 1])
            world.move(which, Converted(lambda: both(np.tile(AT_REST, (2, 1)), lambda: change(which))))
            world.update()
            self.assertEqual(world.touching().tolist(), [[0, 1]])
        steps = np.zeros((3, 1), np.int64)
        took = bvlab.World([self.mesh] * 2).timed_steps(
            steps, Converted(lambda: both(np.tile(AT_REST, (3, 1, 1)), lambda: steps.resize((10**5, 1), refcheck=False))))
        self.assertEqual(took.shape, (3,))

        class Shrinking:
            vertices = VERTICES.copy()

            @property
            def faces(self):
                self.vertices.resize((0,), refcheck=False)
                return FACES
        with self.assertRaisesRegex(ValueError, "faces: index 0 in row 0, where there are 0 vertices"):
            bvlab.Mesh(Shrinking())

    def test_a_world_that_is_at_work(self):
        """A signal's handler interrupts timed steps, and calls the same world: refused, and nothing waits for itself."""
        world, faults = bvlab.World([self.mesh], objects=6), []
        poses = np.tile(scenes.walk(frames=100, objects=6, side=1), (100, 1, 1))

        def call():
            for each in (world.update, world.touching, lambda: world.move(0, AT_REST), lambda: world.near):
                try:
                    each()
                except RuntimeError as fault:
                    faults.append(str(fault))
        with During(call):
            world.timed_steps(np.tile(np.arange(6), (len(poses), 1)), poses)
        self.assertEqual(faults, ["World: is at work, in this thread"] * 4)
        wanted = bvlab.replay([self.mesh], poses[-1:]).answers[0]
        np.testing.assert_array_equal(world.touching(), bvlab.pairs_of(6)[wanted == 1])


class Arguments(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.mesh = bvlab.Mesh(VERTICES, FACES)

    def test_generators(self):
        def broken():
            yield self.mesh
            raise KeyError("no more")

        class Odd:
            @property
            def vertices(self):
                raise OSError("no file")
            faces = FACES
        for call in (lambda: bvlab.replay(Saying(2, broken()), POSES), lambda: bvlab.World(Saying(2, broken()))):
            self.assertRaisesRegex(KeyError, "no more", call)
        for call in (lambda: bvlab.Mesh(Odd()), lambda: bvlab.replay([Odd()], POSES)):
            self.assertRaises((OSError, ValueError), call)
        for bad in (Converted(lambda: None), Converted(lambda: [1, 2]), Converted(lambda: 1 / 0),
                    (row for row in POSES)):
            self.assertRaises(ValueError, bvlab.replay, [self.mesh], bad)
        np.testing.assert_array_equal(bvlab.replay(Saying(2, [self.mesh, self.mesh]), POSES).answers,
                                      bvlab.replay([self.mesh], POSES).answers)

    def test_what_never_ends(self):
        """Without a length it is refused, and with one it is gone through so far."""
        laughs: list = [0.0]
        for _ in range(40):
            laughs = [laughs] * 10
        itself: list = []
        itself.append(itself)
        for bad in (itertools.repeat([0, 0, 0]), Saying(3, itertools.repeat([0, 0, 0])),
                    [[0, 0, 0], [0, 0, 0], Saying(3, itertools.repeat(0))], [Saying(3, itertools.count())] * 3, laughs, itself):
            for call in (lambda bad: bvlab.Mesh(bad, FACES), lambda bad: bvlab.Mesh(VERTICES, bad),
                         lambda bad: bvlab.replay([self.mesh], bad), bvlab.boxes, lambda bad: bvlab.poses(bad, bad, order="wxyz"),
                         lambda bad: bvlab.World([self.mesh]).move(0, bad), lambda bad: bvlab.World([self.mesh]).move(bad, POSES)):
                with self.assertRaises((ValueError, TypeError)) as caught:
                    call(bad)
                self.assertRegex(str(caught.exception), "^[^\n]+$")
        for bad in (itertools.repeat(self.mesh), (each for each in [self.mesh]), Saying(3, itertools.repeat(self.mesh))):
            for call in (bvlab.World, lambda bad: bvlab.replay(bad, POSES), bvlab.Mesh):
                with self.assertRaises(ValueError) as caught:
                    call(bad)
                self.assertRegex(str(caught.exception), "^mesh(es)?: [^\n]+$")

    def test_sequences_of_ones_own(self):
        """They are what their entries are, as deep as there are axes."""
        rows = Saying(len(VERTICES), [Saying(3, row) for row in VERTICES.tolist()])
        np.testing.assert_array_equal(bvlab.Mesh(rows, collections.deque(map(tuple, FACES.tolist()))).vertices, VERTICES)
        np.testing.assert_array_equal(bvlab.poses(list(POSES[..., :3]), Saying(3, POSES[..., 3:]), order="wxyz"), POSES)

    def test_objects_that_no_call_made(self):
        for kind in (bvlab.Mesh, bvlab.World, bvlab.Result):
            nothing = kind.__new__(kind)
            uses = [lambda name=name: getattr(nothing, name) for name in dir(kind)
                    if isinstance(getattr(kind, name), property)]
            uses += [lambda: repr(nothing) if kind is not bvlab.World else len(nothing)]
            if kind is bvlab.World:
                uses += [nothing.update, nothing.touching, nothing.contacts, lambda: nothing.move(0, AT_REST),
                         lambda: nothing.remove(0), lambda: nothing.distances(1)]
            if kind is bvlab.Mesh:
                uses += [lambda: len(nothing), lambda: bvlab.Mesh(nothing), lambda: bvlab.World([nothing]),
                         lambda: bvlab.replay([self.mesh, nothing], POSES)]
            for use in uses:
                self.assertRaisesRegex(TypeError, "^was made by __new__ alone, and holds nothing: call its class$", use)

    def test_lengths_of_nothing(self):
        """An array without entries may promise any length."""
        def nothing(*shape):
            return np.empty(shape)
        for shape in ((2**33, 0, 7), (0, 2**33, 7), (2**40, 0, 7)):
            self.assertRaises(ValueError, bvlab.replay, [self.mesh], nothing(*shape))
            self.assertRaises(ValueError, bvlab.boxes, nothing(*shape[:2], 6))
        for query in ("touching", "contacts", "distance"):
            try:
                self.assertEqual(bvlab.replay([self.mesh], nothing(0, 2**31, 7), query=query).answers.size, 0)
            except ValueError as fault:  # shapes that NumPy has no numbers for
                self.assertNotIn("\n", str(fault))
        world = bvlab.World([self.mesh])
        self.assertRaises(ValueError, world.timed_steps, np.empty((2**33, 0), np.int64), nothing(2**33, 0, 7))
        self.assertEqual(world.timed_steps(np.empty((3, 0), np.int64), nothing(3, 0, 7)).shape, (3,))
        world.move(np.empty(0, np.int64), nothing(0, 7))

    @unittest.skipIf(SANITIZED, "the sanitizer ends a process that asks for too much")
    def test_more_than_memory_holds(self):
        self.assertRaises(MemoryError, bvlab.World, [self.mesh], objects=2**32 - 1)

    def test_numbers(self):
        huge = (-1, 2**31, 2**32, 2**63, 2**64, 2**80)
        for name, values in {"threads": (0, *huge), "leaf_size": (0, *huge), "fan_out": (0, 1, 3, *huge), "query": (1, None),
                             "relative_error": (-1, np.nan, np.inf, "x"), "volume": (1, "\0", "\ud800", "o" * 10**5)}.items():
            for value in values:
                with self.subTest(**{name: str(value)[:20]}), self.assertRaises((ValueError, TypeError)):
                    bvlab.replay([self.mesh], POSES, **{name: value})
        for value in (-1, 2**64, "x", 2**32):
            self.assertRaises((ValueError, TypeError), bvlab.World, [self.mesh], objects=value)
        for options in ({"stride": 0}, {"window": 0}, {"window": 1}, {"stride": -1}, {"window": 2**64}):
            self.assertRaises((ValueError, TypeError), bvlab.predict, [self.mesh], POSES, **options)


if __name__ == "__main__":
    unittest.main()
