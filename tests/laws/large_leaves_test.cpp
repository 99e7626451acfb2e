// SPDX-License-Identifier: BSD-3-Clause
/// Leaves of any size: the same answers, and no more candidates held at once than for small ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "experiments/scenes/formula_mesh.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes/sphere.hpp"
#include "tests/types_of.hpp"
#include "traversal/bodies.hpp"
#include "traversal/budgeted.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies.hpp"

namespace bvlab {
namespace {

using V = Sphere<float>;
using B = Batch<float, 8>;

/// A query that notes how many candidates it is handed at once.
template <class Query>
struct Watched : Query {
  using Query::Query;
  std::size_t most = 0;

  Outcome primitives(std::span<const Candidate> pending) {
    most = std::max(most, pending.size());
    return Query::primitives(pending);
  }
  Outcome primitives(std::span<const Candidate> pending, std::span<Verdict> verdicts) {
    most = std::max(most, pending.size());
    return Query::primitives(pending, verdicts);
  }
};

struct Two {
  Hierarchy<V> hierarchy;
  Body<V> a, b;
  Workspace workspace;

  Two(const TriangleMesh& mesh, std::uint32_t leaf_size)
      : hierarchy(mesh, builds::TopDownPrincipal::topology(mesh, leaf_size)),
        a(mesh, hierarchy),
        b(mesh, hierarchy) {}

  template <class Query, class Counter>
  BodyPair<B, V, Query, Counter> pair(Query& query, Counter& counter) {
    return {a, b, query, counter, workspace};
  }
};

template <class Strategy>
class LargeLeaves : public testing::Test {};
TYPED_TEST_SUITE(LargeLeaves, TypesOf<Strategies>);

/// 300 triangles in one leaf: 90 000 candidates, or in a few.
TYPED_TEST(LargeLeaves, AnswerAsSmallOnesDoAndHoldNoMore) {
  const TriangleMesh mesh = formula_mesh("star", 300);
  for (const std::uint32_t leaf_size : {40u, 100u, 65536u}) {
    Two small(mesh, 1), large(mesh, leaf_size);
    TypeParam touching_strategy, contacts_strategy, distance_strategy;
    std::mt19937_64 random(leaf_size);
    std::uniform_real_distribution<double> unit(-1, 1);
    NotCounting counter;
    Pose pose;
    double angle = 0;
    Vec3<double> place(2, 0.1, 0.2);
    int touching = 0;
    for (int frame = 0; frame < 120; ++frame) {
      // Little steps, sometimes back, sometimes none; and a jump now and then.
      const double step = frame % 30 == 29 ? 1 : frame % 5 == 0 ? 0 : 0.01;
      place += step * Vec3<double>(unit(random) - 0.3 * place[0], unit(random), unit(random));
      angle += step * unit(random);
      pose = *pose_from(place, std::cos(angle), 0.3 * std::sin(angle), 0.5 * std::sin(angle), 0.1);
      for (Two* bodies : {&small, &large}) {
        bodies->a.move(Pose{}, Vec3<double>::Zero());
        bodies->b.move(pose, Vec3<double>::Zero());
      }
      Touching expected;
      Recursive().run(small.pair(expected, counter));
      touching += expected.touching();
      Watched<Touching> touch;
      touching_strategy.run(large.pair(touch, counter));
      ASSERT_EQ(touch.touching(), expected.touching()) << frame;

      std::vector<Contact> all, found;
      Contacts expected_contacts(all);
      Recursive().run(small.pair(expected_contacts, counter));
      Watched<Contacts> contacts(found);
      contacts_strategy.run(large.pair(contacts, counter));
      std::sort(all.begin(), all.end());
      std::sort(found.begin(), found.end());
      ASSERT_EQ(found, all) << frame;

      Distance expected_distance;
      Recursive().run(small.pair(expected_distance, counter));
      Watched<Distance> distance;
      distance_strategy.run(large.pair(distance, counter));
      ASSERT_NEAR(distance.distance(), expected_distance.distance(),
                  0x1p-44 * expected_distance.distance())
          << frame;
      for (const std::size_t most : {touch.most, contacts.most, distance.most})
        ASSERT_LE(most, 5000u) << frame;
    }
    EXPECT_GT(touching, 20);
    EXPECT_LT(touching, 100);
  }
}

/// A hit in the first portion of a leaf says nothing of the others, which are looked at again.
TEST(LargeLeavesWithMargins, AreLookedAtAgainWhereAHitCutThemShort) {
  const TriangleMesh mesh = formula_mesh("star", 300);
  Two bodies(mesh, 65536), small(mesh, 1);
  NotCounting counter;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int round = 0; round < 20; ++round) {
    Margins margins;
    Vec3<double> place = 0.6 * Vec3<double>(unit(random), unit(random), unit(random));
    const Vec3<double> way = Vec3<double>(unit(random), unit(random), unit(random));
    for (int frame = 0; frame < 30; ++frame) {
      const Pose pose{Mat3<double>::Identity(), place + std::abs(frame - 15) * 0.1 * way};
      for (Two* both : {&small, &bodies}) {
        both->a.move(Pose{}, Vec3<double>::Zero());
        both->b.move(pose, Vec3<double>::Zero());
      }
      Touching expected, found;
      Recursive().run(small.pair(expected, counter));
      margins.run(bodies.pair(found, counter));
      ASSERT_EQ(found.touching(), expected.touching()) << round << ' ' << frame;
    }
  }
}

std::size_t tested = 0;
std::uint64_t counted_test(const Triangle* const* a, const Triangle* const* b, int count) {
  tested += static_cast<std::size_t>(count);
  return intersect_batch<Exact>(a, b, count);
}

TEST(LargeLeavesWithinABudget, HoldNoMore) {
  constexpr int W = width<B>();
  const TriangleMesh mesh = formula_mesh("star", 300);
  Two bodies(mesh, 65536);
  const PatchSizes sizes(mesh, bodies.hierarchy);
  Budgeted<W> budgeted;
  NotCounting counter;
  bodies.a.move(Pose{}, Vec3<double>::Zero());
  for (const auto& [x, touches] : {std::pair(0.0, true), {0.3, true}, {1.9, false}}) {
    bodies.b.move(Pose{Mat3<double>::Identity(), {x, 0, 0}}, Vec3<double>::Zero());
    tested = 0;
    const auto answer =
        budgeted(bodies.a, sizes, bodies.b, sizes, tests_between<W, V, Touching>, 1000,
                 counted_test, counter);
    EXPECT_EQ(answer.verdict, touches ? BudgetVerdict::touching : BudgetVerdict::apart) << x;
    if (touches) {
      EXPECT_LT(tested, 45000u);
    }
    // The same by a query that notes what it is handed.
    Watched<Touching> query(counted_test);
    std::vector<PairOfPatches> queue;
    traverse<W>(bodies.a, bodies.b,
                tests_between<W, V, Watched<Touching>>(bodies.a, bodies.b, bodies.workspace), query,
                bodies.workspace, LargestFirst(sizes, sizes, 1000, queue));
    EXPECT_EQ(query.touching(), touches) << x;
    EXPECT_GT(query.most, 0u);
    EXPECT_LE(query.most, 5000u);
  }
}

}  // namespace
}  // namespace bvlab
