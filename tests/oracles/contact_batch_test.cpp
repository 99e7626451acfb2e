// SPDX-License-Identifier: BSD-3-Clause
/// The test of triangles where all hits are sought: its first phase keeps every pair that shares a
/// point, at any scale, however closely; the second returns what the filter of triangles says.
#include "traversal/wide/contact_batch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <vector>

#include "hierarchies/wide/slab_box_sibling_test.hpp"
#include "traversal/primitives/triangle_intersection.hpp"

namespace bvlab {
namespace {

constexpr int F = 4;
using S = Batch<float, F>;
using Random = std::mt19937_64;

double unit(Random& random) { return std::uniform_real_distribution<double>(-1, 1)(random); }

Vec3<double> point(Random& random, double scale) {
  return scale * Vec3<double>(unit(random), unit(random), unit(random));
}

/// Two bodies of F triangles. Those of b, in the frame of a, have a corner in common with one of a,
/// or in its plane, or beside it by few roundings, or are anywhere.
struct Bodies {
  std::vector<Triangle> a, b;
  Pose pose_a, pose_b;
  double reach_a = 0, reach_b = 0;

  Bodies(Random& random, double scale, double thin) {
    const auto pose = [&] {
      return *pose_from(point(random, 4 * scale), unit(random), unit(random), unit(random), 2);
    };
    pose_a = pose(), pose_b = pose();
    for (int k = 0; k < F; ++k) {
      const Vec3<double> at = point(random, scale), u = point(random, scale),
                         v = point(random, scale);
      a.push_back({at, at + u, at + thin * v + (1 - thin) * u});
      const Triangle& t = a[random() % a.size()];
      const double p = (unit(random) + 1) / 2, q = (unit(random) + 1) / 2 * (1 - p);
      const Vec3<double> in_plane = t[0] + p * (t[1] - t[0]) + q * (t[2] - t[0]);
      const Vec3<double> normal = (t[1] - t[0]).cross(t[2] - t[0]);
      const double aside = random() % 2 ? 0 : 0x1p-24 * unit(random);
      const Vec3<double> from = (random() % 3 ? in_plane : t[random() % 3]) + aside * in_plane;
      const double up = normal.norm() > 0 ? scale / normal.norm() : 0;
      const auto beyond = [&] {
        return Vec3<double>(from + point(random, scale / 4) + up * std::abs(unit(random)) * normal);
      };
      b.push_back(to_b({from, beyond(), beyond()}));
    }
    for (const auto& t : a)
      for (const auto& x : t) reach_a = std::max(reach_a, x.norm() * (1 + 1e-6));
    for (const auto& t : b)
      for (const auto& x : t) reach_b = std::max(reach_b, x.norm() * (1 + 1e-6));
  }

  Triangle to_b(const Triangle& t) const {
    Triangle posed;
    for (std::size_t i = 0; i < 3; ++i)
      posed[i] = pose_b.rotation.transpose() * (pose_a(t[i]) - pose_b.translation);
    return posed;
  }
  bool meet(std::size_t i, std::size_t j) const { return intersect(pose_a(a[i]), pose_b(b[j])); }
};

TriangleLanes<float, F> lanes_of(const std::vector<Triangle>& triangles) {
  TriangleLanes<float, F> lanes;
  for (std::size_t k = 0; k < F; ++k) lanes.put(k, triangles[k]);
  return lanes;
}

struct Transformed {
  CornerTransform transform;
  TransformedLeaf<F> leaf;

