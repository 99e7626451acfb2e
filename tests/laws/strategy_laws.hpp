// SPDX-License-Identifier: BSD-3-Clause
/// What a strategy must keep, whatever it is: the answers of recursion in every frame, for queries
/// that take turns, over rests and jumps; and, where it shows a front, that this is a partition of
/// the pairs of leaves. A strategy is made as the program makes it without a parameter.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "experiments/scenes/formula_mesh.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes/sphere.hpp"
#include "tests/oracles/nearest_laws.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies/recursive.hpp"

namespace bvlab::strategy_laws {

using V = Sphere<float>;
using B = Batch<float, 4>;
constexpr int frames = 100;

inline std::vector<Pose> poses_at(int frame) {
  // They rest now and then, and a jump is among the steps.
  const double way = (frame < 50 ? 0.02 : 0.04) * (frame - frame % 5 / 3);
  return {*pose_from({0, 0, 0}, 1, 0, 0, 0), *pose_from({2.5 - way, 0.1, 0}, 1, 0.3 * way, 0.3, 0)};
}

struct Scene {
  explicit Scene(unsigned triangles)
      : mesh(formula_mesh("torus", triangles)),
        hierarchy(mesh, builds::TopDownPrincipal::topology(mesh, 1)) {}

  TriangleMesh mesh;
  Hierarchy<V> hierarchy;
  std::vector<Shape<V>> shapes{2, {&mesh, &hierarchy}};
};

template <class Strategy>
AllPairs<B, V, Strategy> bodies_of(const Scene& scene, const Strategy& strategy) {
  return {scene.shapes, all_object_pairs(2), strategy};
}

/// The contacts of all frames, in order.
template <class Engine, class Counter>
std::vector<Contact> contacts_by(Engine bodies, Counter& counter) {
  std::vector<Contact> found, all;
  for (int frame = 0; frame < frames; ++frame) {
    found.clear();
    bodies.frame(
        poses_at(frame), counter, [&](std::size_t) { return Contacts(found); },
        [](std::size_t, const Contacts&) {});
    std::sort(found.begin(), found.end());
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

/// What touching and distance say of a frame, asked in turn of the same strategy.
template <class Strategy>
std::vector<double> answers_by(const Scene& scene, const Strategy& prototype) {
  Bodies<B, V> bodies(scene.shapes);
  Strategy strategy(prototype);
  NotCounting counter;
  std::vector<double> all;
  for (int frame = 0; frame < frames; ++frame) {
    bodies.move(poses_at(frame), Vec3<double>::Zero());
    Touching touching;
    strategy.run(bodies.pair({0, 1}, touching, counter));
    Distance distance;
    strategy.run(bodies.pair({0, 1}, distance, counter));
    EXPECT_EQ(touching.touching(), distance.distance() == 0) << frame;
    const auto poses = poses_at(frame);
    expect_nearest(nearest_points(distance.nearest(), scene.mesh, poses[0], scene.mesh, poses[1]),
                   distance.distance(), scene.mesh, poses[0], scene.mesh, poses[1],
                   std::to_string(frame));
    all.push_back(distance.distance());
  }
  return all;
}

template <class Strategy>
void expect_answers_of_recursion(const Strategy& strategy) {
  const Scene scene(400);
  NotCounting counter;
  const auto contacts = contacts_by(bodies_of(scene, Recursive()), counter);
  EXPECT_GT(contacts.size(), 1000u);
  EXPECT_EQ(contacts_by(bodies_of(scene, strategy), counter), contacts);
  const auto distances = answers_by(scene, Recursive()), found = answers_by(scene, strategy);
  for (int frame = 0; frame < frames; ++frame)
    EXPECT_NEAR(found[frame], distances[frame], 0x1p-44 * distances[frame]) << frame;
}

/// The leaves below a node, as places.
inline void leaves_below(const Hierarchy<V>& hierarchy, std::uint32_t node,
                         std::vector<std::uint32_t>& out) {
  if (hierarchy.is_leaf(node)) return out.push_back(node);
  const auto& inner = hierarchy.node(node);
  for (std::uint32_t k = 0; k < 2; ++k) leaves_below(hierarchy, inner.first + k, out);
}

template <class Strategy>
concept ShowsAFront = requires(const Strategy& strategy) { strategy.front().entries(); };

template <class Strategy>
void expect_front_to_be_a_partition(const Strategy& strategy) {
  const Scene scene(64);
  auto bodies = bodies_of(scene, strategy);
  NotCounting counter;
  for (int frame = 0; frame < 60; ++frame) {
    bodies.frame(
        poses_at(frame), counter, [](std::size_t) { return Touching(); },
        [](std::size_t, const Touching&) {});
    std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
    std::size_t below = 0;
    for (const auto& [a, b] : bodies.strategy(0).front().entries()) {
      std::vector<std::uint32_t> of_a, of_b;
      leaves_below(scene.hierarchy, a, of_a), leaves_below(scene.hierarchy, b, of_b);
      for (const auto i : of_a)
        for (const auto j : of_b) seen.emplace(i, j), ++below;
    }
    ASSERT_EQ(below, scene.mesh.triangles.size() * scene.mesh.triangles.size()) << frame;
    ASSERT_EQ(seen.size(), below) << frame;
  }
}

}  // namespace bvlab::strategy_laws
