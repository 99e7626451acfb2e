# SPDX-License-Identifier: BSD-3-Clause
"""World against replay: pairs that touch, contacts and distances, of any volume and strategy, some bodies moving."""

import unittest

import numpy as np

import bvlab
import scenes


def compiled():
    """Every strategy once, and what is recommended."""
    yield {}
    for strategy in bvlab.strategies():
        yield {"strategy": strategy}
    for volume in bvlab.volumes():
        yield {"volume": volume}


class Worlds(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.meshes = [bvlab.Mesh(*scenes.torus()), bvlab.Mesh(*scenes.torus(8, 6, 0.5))]
        poses = scenes.walk(frames=10, objects=7, side=2.5, step=0.3)
        # In most frames few bodies move.
        stays = np.random.default_rng(5).random((10, 7)) < 0.5
        for frame in range(1, 10):
            poses[frame, stays[frame]] = poses[frame - 1, stays[frame]]
        cls.poses = poses
        replay = {query: bvlab.replay(cls.meshes, poses, query=query).answers
                  for query in ("touching", "contacts", "distance")}
        cls.pairs = bvlab.pairs_of(7)
        cls.replay = replay

    def check(self, world, frame):
        touching = self.pairs[self.replay["touching"][frame] == 1]
        np.testing.assert_array_equal(world.touching(), touching)

    def test_any_volume_and_strategy(self):
        for options in compiled():
            with self.subTest(**options):
                try:
                    world = bvlab.World(self.meshes, objects=7, **options)
                except ValueError as fault:
                    self.assertRegex(str(fault), "unknown; available")
                    continue
                for frame, poses in enumerate(self.poses):
                    for i in range(7):
                        world.move(i, poses[i])
                    world.update()
                    self.check(world, frame)

    def test_long_triangles_change_trees_on_the_way(self):
        vertices, faces = scenes.torus(16, 12)
        plate = bvlab.Mesh(vertices * [40, 1, 1], faces)
        poses = scenes.walk(frames=400, objects=5, side=2.5, step=0.3)
        once = bvlab.World(plate, objects=5, kernel="mixed", frame="body", fan_out=4, volume="obb")
        world = bvlab.World(plate, objects=5)
        left = world.add(plate)
        world.move(left, [1, 0, 0, 0, 0, 0, 1])
        world.update()
        world.remove(left)
        touching = 0
        for frame in poses:
            for each in (once, world):
                each.move(np.arange(5), frame)
                each.update()
            np.testing.assert_array_equal(world.touching(), once.touching())
            touching += len(world.touching())
        self.assertGreater(touching, 100)
        np.testing.assert_array_equal(world.contacts(), once.contacts())

    def test_contacts_and_distances(self):
        for options in ({"volume": "obb"}, {"kernel": "siblings", "volume": "slab-box"},
                        {"fan_out": 8, "frame": "body", "volume": "obb"}):
            world = bvlab.World(self.meshes, objects=7, **options)
            for frame, poses in enumerate(self.poses):
                world.move(np.arange(7), poses)
                world.update()
                self.check(world, frame)
                contacts = self.replay["contacts"]
                np.testing.assert_array_equal(world.contacts(), contacts[contacts[:, 0] == frame][:, 1:])
                for below in (0, 0.3, 1.0, np.inf):
                    pairs, distances = world.distances(below)
                    all_of_them = self.replay["distance"][frame]
                    np.testing.assert_array_equal(pairs, self.pairs[all_of_them <= below])
                    # By other volumes: as near as distances are promised, see traversal/queries/distance.hpp.
                    np.testing.assert_allclose(distances, all_of_them[all_of_them <= below], rtol=2**-44, atol=0)

    def test_nearest_pairs(self):
        world = bvlab.World(self.meshes, objects=7, volume="obb")
        world.move(np.arange(7), self.poses[0])
        world.update()
        pairs, distances = world.distances(np.inf)
        again, same, nearest = world.distances(np.inf, nearest=True)
        np.testing.assert_array_equal(again, pairs)
        np.testing.assert_array_equal(same, distances)
        self.assertEqual(nearest.shape, (len(pairs),))
        apart = nearest["points"][:, 1] - nearest["points"][:, 0]
        np.testing.assert_allclose(np.linalg.norm(apart, axis=1), distances, atol=1e-13)
        result = bvlab.replay(self.meshes, self.poses, query="distance", volume="obb", nearest=True)
        self.assertEqual(result.nearest.shape, result.answers.shape)
        np.testing.assert_array_equal(result.pairs, bvlab.pairs_of(7))
        apart = result.nearest["points"][..., 1, :] - result.nearest["points"][..., 0, :]
        np.testing.assert_allclose(np.linalg.norm(apart, axis=-1), result.answers, atol=1e-13)
        self.assertIsNone(bvlab.replay(self.meshes, self.poses, query="distance").nearest)
        with self.assertRaisesRegex(ValueError, "nearest"):
            bvlab.replay(self.meshes, self.poses, nearest=True)

    def test_chosen_pairs(self):
        chosen = {"without": [(1, 0), (2, 3)], "groups": [4, 4, 4, -1, -1, 5, 5]}
        kept = [pair for pair in bvlab.pairs_of(7).tolist()
                if pair not in ([0, 1], [0, 2], [1, 2], [2, 3], [5, 6])]
        world = bvlab.World(self.meshes, objects=7, volume="obb", **chosen)
        whole = bvlab.World(self.meshes, objects=7, volume="obb")
        for poses in self.poses:
            for each in (world, whole):
                each.move(np.arange(7), poses)
                each.update()
            self.assertEqual(world.touching().tolist(), [p for p in whole.touching().tolist() if p in kept])
            self.assertEqual(world.distances(np.inf)[0].tolist(), kept)
        result = bvlab.replay(self.meshes, self.poses, volume="obb", **chosen)
        self.assertEqual(result.pairs.tolist(), kept)
        everything = bvlab.replay(self.meshes, self.poses, volume="obb")
        columns = [everything.pairs.tolist().index(pair) for pair in kept]
        np.testing.assert_array_equal(result.answers, everything.answers[:, columns])
        asked = bvlab.replay(self.meshes, self.poses, volume="obb", pairs=[[5, 2], [0, 1]])
        self.assertEqual(asked.pairs.tolist(), [[2, 5], [0, 1]])
        for wrong, message in (({"pairs": [[0, 7]]}, "pairs: row 0: no object 7; there are 7"),
                               ({"pairs": [[0, 1], [1, 0]]}, "pairs: row 1: the same pair as in row 0"),
                               ({"without": [[3, 3]]}, "without: row 0: object 3 with itself"),
                               ({"groups": [1]}, "groups: has groups of 1 objects; there are 7"),
                               ({"pairs": [0, 1]}, "pairs")):
            with self.assertRaisesRegex(ValueError, message):
                bvlab.replay(self.meshes, self.poses, **wrong)
            with self.assertRaisesRegex(ValueError, message):
                bvlab.World(self.meshes, objects=7, **wrong)

    def test_answers_are_those_of_the_last_update(self):
        mesh = bvlab.Mesh(*scenes.torus())
        world = bvlab.World([mesh, mesh, mesh])
        at = np.array([0, 0, 0, 1, 0, 0, 0.0])
        world.move([0, 1], [at, at])
        self.refuses(world, "World: there was no update yet; call update\\(\\) first")
        world.update()
        self.assertEqual(world.touching().tolist(), [[0, 1]])
        self.assertGreater(len(world.contacts()), 0)
        since = "World: bodies were moved, added or removed since the last update; call update\\(\\) first"
        world.move(1, at + [9, 0, 0, 0, 0, 0, 0])
        self.refuses(world, since)
        world.update()
        self.assertEqual(world.touching().tolist(), [])
        self.assertEqual(len(world.contacts()), 0)
        world.move(np.int64(2), at)
        world.update()
        self.assertEqual(world.touching().tolist(), [[0, 2]])
        self.assertEqual(world.distances(9)[0].tolist(), [[0, 1], [0, 2], [1, 2]])
        world.remove(2)
        self.refuses(world, since)
        world.update()
        self.assertEqual(world.touching().tolist(), [])
        self.assertEqual(world.distances(9)[0].tolist(), [[0, 1]])
        self.assertEqual(len(world), 3)

    def refuses(self, world, why):
        """All questions alike."""
        for ask in (world.touching, world.contacts, lambda: world.distances(1), lambda: world.near, lambda: world.queried):
            self.assertRaisesRegex(RuntimeError, f"^{why}$", ask)

    def test_a_world_that_grows_and_shrinks(self):
        """Bodies that come one after the other, some of a mesh of their own, and leave for a while."""
        meshes = [*self.meshes, bvlab.Mesh(*scenes.torus(10, 5, 0.3))]
        of = [0, 1, 0, 2, 1, 2, 0]
        alone = {query: bvlab.replay([meshes[k] for k in of], self.poses, query=query).answers
                 for query in ("touching", "contacts", "distance")}
        for first, options in ((0, {}), (2, {}), (2, {"volume": "obb", "strategy": list(bvlab.strategies())[-1]}),
                               (3, {"fan_out": 8, "frame": "body", "threads": 2})):
            world, present = bvlab.World([meshes[k] for k in of[:first]], **options), set(range(first))
            for frame, poses in enumerate(self.poses):
                if len(world) < 7 and frame % 2:
                    body = len(world)
                    pose = poses[body] if frame % 4 == 1 else None
                    self.assertEqual(world.add(meshes[of[body]], pose), body)
                    present |= {body}
                gone = frame % len(world) if frame > 4 else None
                for body in range(len(world)):
                    if body == gone:
                        world.remove(body)
                    else:
                        world.move(body, poses[body])
                world.update()
                here = present - {gone}
                are_here = np.isin(self.pairs, list(here)).all(axis=1)
                wanted = (alone["touching"][frame] == 1) & are_here
                np.testing.assert_array_equal(world.touching(), self.pairs[wanted])
                contacts = alone["contacts"][alone["contacts"][:, 0] == frame][:, 1:]
                np.testing.assert_array_equal(world.contacts(), contacts[np.isin(contacts[:, :2], list(here)).all(axis=1)])
                pairs, distances = world.distances(1)
                near = (alone["distance"][frame] <= 1) & are_here
                np.testing.assert_array_equal(pairs, self.pairs[near])
                np.testing.assert_allclose(distances, alone["distance"][frame][near], rtol=2**-44, atol=0)

    def test_what_is_added(self):
        mesh = bvlab.Mesh(*scenes.torus())
        at = np.array([0, 0, 0, 1, 0, 0, 0.0])
        for world in (bvlab.World(), bvlab.World([]), bvlab.World(mesh, objects=0)):
            self.assertEqual(len(world), 0)
            world.update()
            self.assertEqual(world.touching().shape, (0, 2))
            for bad, pose in ((None, at), (3, at), (mesh, at[:6]), (mesh, at * np.nan), (mesh, 0 * at), ([mesh], at)):
                self.assertRaises(ValueError, world.add, bad, pose)
            self.assertEqual(len(world), 0)
            self.assertEqual(world.touching().shape, (0, 2))  # nothing has changed
            self.assertRaises(IndexError, world.move, 0, at)
            self.assertEqual([world.add(mesh, at), world.add(bvlab.Mesh(mesh)), world.add(mesh, pose=at + 0.01)], [0, 1, 2])
            self.refuses(world, "World: bodies were .*")
            world.update()
            self.assertEqual(world.touching().tolist(), [[0, 2]])
            world.remove(0)
            world.move(1, at)
            world.update()
            self.assertEqual(world.touching().tolist(), [[1, 2]])
            self.assertEqual(world.distances(1)[0].tolist(), [[1, 2]])
            self.assertEqual(world.add(mesh), 3)
        self.assertRaisesRegex(ValueError, "meshes: at least one", bvlab.World, objects=2)
        kept = bvlab.World()
        kept.add(bvlab.Mesh(*scenes.torus()), at)
        kept.add(bvlab.Mesh(*scenes.torus()), at)
        kept.update()
        self.assertGreater(len(kept.contacts()), 0)

    def test_many_come_and_go(self):
        """A thousand bodies of two meshes, of which a few are there at a time: answers are those of who is there."""
        meshes, random = [bvlab.Mesh(*scenes.torus(6, 4)), bvlab.Mesh(*scenes.torus(5, 4))], np.random.default_rng(3)
        world, there = bvlab.World(), {}
        for step in range(60):
            for _ in range(16):
                pose = np.concatenate([random.uniform(-4, 4, 3), random.normal(size=4)])
                there[world.add(meshes[step % 2], pose)] = meshes[step % 2], pose
            for body in random.choice(list(there), min(len(there), 18 if step > 2 else 0), replace=False):
                world.remove(body)
                del there[int(body)]
            world.update()
            if not there:
                continue
            bodies = sorted(there)
            wanted = bvlab.replay([there[b][0] for b in bodies], np.stack([there[b][1] for b in bodies])[None]).answers[0]
            np.testing.assert_array_equal(world.touching(), np.array(bodies)[bvlab.pairs_of(len(bodies))[wanted == 1]])

    def test_meshes_and_arrays_may_be_freed(self):
        vertices, faces = scenes.torus()
        mesh = bvlab.Mesh(vertices, faces)
        seen = mesh.vertices
        world = bvlab.World([mesh, bvlab.Mesh(vertices, faces)], volume="obb")
        del mesh, vertices, faces
        world.move([0, 1], np.array([[0, 0, 0, 1, 0, 0, 0], [0.1, 0, 0, 1, 0, 0, 0]]))
        world.update()
        self.assertEqual(world.touching().tolist(), [[0, 1]])
        self.assertTrue(np.isfinite(seen).all())
        contacts = world.contacts()
        del world
        self.assertGreater(contacts.sum(), 0)

    def test_a_list_that_repeats_itself_is_its_first_part(self):
        a, b = self.meshes
        poses = self.poses[:, :6]
        once = bvlab.replay([a, b], poses, count=True)
        again = bvlab.replay([a, b, a, b, a, b], poses, count=True)
        np.testing.assert_array_equal(once.answers, again.answers)
        self.assertEqual(once.n_v, again.n_v)
        world = bvlab.World([a, b] * 3)
        self.assertEqual(len(world), 6)


if __name__ == "__main__":
    unittest.main()