  explicit Transformed(const Bodies& bodies) {
    const OrthonormalPose a(bodies.pose_a, bodies.reach_a), b(bodies.pose_b, bodies.reach_b);
    transform.begin(RelativePose(a, b), bodies.reach_a, bodies.reach_b);
    leaf.transform_all(lanes_of(bodies.a), transform);
  }
};

template <class Do>
void for_each_scene(Do&& what) {
  Random random(5);
  for (int round = 0; round < 20000; ++round) {
    const double scale = std::exp2(std::array{0, -30, 30, 115, -80, 101}[round % 6]);
    what(Bodies(random, scale, round % 4 ? 1 : std::exp2(-24 * (1 + unit(random)))));
  }
}

TEST(ContactBatch, FirstPhaseKeepsEveryPairThatMeets) {
  std::size_t met = 0, kept = 0, pairs = 0;
  for_each_scene([&](const Bodies& bodies) {
    const Transformed of_a(bodies);
    const Corners<S> corner = corners_in_lanes<S>(lanes_of(bodies.b));
    const TriangleBoxes<S> boxes(corner);
    for (std::size_t i = 0; i < F; ++i) {
      const std::uint64_t near = of_a.leaf.near(i, corner, boxes) & 15;
      pairs += F, kept += static_cast<std::size_t>(std::popcount(near));
      for (std::size_t j = 0; j < F; ++j)
        if (bodies.meet(i, j)) {
          ++met;
          ASSERT_TRUE(near >> j & 1) << i << ' ' << j;
        }
    }
  });
  EXPECT_GT(met, 20000u);
  EXPECT_LT(kept, pairs * 2 / 3);
}

TEST(ContactBatch, SlabBoxesKeepEveryTriangleThatMeets) {
  std::size_t met = 0, apart = 0;
  for_each_scene([&](const Bodies& bodies) {
    const Transformed of_a(bodies);
    for (std::size_t j = 0; j < F; ++j) {
      const auto& t = bodies.b[j];
      const auto box = SlabBox<float>::enclosing(std::span(t), std::span(&t, 1));
      const S gap = SiblingTestOf<SlabBox<float>>::triangle_gaps<S>(box, of_a.leaf);
      for (std::size_t i = 0; i < F; ++i) {
        apart += gap[i] > 0;
        if (!bodies.meet(i, j)) continue;
        ++met;
        ASSERT_FALSE(gap[i] > 0) << i << ' ' << j;
      }
    }
  });
  EXPECT_GT(met, 20000u);
  EXPECT_GT(apart, 20000u);
}

TEST(ContactBatch, SecondPhaseIsTheFilterOfEachPair) {
  ContactBatch batch;
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> expected, found;
  std::uint32_t first = 0;
  constexpr float off = 0x1p-18f;
  const auto decide = [&](ContactBatch::Decide which) {
    EXPECT_FALSE(batch.decide<S>(which, off, [&](std::uint32_t a, std::uint32_t b, bool meeting) {
      EXPECT_TRUE(found.emplace(std::pair(a, b), meeting).second);
      return false;
    }));
  };
  Random random(6);
  for (int round = 0; round < 2000; ++round, first += F) {
    const Bodies bodies(random, 1, 1);
    const Transformed of_a(bodies);
    const auto a = of_a.leaf.corners(), b = lanes_of(bodies.b);
    std::uint64_t lanes = random() & 0xffff;
    if (batch.full()) decide(ContactBatch::Decide::full_registers);
    if (round % 2)
      batch.add(lanes, a, first, b, first);
    else
      batch.add(lanes &= 15, a, 0, first, b, first);
    for (; lanes; lanes &= lanes - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
      const std::uint32_t i = lane / 4, j = lane % 4;
      Corners<float> x, y;
      for (std::size_t k = 0; k < 9; ++k)
        x[k / 3][k % 3] = a.corner[k / 3][k % 3][i], y[k / 3][k % 3] = b.corner[k / 3][k % 3][j];
      const auto verdict = certainly_within<float>(x, y, off);
      if (!verdict.apart) expected[{first + i, first + j}] = verdict.meeting;
    }
  }
  decide(ContactBatch::Decide::all);
  EXPECT_TRUE(batch.empty());
  EXPECT_EQ(found, expected);
  EXPECT_GT(found.size(), 1000u);
}

}  // namespace
}  // namespace bvlab
