// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>

#include "broadphase/methods/auto.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes/obb.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/world.hpp"

using namespace bvlab;
using Volume = Obb<float>;      // float volumes are rounded outward, so they are safe
using Eight = Batch<float, 8>;  // eight tests at a time

int main() {
  // A tetrahedron: vertices, and triangles by their indices.
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                          {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  const Hierarchy<Volume> hierarchy(mesh, builds::BottomUpLocal::topology(mesh, 2), Fit::tight);
  NotCounting counter;

  // One pair: how far apart are two bodies?
  Body<Volume> a(mesh, hierarchy), b(mesh, hierarchy);
  a.move(pose_from({0, 0, 0}, 1, 0, 0, 0).value(), Vec3<double>::Zero());
  b.move(pose_from({3, 0, 0}, 1, 0, 0, 0.5).value(), Vec3<double>::Zero());
  Workspace workspace;
  Distance distance;
  traverse_from_roots<Eight>(a, b, distance, counter, workspace);
  std::printf("apart by %.6f\n", distance.distance());

  // Many bodies: which touch? Only those that moved, and are near others, are asked.
  const auto tree = Recommended::hierarchy(mesh);
  const std::vector<Recommended::Shape> shapes(100, {&mesh, &tree});
  World world(shapes);  // World(shapes, 2) has two threads
  TouchingPairs touching;
  for (int frame = 0; frame < 10; ++frame) {
    for (std::uint32_t i = 0; i < shapes.size(); ++i)
      world.move(i, pose_from({0.9 * i, 0.05 * frame * (i % 3), 0}, 1, 0, 0, 0.1 * i).value());
    world.update(
        counter, [](const ObjectPair&) { return Touching(); },
        [&](std::uint32_t slot, const ObjectPair& pair, const Touching& query) {
          touching.put(slot, pair, query.touching());
        },
        [&](std::uint32_t slot) { touching.drop(slot); });
  }
  std::printf("%zu pairs touch\n", touching.pairs().size());

  // Boxes alone: every overlapping pair, once.
  const std::vector<Box<float>> boxes{{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}};
  Auto<float, Closed> method{MethodSettings{}};
  for (const auto& [i, j] : method.overlapping(boxes))
    std::printf("boxes %u and %u overlap\n", i, j);
}
