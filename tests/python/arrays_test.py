# SPDX-License-Identifier: BSD-3-Clause
"""Arrays of every kind: those that are one come in, and the others end in an exception of one line."""

import threading
import unittest

import numpy as np

import bvlab
import scenes

VERTICES, FACES = scenes.torus()
AT_REST = np.array([0, 0, 0, 1, 0, 0, 0.0])
POSES = scenes.walk(frames=3, objects=2, side=1)
BOXES = np.array([[[0, 0, 0, 1, 1, 1], [1, 1, 1, 2, 2, 2.0]]])


def with_entry(array, at, value):
    array = np.array(array, dtype=np.float64)
    array[at] = value
    return array


class Raises:
    """An object that is no array."""

    def __array__(self, dtype=None):
        raise RuntimeError("not\ntoday")


class Mesh(unittest.TestCase):
    def refused(self, error, call, *given, **options):
        with self.assertRaises(error) as caught:
            call(*given, **options)
        self.assertNotIn("\n", str(caught.exception))
        self.assertTrue(str(caught.exception))

    def test_any_real_dtype_and_order(self):
        mesh = bvlab.Mesh(VERTICES, FACES)
        for dtype in "e f d g i1 u1 i2 u2 i4 u4 i8 u8 >f8 >f4 >i4 ?".split():
            with np.errstate(all="ignore"):
                given = (8 * VERTICES).astype(dtype)
            for layout in (np.ascontiguousarray, np.asfortranarray, lambda a: np.repeat(a, 2, 0)[::2],
                           lambda a: a[::-1][::-1], lambda a: a.tolist()):
                np.testing.assert_array_equal(bvlab.Mesh(layout(given), FACES).vertices, given.astype(np.float64))
        for dtype in "i2 u2 i4 u4 i8 u8 >i4 >u8".split():
            for layout in (np.ascontiguousarray, np.asfortranarray, lambda a: a[:, ::-1][:, ::-1]):
                np.testing.assert_array_equal(bvlab.Mesh(VERTICES, layout(FACES.astype(dtype))).faces, mesh.faces)

    def test_what_is_not_copied(self):
        mesh = bvlab.Mesh(VERTICES, FACES)
        self.assertTrue(np.shares_memory(mesh.vertices, mesh.vertices))
        self.refused(ValueError, mesh.vertices.__setitem__, (0, 0), 1)
        self.refused(ValueError, mesh.faces.__setitem__, (0, 0), 1)

    def test_meshes_are_not_copied_by_each_call(self):
        places, mesh, other = bvlab._bvlab._places_of, bvlab.Mesh(VERTICES, FACES), bvlab.Mesh(VERTICES, FACES)
        self.assertEqual(places([mesh, mesh]), [mesh.vertices.ctypes.data])
        first = places([mesh, other])
        self.assertEqual(places([mesh, other, mesh, other]), first)
        turned, thrice = places([other, mesh]), places([mesh, other, other])
        self.assertEqual((len(turned), len(thrice)), (2, 3))
        self.assertEqual(places([other, mesh]), turned)
        self.assertEqual(places([mesh, other, other]), thrice)
        # The address of one that is gone is nobody else's.
        world = bvlab.World([mesh, other], volume="obb")
        for _ in range(20):
            other = bvlab.Mesh(VERTICES + 5, FACES)
            self.assertEqual(bvlab.replay([mesh, other], POSES[:1] * 0 + AT_REST).answers[0, 0], 0)
            del other
        world.move([0, 1], [AT_REST, AT_REST])
        world.update()
        self.assertEqual(world.touching().tolist(), [[0, 1]])

    def test_a_mesh_that_is_changed_later(self):
        vertices = VERTICES.copy()
        mesh = bvlab.Mesh(vertices, FACES)
        vertices[:] = np.nan
        np.testing.assert_array_equal(mesh.vertices, VERTICES)

    def test_of_anything_with_vertices_and_faces(self):
        class Trimesh:
            vertices, faces = VERTICES.astype(np.float32), FACES.astype(np.int64)
        np.testing.assert_array_equal(bvlab.Mesh(Trimesh()).faces, FACES)
        self.assertEqual(bvlab.replay([Trimesh(), Trimesh()], POSES).answers.shape, (3, 1))
        self.assertEqual(bvlab.replay(Trimesh(), POSES).answers.shape, (3, 1))

    def test_hostile_vertices(self):
        for bad in (None, "vertices", b"", 1, {}, set(), object(), Raises(), VERTICES.ravel(), VERTICES[:, :2],
                    VERTICES[None], VERTICES.astype(complex), VERTICES.astype(object), VERTICES.astype(str),
                    VERTICES.astype("V8"), [[0, 0, 0], [1, 1]], with_entry(VERTICES, (5, 1), np.nan),
                    with_entry(VERTICES, (5, 1), np.inf), np.array(VERTICES, dtype="M8[s]"), np.zeros((0, 3)),
                    np.zeros((3, 0)), [], np.ma.masked_less(VERTICES, 0), np.full((4, 3), np.longdouble("1e4000"))):
            self.refused((ValueError, TypeError), bvlab.Mesh, bad, FACES)

    def test_hostile_faces(self):
        for bad in ("faces", 1, {}, FACES.ravel(), FACES[:, :2], FACES[None], FACES.astype(float), FACES > 1, [],
                    np.zeros((0, 3), int), np.zeros((3, 0), int), FACES - 1, FACES + 1,
                    np.full((1, 3), 2**63, np.uint64), np.full((1, 3), -2**63), FACES.astype(object),
                    [[0, 1, 2], [0, 1]], np.ma.masked_less(FACES, 3)):
            self.refused((ValueError, TypeError), bvlab.Mesh, VERTICES, bad)

    def test_huge(self):
        # More than memory holds, from nothing: refused by shape or by NumPy, before anything is made.
        huge = np.broadcast_to(np.zeros(3), (10**14, 3))
        self.refused((ValueError, MemoryError), bvlab.Mesh, huge, FACES)
        self.refused((ValueError, MemoryError), bvlab.Mesh, VERTICES, np.broadcast_to(np.zeros(3, int), (10**14, 3)))
        mesh = bvlab.Mesh(VERTICES, FACES)
        self.refused((ValueError, MemoryError), bvlab.replay, [mesh], np.broadcast_to(AT_REST, (10**7, 10**6, 7)))
        self.refused((ValueError, MemoryError), bvlab.boxes, np.broadcast_to(BOXES[0, 0], (10**7, 10**6, 6)))
        # Numbers whose vertices do not stand in float64.
        far = POSES.copy()
        far[1, 1, :3] = 1.7e308
        large = bvlab.Mesh(VERTICES * 1e308, FACES)
        self.refused(ValueError, bvlab.replay, [large], far)
        world = bvlab.World([large, large])
        self.refused(ValueError, world.move, 0, far[1, 1])

    def test_hostile_poses(self):
        mesh = bvlab.Mesh(VERTICES, FACES)
        zero = POSES.copy()
        zero[1, 1, 3:] = 0
        for bad in (None, "x", 3, {}, Raises(), POSES[0], POSES[..., :6], POSES.astype(complex), POSES.astype(object),
                    with_entry(POSES, (1, 0, 2), np.nan), with_entry(POSES, (1, 0, 5), -np.inf), zero,
                    np.ma.masked_less(POSES, 0)):
            self.refused(ValueError, bvlab.replay, [mesh], bad)
            self.refused(ValueError, bvlab.predict, [mesh], bad)
        for shape in ((0, 0, 7), (0, 2, 7), (2, 0, 7), (2, 1, 7)):
            for query in ("touching", "contacts", "distance"):
                given = np.broadcast_to(AT_REST, shape)
                answers = bvlab.replay([mesh], given, query=query).answers
                self.assertEqual(answers.size, 0)
        for layout in (np.asfortranarray, lambda a: np.repeat(a, 2, 1)[:, ::2], lambda a: a.astype(">f8"), list):
            np.testing.assert_array_equal(bvlab.replay([mesh], layout(POSES), query="distance").answers,
                                          bvlab.replay([mesh], POSES, query="distance").answers)

    def test_hostile_meshes(self):
        for bad in (None, [], 3, "mesh", [None], [VERTICES], {}, (each for each in ()), iter([1])):
            self.refused(ValueError, bvlab.replay, bad, POSES)
            if bad not in ([], {}):  # a world may begin without a body
                self.refused(ValueError, bvlab.World, bad)

    def test_hostile_moves(self):
        mesh = bvlab.Mesh(VERTICES, FACES)
        world = bvlab.World([mesh, mesh])
        for bad in (AT_REST[:6], AT_REST * np.nan, AT_REST * 0, "x", None, np.zeros((2, 7)), AT_REST.astype(complex)):
            self.refused(ValueError, world.move, 0, bad)
        for index in (-1, 2, 2**40, 2**80, -2**80):
            self.refused(IndexError, world.move, index, AT_REST)
            self.refused(IndexError, world.remove, index)
        self.refused((TypeError, ValueError), world.move, 0.5, AT_REST)
        self.refused((TypeError, ValueError), world.remove, "x")
        self.refused(ValueError, world.move, [0, 1], [AT_REST])
        self.refused(IndexError, world.move, [0, 2], [AT_REST, AT_REST])
        self.refused(ValueError, world.distances, -1)
        self.refused(ValueError, world.distances, np.nan)
        world.update()
        self.assertEqual(len(world.touching()) + len(world.contacts()) + len(world.distances(np.inf)[0]), 0)

    def test_hostile_boxes(self):
        wrong = BOXES.copy()
        wrong[0, 1, 3:] = 0
        for bad in (None, "x", BOXES[0], BOXES[..., :5], wrong, with_entry(BOXES, (0, 1, 2), np.nan),
                    with_entry(BOXES, (0, 1, 5), np.inf), BOXES.astype(complex), BOXES.astype(object)):
            self.refused(ValueError, bvlab.boxes, bad)
        for shape in ((0, 0, 6), (0, 5, 6), (5, 0, 6), (3, 1, 6)):
            self.assertEqual(bvlab.boxes(np.zeros(shape)).answers.shape, (0, 3))
        for layout in (np.asfortranarray, lambda a: np.repeat(a, 2, 2)[..., ::2], lambda a: a.astype(np.int8),
                       lambda a: a.astype(np.float16), lambda a: a.tolist()):
            self.assertEqual(bvlab.boxes(layout(BOXES)).answers.tolist(), [[0, 0, 1]])

    def test_arrays_freed_by_another_thread(self):
        box = {"trace": np.random.default_rng(1).random((40, 2000, 6))}
        box["trace"][..., 3:] = box["trace"][..., :3] + 0.02
        wanted = bvlab.boxes(box["trace"].copy()).answers
        free = threading.Timer(0.005, box.clear)
        free.start()
        np.testing.assert_array_equal(bvlab.boxes(box["trace"]).answers, wanted)
        free.join()


