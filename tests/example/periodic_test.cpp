// SPDX-License-Identifier: BSD-3-Clause
/// The example of traversal/adding_a_strategy.md: a strategy from outside gives every answer, and
/// its front partitions the pairs of leaves.
#include "tests/example/periodic.hpp"

#include <gtest/gtest.h>

#include <set>

#include "experiments/scenes/formula_mesh.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes/sphere.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies/recursive.hpp"

namespace bvlab {
namespace {

using V = Sphere<float>;

std::vector<Pose> poses_at(int frame) {
  return {*pose_from({0, 0, 0}, 1, 0, 0, 0),
          *pose_from({2.5 - 0.03 * frame, 0.1, 0}, 1, 0.01 * frame, 0.3, 0)};
}

template <class Strategy>
std::vector<Contact> contacts_by(const TriangleMesh& mesh, const Strategy& strategy) {
  const Hierarchy<V> hierarchy(mesh, builds::TopDownPrincipal::topology(mesh, 1));
  const std::vector<Shape<V>> shapes(2, {&mesh, &hierarchy});
  AllPairs<Batch<float, 4>, V, Strategy> bodies(shapes, all_object_pairs(2), strategy);
  std::vector<Contact> found, all;
  NotCounting counter;
  for (int frame = 0; frame < 100; ++frame) {
    found.clear();
    bodies.frame(
        poses_at(frame), counter, [&](std::size_t) { return Contacts(found); },
        [](std::size_t, const Contacts&) {});
    std::sort(found.begin(), found.end());
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

TEST(Periodic, GivesTheContactsThatRecursionGives) {
  const TriangleMesh mesh = formula_mesh("torus", 400);
  const auto contacts = contacts_by(mesh, Recursive());
  EXPECT_GT(contacts.size(), 1000u);
  for (const unsigned period : {1u, 2u, 6u, 1000u})
    EXPECT_EQ(contacts_by(mesh, Periodic(period)), contacts) << period;
}

/// The leaves below a node, as places.
void leaves_below(const Hierarchy<V>& hierarchy, std::uint32_t node,
                  std::vector<std::uint32_t>& out) {
  if (hierarchy.is_leaf(node)) return out.push_back(node);
  leaves_below(hierarchy, hierarchy.node(node).first, out);
  leaves_below(hierarchy, hierarchy.node(node).first + 1, out);
}

TEST(Periodic, ItsFrontIsAPartition) {
  const TriangleMesh mesh = formula_mesh("torus", 64);
  const Hierarchy<V> hierarchy(mesh, builds::TopDownPrincipal::topology(mesh, 1));
  const std::vector<Shape<V>> shapes(2, {&mesh, &hierarchy});
  AllPairs<Batch<float, 4>, V, Periodic> bodies(shapes, all_object_pairs(2), Periodic(6));
  NotCounting counter;
  for (int frame = 0; frame < 60; ++frame) {
    bodies.frame(
        poses_at(frame), counter, [](std::size_t) { return Touching(); },
        [](std::size_t, const Touching&) {});
    std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
    std::size_t below = 0;
    for (const auto& [a, b] : bodies.strategy(0).front().entries()) {
      std::vector<std::uint32_t> of_a, of_b;
      leaves_below(hierarchy, a, of_a), leaves_below(hierarchy, b, of_b);
      for (const auto i : of_a)
        for (const auto j : of_b) seen.emplace(i, j), ++below;
    }
    ASSERT_EQ(below, mesh.triangles.size() * mesh.triangles.size()) << frame;
    ASSERT_EQ(seen.size(), below) << frame;
  }
}

}  // namespace
}  // namespace bvlab
