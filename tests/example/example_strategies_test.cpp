// SPDX-License-Identifier: BSD-3-Clause
/// The examples of traversal/adding_a_strategy.md: strategies from outside, one of them with a
/// front of its own, give every answer, and their fronts partition the pairs of leaves.
#include <gtest/gtest.h>

#include <memory>

#include "experiments/replay/bodies_of.hpp"
#include "tests/example/kinetic_list.hpp"
#include "tests/example/periodic.hpp"
#include "tests/laws/strategy_laws.hpp"

namespace bvlab {
namespace {

using namespace strategy_laws;

/// As the bvlab program has them.
template <class Query, class Strategy>
auto any_bodies_of(const Scene& scene, const Strategy& strategy) {
  return AllPairsOf<StrategyPairs<AnyBodies<Query>, Strategy>>(
      {AnyBodies<Query>(std::make_unique<detail::BodiesOver<V, Query>>(scene.shapes, Frame::world)),
       strategy},
      all_object_pairs(2));
}

template <class Strategy>
class ExampleStrategies : public testing::Test {};
using Examples = testing::Types<Periodic, KineticList>;
TYPED_TEST_SUITE(ExampleStrategies, Examples);

TYPED_TEST(ExampleStrategies, GiveTheAnswersThatRecursionGives) {
  for (const unsigned period : {1u, 2u, 6u, 1000u}) expect_answers_of_recursion(TypeParam(period));
}

TYPED_TEST(ExampleStrategies, TheirFrontsArePartitions) {
  static_assert(ShowsAFront<TypeParam>);
  expect_front_to_be_a_partition(TypeParam(6));
}

/// The same front, tested less often: each test that is not made is one that was.
TEST(KineticList, RestsWhereAListThatTests) {
  const Scene scene(400);
  Bodies<B, V> bodies(scene.shapes);
  Periodic periodic(1000);
  KineticList kinetic(1000);
  std::uint64_t saved = 0;
  for (int frame = 0; frame < frames; ++frame) {
    bodies.move(poses_at(frame), Vec3<double>::Zero());
    std::vector<Contact> found;
    Contacts query(found);
    Counting all, some;
    periodic.run(bodies.pair({0, 1}, query, all));
    const std::size_t rested = kinetic.front().rested();
    kinetic.run(bodies.pair({0, 1}, query, some));
    EXPECT_EQ(kinetic.front().rested() - rested, all.n_v - some.n_v) << frame;
    EXPECT_EQ(some.n_p, all.n_p);
    saved += all.n_v - some.n_v;
  }
  EXPECT_GT(saved, 10000u);
}

TEST(KineticList, RunsInTheProgramFromAFrontOfItsOwn) {
  const Scene scene(400);
  Counting library, program;
  const auto contacts = contacts_by(bodies_of(scene, KineticList(6)), library);
  const auto found = contacts_by(any_bodies_of<Contacts>(scene, KineticList(6)), program);
  EXPECT_GT(contacts.size(), 1000u);
  EXPECT_EQ(found, contacts);
  EXPECT_EQ(program.n_p, library.n_p);
  // The program tests as many at a time as a register holds, which may be more.
  EXPECT_NEAR(static_cast<double>(program.n_v), static_cast<double>(library.n_v),
              0.01 * static_cast<double>(library.n_v));
}

}  // namespace
}  // namespace bvlab