class Poses(unittest.TestCase):
    def test_orders(self):
        at, q = POSES[..., :3], POSES[..., 3:]
        np.testing.assert_array_equal(bvlab.poses(at, q, order="wxyz"), POSES)
        np.testing.assert_array_equal(bvlab.poses(at, np.roll(q, -1, -1), order="xyzw"), POSES)
        for order in (None, "zyxw", 3):
            with self.assertRaisesRegex(ValueError, "wxyz, xyzw"):
                bvlab.poses(at, q, order=order)

    def test_matrices(self):
        draw = np.random.default_rng(2)
        q = draw.normal(size=(50, 40, 4))
        q[0] = np.round(q[0])  # turns by right angles, and halves of them
        q[0, 0], q[0, 1:5] = [1, 0, 0, 0], np.eye(4)
        q[0][~q[0].any(-1)] = [1, 0, 0, 0]
        w, x, y, z = np.moveaxis(q / np.linalg.norm(q, axis=-1, keepdims=True), -1, 0)
        matrices = np.zeros((50, 40, 4, 4))
        matrices[..., :3, :3] = np.moveaxis(np.array([
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]), (0, 1), (2, 3))
        matrices[..., :3, 3], matrices[..., 3, 3] = draw.normal(size=(50, 40, 3)), 1
        poses = bvlab.poses(matrices)
        np.testing.assert_array_equal(poses[..., :3], matrices[..., :3, 3])
        same = np.abs((poses[..., 3:] * np.stack([w, x, y, z], -1)).sum(-1))
        np.testing.assert_allclose(same, 1, atol=1e-15)
        for change in (lambda m: m * 1.001, lambda m: m * [[-1, 1, 1, 1]] * np.ones((4, 1)), lambda m: m * 0,
                       lambda m: m + np.eye(4) * [0, 0, 0, 1], lambda m: m * np.nan, lambda m: m[..., :3, :],
                       lambda m: m[0], lambda m: m.astype(complex)):
            with self.assertRaises(ValueError) as caught:
                bvlab.poses(change(matrices))
            self.assertRegex(str(caught.exception), "^matrices: [^\n]*$")

    def rotations(self, count):
        """Random ones, as matrices in their own right: products of reflections."""
        a, b = np.random.default_rng(4).normal(size=(2, count, 3, 1))
        turn = [np.eye(3) - 2 * v @ v.swapaxes(1, 2) / (v.swapaxes(1, 2) @ v) for v in (a, b)]
        return turn[0] @ turn[1]

    def matrices(self, rotations):
        all_of_them = np.tile(np.eye(4), (1, len(rotations), 1, 1))
        all_of_them[0, :, :3, :3] = rotations
        return all_of_them

    def rotated(self, poses):
        """The matrices of the quaternions."""
        w, x, y, z = np.moveaxis(poses[0, :, 3:], -1, 0)
        return np.moveaxis(np.array([
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]), -1, 0)

    def test_matrices_of_few_digits(self):
        """The nearest rotation, by Frobenius' norm: no small turn of it is nearer."""
        rotations = self.rotations(1000)
        products = np.eye(3, dtype=np.float32)[None].repeat(50, 0)
        for each in rotations.astype(np.float32):
            products = products @ each
        turns = [np.eye(3) + np.cross(np.eye(3), 1e-6 * axis * sign) for axis in np.eye(3) for sign in (-1, 1)]
        for given, tolerance in ((rotations.round(6), None), (rotations.round(4), None), (products, None),
                                 (rotations.round(2), 0.02), (rotations * 1.0002, None), (rotations * 1.05, 0.06)):
            more = {} if tolerance is None else {"tolerance": tolerance}
            given = np.asarray(given, float)
            nearest = self.rotated(bvlab.poses(self.matrices(given), **more))
            np.testing.assert_allclose(nearest @ nearest.swapaxes(1, 2), np.eye(3)[None].repeat(len(given), 0), atol=1e-14)
            self.assertGreater(np.linalg.det(nearest).min(), 0)
            away = np.linalg.norm(nearest - given, axis=(1, 2))
            for turn in turns:
                self.assertTrue((np.linalg.norm(turn @ nearest - given, axis=(1, 2)) > away - 1e-15).all())

    def test_matrices_that_are_no_rotations(self):
        """Each with the size of what is wrong, and where."""
        turn = self.rotations(2)[1]
        shear = np.eye(3) + [[0, 0.1, 0], [0, 0, 0], [0, 0, 0]]
        for bad, said in ((2 * turn, "scaled by 2 "), (1.001 * turn, "scaled by 1.001 "), (1e200 * turn, "scaled by 1e+200 "),
                          (turn * [1, 2, 3], "scaled by 1, 2, 3 along its own axes "),
                          ((turn.T * [1, 2, 3]).T, "scaled by 1, 2, 3 along the world's axes "),
                          (-turn, "mirrored: its determinant is -1 "), (turn * [1, 1, -1], "mirrored: its determinant is -1 "),
                          (-2 * turn, "mirrored: its determinant is -8 and scaled by 2 "),
                          (turn @ shear, "sheared: two of its axes are 84.29 degrees apart"),
                          (turn @ (np.eye(3) + (shear - np.eye(3)) / 99), "sheared: two of its axes are 89.94 degrees apart"),
                          (0 * turn, "flat: its determinant is 0 "), (turn * [1, 1, 0], "flat: its determinant is 0 ")):
            with self.subTest(said), self.assertRaises(ValueError) as caught:
                bvlab.poses(self.matrices(np.stack([turn, turn, bad, bad])))
            self.assertRegex(str(caught.exception), r"^matrices: no rotation in frame 0, object 2: [^\n]* "
                                                    r"\(lengths may change by 0.0005 of themselves: tolerance\)$")
            self.assertIn(f": {said}", str(caught.exception))
        for tolerance in (-1, 1, np.nan, np.inf, "x", [1], 10**400):
            with self.assertRaisesRegex(ValueError, "^tolerance: a number from 0 on and below 1"):
                bvlab.poses(self.matrices(turn[None]), tolerance=tolerance)
        with self.assertRaisesRegex(ValueError, "^tolerance: is of matrices"):
            bvlab.poses(POSES[..., :3], POSES[..., 3:], order="wxyz", tolerance=0.1)
        with self.assertRaisesRegex(ValueError, "no rotation"):
            bvlab.poses(self.matrices(turn[None].round(6)), tolerance=0)
        np.testing.assert_array_equal(bvlab.poses(self.matrices(np.eye(3)[None]), tolerance=0)[0, 0, 3:], [1, 0, 0, 0])

    def test_hostile(self):
        at, q = POSES[..., :3], POSES[..., 3:]
        for positions, quaternions in ((at[0], q), (at, q[:, :1]), (at, q * 0), (at * np.nan, q), (at, q * np.inf),
                                       ("x", q), (at, None), (at.astype(complex), q), (at.astype(object), q), (q, at)):
            with self.assertRaises(ValueError) as caught:
                bvlab.poses(positions, quaternions, order="wxyz")
            self.assertNotIn("\n", str(caught.exception))


if __name__ == "__main__":
    unittest.main()
