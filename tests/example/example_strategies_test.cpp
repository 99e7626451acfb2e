// SPDX-License-Identifier: BSD-3-Clause
/// The examples of traversal/adding_a_strategy.md: strategies from outside, one of them with a
/// front of its own, give every answer, and their fronts partition the pairs of leaves.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>

#include "experiments/replay/loops_of.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes/sphere.hpp"
#include "tests/example/patient.hpp"
#include "tests/example/periodic.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies/recursive.hpp"

namespace bvlab {
namespace {

using V = Sphere<float>;
using B = Batch<float, 4>;
constexpr int frames = 100;

std::vector<Pose> poses_at(int frame) {
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

/// As the bvlab program has them: the loops from a strategy's own fronts compiled by themselves.
template <class Query, class Counter, class Strategy>
auto any_bodies_of(const Scene& scene, const Strategy& strategy) {
  using Bodies = AnyBodies<Query, Counter, typename Strategy::OwnFronts>;
  return AllPairsOf<Bodies, Strategy>(
      Bodies(std::make_unique<detail::LoopsOver<V, Query, TypeList<>>>(scene.shapes),
             own_loops_for<V, Query, Strategy>().loop),
      all_object_pairs(2), strategy);
}

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
    all.push_back(distance.distance());
  }
  return all;
}

template <class Strategy>
class ExampleStrategies : public testing::Test {};
using Examples = testing::Types<Periodic, Patient>;
TYPED_TEST_SUITE(ExampleStrategies, Examples);

TYPED_TEST(ExampleStrategies, GiveTheAnswersThatRecursionGives) {
  const Scene scene(400);
  NotCounting counter;
  const auto contacts = contacts_by(bodies_of(scene, Recursive()), counter);
  const auto distances = answers_by(scene, Recursive());
  EXPECT_GT(contacts.size(), 1000u);
  for (const unsigned period : {1u, 2u, 6u, 1000u}) {
    const TypeParam strategy(period);
    EXPECT_EQ(contacts_by(bodies_of(scene, strategy), counter), contacts) << period;
    const auto found = answers_by(scene, strategy);
    for (int frame = 0; frame < frames; ++frame)
      EXPECT_NEAR(found[frame], distances[frame], 0x1p-44 * distances[frame]) << period;
  }
}

/// The leaves below a node, as places.
void leaves_below(const Hierarchy<V>& hierarchy, std::uint32_t node,
                  std::vector<std::uint32_t>& out) {
  if (hierarchy.is_leaf(node)) return out.push_back(node);
  leaves_below(hierarchy, hierarchy.node(node).first, out);
  leaves_below(hierarchy, hierarchy.node(node).first + 1, out);
}

TYPED_TEST(ExampleStrategies, TheirFrontsArePartitions) {
  const Scene scene(64);
  auto bodies = bodies_of(scene, TypeParam(6));
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

/// The same front, tested less often: each test that is not made is one that was.
TEST(Patient, RestsWhereAListThatIsNotPatientTests) {
  const Scene scene(400);
  Bodies<B, V> bodies(scene.shapes);
  Periodic periodic(1000);
  Patient patient(1000);
  std::uint64_t saved = 0;
  for (int frame = 0; frame < frames; ++frame) {
    bodies.move(poses_at(frame), Vec3<double>::Zero());
    std::vector<Contact> found;
    Contacts query(found);
    Counting all, some;
    periodic.run(bodies.pair({0, 1}, query, all));
    const std::size_t rested = patient.front().rested();
    patient.run(bodies.pair({0, 1}, query, some));
    EXPECT_EQ(patient.front().rested() - rested, all.n_v - some.n_v) << frame;
    EXPECT_EQ(some.n_p, all.n_p);
    saved += all.n_v - some.n_v;
  }
  EXPECT_GT(saved, 10000u);
}

TEST(Patient, RunsInTheProgramFromLoopsOfItsOwn) {
  const Scene scene(400);
  Counting library, program;
  const auto contacts = contacts_by(bodies_of(scene, Patient(6)), library);
  const auto found = contacts_by(any_bodies_of<Contacts, Counting>(scene, Patient(6)), program);
  EXPECT_GT(contacts.size(), 1000u);
  EXPECT_EQ(found, contacts);
  EXPECT_EQ(program.n_p, library.n_p);
  // The program tests as many at a time as a register holds, which may be more.
  EXPECT_NEAR(static_cast<double>(program.n_v), static_cast<double>(library.n_v),
              0.01 * static_cast<double>(library.n_v));
}

}  // namespace
}  // namespace bvlab
