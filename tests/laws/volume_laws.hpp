// SPDX-License-Identifier: BSD-3-Clause
/// The laws of bounding_volume.hpp, for every entry of Volumes, in float and double, scalar and
/// batch, on hostile clouds of points under hostile poses. One volume is compiled at a time.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <iomanip>
#include <random>
#include <sstream>
#include <string>

#include "hierarchies/bounding_volume.hpp"
#include "tests/types_of.hpp"
#include "traversal/gather.hpp"

namespace bvlab {
namespace {

using Points = std::vector<Vec3<double>>;

/// Reproducible hostility.
class Hostile {
 public:
  explicit Hostile(std::uint64_t seed) : random_(seed) {}

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }

  /// One point to forty: round, flat, needle-like, all the same, on a grid; tiny to huge, near the
  /// origin or far from it.
  Points cloud() {
    const double scale = std::pow(10.0, uniform(-12, 12));
    Vec3<double> stretch = Vec3<double>::Ones();
    const int shape = below(5);
    if (shape == 1) stretch[below(3)] = 0;
    if (shape == 2) stretch = Vec3<double>::Unit(below(3));
    if (shape == 3) stretch.setZero();
    Vec3<double> offset = Vec3<double>::Zero();
    if (below(2)) offset = direction() * scale * std::pow(10.0, uniform(-1, 8));
    const Mat3<double> turn = below(2) ? rotation() : Mat3<double>::Identity();
    Points points;
    for (int i = 1 + below(40); i > 0; --i) {
      Vec3<double> p = Vec3<double>(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      if (shape == 4) p = p.array().round();
      points.push_back(offset + turn * (p.cwiseProduct(stretch) * scale));
    }
    return points;
  }

  Vec3<double> direction() {
    return Vec3<double>(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).stableNormalized();
  }

  Mat3<double> rotation() { return pose_of(Vec3<double>::Zero()).rotation; }

  /// Any attitude: from a quaternion that is far from unit length, or the product of many.
  Pose pose_of(const Vec3<double>& translation) {
    const double length = std::pow(10.0, uniform(-30, 30));
    Pose pose = *pose_from(translation, length * uniform(-1, 1), length * uniform(-1, 1),
                           length * uniform(-1, 1), length * uniform(-1, 1));
    if (below(4) == 0) {
      const Mat3<double> turn = rotation();
      for (int i = 0; i < 1000; ++i) pose.rotation = pose.rotation * turn;
    }
    return pose;
  }

  Pose pose(double scale) { return pose_of(direction() * scale * std::pow(10.0, uniform(-3, 8))); }

 private:
  std::mt19937_64 random_;
};

double reach_of(const Points& points) {
  double reach = 0;
  for (const auto& p : points) reach = std::max(reach, p.norm());
  return reach;
}

/// What failed: the round, and its points, to be pasted into a test.
template <class... Clouds>
std::string in_round(int round, const Clouds&... clouds) {
  std::ostringstream text;
  text << std::setprecision(17) << "round " << round;
  const auto add = [&](const Points& points) {
    text << "\n  ";
    for (const auto& p : points) text << '{' << p[0] << ", " << p[1] << ", " << p[2] << "}, ";
  };
  (add(clouds), ...);
  return text.str();
}

Vec3<long double> wide(const Vec3<double>& p) { return p.cast<long double>(); }

/// A cloud as it stands in the world, and its volume posed.
template <class V>
struct PosedPoints {
  Points world;
  Posed<V> volume;

  PosedPoints(const Points& points, const Pose& pose, const Vec3<double>& origin) {
    const V local = V::enclosing(points);
    const double reach =
        std::max<double>(reach_of(points), static_cast<double>(bvlab::reach(local)));
    for (const auto& p : points) world.push_back(pose(p));
    volume = posed(local, PlacementOf<V>(pose, origin, reach * (1 + 1e-6)));
  }
};

template <class V>
class VolumeLaws : public ::testing::Test {};

TYPED_TEST_SUITE_P(VolumeLaws);

constexpr int rounds = 20000;

TYPED_TEST_P(VolumeLaws, SatisfiesTheConcept) { static_assert(BoundingVolume<TypeParam>); }

TYPED_TEST_P(VolumeLaws, WhatIsGivenIsInsideAndMergingKeepsItSo) {
  Hostile hostile(1);
  for (int round = 0; round < rounds; ++round) {
    const Points a = hostile.cloud(), b = hostile.cloud();
    const auto va = TypeParam::enclosing(a), vb = TypeParam::enclosing(b);
    const auto both = merge(va, vb);
    const PlacementOf<TypeParam> here;
    for (const auto& p : a) {
      ASSERT_TRUE(contains(posed(va, here), wide(p))) << in_round(round, a, b);
      ASSERT_TRUE(contains(posed(both, here), wide(p))) << in_round(round, a, b);
    }
    for (const auto& p : b)
      ASSERT_TRUE(contains(posed(both, here), wide(p))) << in_round(round, a, b);
  }
}

/// The tighter construction, where there is one, around a fan of triangles over the same clouds:
/// corners, and points between them that are off by no more than rounding.
TYPED_TEST_P(VolumeLaws, WhatIsFittedTightlyHoldsItsTriangles) {
  if constexpr (FittedTightly<TypeParam>) {
    Hostile hostile(6);
    for (int round = 0; round < rounds / 10; ++round) {
      const Points points = hostile.cloud();
      std::vector<Triangle> triangles;
      for (std::size_t i = 0; i < points.size(); ++i)
        triangles.push_back({points[0], points[i], points[(i + 1) % points.size()]});
      const auto volume = TypeParam::tight(points, triangles);
      const Pose pose = hostile.pose(reach_of(points));
      const double reach =
          std::max<double>(reach_of(points), static_cast<double>(bvlab::reach(volume)));
      const auto moved =
          posed(volume, PlacementOf<TypeParam>(pose, pose.translation, reach * (1 + 1e-6)));
      const auto here = posed(volume, PlacementOf<TypeParam>());
      for (const auto& p : points)
        ASSERT_TRUE(contains(moved, wide(pose(p)) - wide(pose.translation)))
            << in_round(round, points);
      for (const auto& [a, b, c] : triangles)
        for (const auto& p : {wide(a), wide(b), wide(c), Vec3<long double>((wide(b) + wide(c)) / 2),
                              Vec3<long double>((wide(a) + (wide(b) + wide(c)) / 2) / 2)})
          ASSERT_TRUE(contains(here, p)) << in_round(round, points);
    }
  }
}

TYPED_TEST_P(VolumeLaws, PosingKeepsVerticesInside) {
  Hostile hostile(2);
  for (int round = 0; round < rounds; ++round) {
    const Points points = hostile.cloud();
    const double scale = reach_of(points);
    const Pose pose = hostile.pose(scale);
    const Vec3<double> origin = hostile.below(2)
                                    ? Vec3<double>(pose.translation + hostile.direction() * scale)
                                    : Vec3<double>(Vec3<double>::Zero());
    const PosedPoints<TypeParam> posed_points(points, pose, origin);
    for (const auto& w : posed_points.world)
      ASSERT_TRUE(contains(posed_points.volume, wide(w) - wide(origin)))
          << in_round(round, points, posed_points.world, Points{origin});
  }
}

TYPED_TEST_P(VolumeLaws, VolumesThatShareAPointAreNotDisjoint) {
  Hostile hostile(3);
  for (int round = 0; round < rounds; ++round) {
    const Points a = hostile.cloud();
    const double scale = reach_of(a);
    const Pose pose = hostile.pose(scale);
    const Vec3<double> origin = pose.translation;
    const PosedPoints<TypeParam> first(a, pose, origin);
    // The other body stands at the identity, so that it can hold a vertex of the first to the bit.
    Points b{first.world[static_cast<std::size_t>(hostile.below(static_cast<int>(a.size())))]};
    for (int i = hostile.below(10); i > 0; --i)
      b.push_back(b[0] + hostile.direction() * scale * hostile.uniform(0, 2));
    const PosedPoints<TypeParam> second(b, Pose{}, origin);
    ASSERT_FALSE(disjoint(first.volume, second.volume)) << in_round(round, a, first.world, b);
    ASSERT_EQ(gap(first.volume, second.volume), 0) << in_round(round, a, first.world, b);
  }
}

TYPED_TEST_P(VolumeLaws, TheGapIsAtMostTheDistance) {
  Hostile hostile(4);
  int apart = 0;
  for (int round = 0; round < rounds; ++round) {
    const Points a = hostile.cloud();
    const double scale = reach_of(a);
    const Pose pose = hostile.pose(scale);
    const Vec3<double> origin = pose.translation;
    const PosedPoints<TypeParam> first(a, pose, origin);
    Points b;
    const Vec3<double> offset =
        first.world[0] + hostile.direction() * scale * hostile.uniform(0, 5);
    for (int i = 1 + hostile.below(5); i > 0; --i)
      b.push_back(offset + hostile.direction() * scale * hostile.uniform(0, 1));
    const PosedPoints<TypeParam> second(b, Pose{}, origin);
    long double distance = std::numeric_limits<long double>::infinity();
    for (const auto& p : first.world)
      for (const auto& q : second.world) distance = std::min(distance, (wide(p) - wide(q)).norm());
    const auto g = gap(first.volume, second.volume);
    ASSERT_GE(g, 0) << in_round(round, a, first.world, b);
    ASSERT_LE(static_cast<long double>(g), distance) << in_round(round, a, first.world, b);
    apart += disjoint(first.volume, second.volume);
  }
  // The laws would hold for a volume that is never disjoint; such a one is of no use.
  EXPECT_GT(apart, rounds / 20);
}

/// Points, or the places of bodies, beyond the numbers of the volume.
TYPED_TEST_P(VolumeLaws, OverflowIsNotDisjoint) {
  const auto expect_no_gap = [](const auto& first, const auto& second, double huge) {
    EXPECT_FALSE(disjoint(first.volume, second.volume)) << huge;
    EXPECT_EQ(gap(first.volume, second.volume), 0) << huge;
    using B = Batch<typename TypeParam::scalar, 8>;
    const std::uint32_t same[8] = {};
    const auto as = gather<B>(&first.volume, same), bs = gather<B>(&second.volume, same);
    EXPECT_EQ(bits(disjoint(as, bs)), 0u) << huge;
    EXPECT_EQ(gap(as, bs)[0], 0) << huge;
  };
  for (const double huge : {1e30, 1e39, 1e160, 1e300}) {
    const Points a{{huge, 0, 0}, {0, huge, 0}, {0, 0, -huge}}, b{{huge, 0, 0}};
    expect_no_gap(PosedPoints<TypeParam>(a, Pose{}, Vec3<double>::Zero()),
                  PosedPoints<TypeParam>(b, Pose{}, Vec3<double>::Zero()), huge);
  }
  Hostile hostile(3);
  for (const double far : {1e39, -1e39, 1e300}) {
    const Points points = hostile.cloud();
    for (const Vec3<double>& to : {Vec3<double>(far, 0, 0), Vec3<double>(far, far, -far)}) {
      Pose pose;
      pose.translation = to;
      const PosedPoints<TypeParam> posed_points(points, pose, Vec3<double>::Zero());
      expect_no_gap(posed_points, posed_points, far);
    }
  }
}

template <class V, int W>
void batches_agree() {
  using B = Batch<typename V::scalar, W>;
  Hostile hostile(5);
  for (int round = 0; round < rounds / 20; ++round) {
    std::vector<Posed<V>> volumes;
    std::vector<V> locals;
    PlacementOf<V> placement(hostile.pose(1), Vec3<double>::Zero(), 10);
    for (int i = 0; i < 3 * W; ++i) {
      Points points;
      const Vec3<double> offset = hostile.direction() * hostile.uniform(0, 3);
      for (int k = 0; k < 4; ++k)
        points.push_back(offset + hostile.direction() * hostile.uniform(0, 1));
      locals.push_back(V::enclosing(points));
      volumes.push_back(posed(locals.back(), placement));
    }
    std::uint32_t i[W], j[W];
    for (int lane = 0; lane < W; ++lane) {
      i[lane] = static_cast<std::uint32_t>(hostile.below(3 * W));
      j[lane] = static_cast<std::uint32_t>(hostile.below(3 * W));
    }
    const auto a = gather<B>(volumes.data(), i), b = gather<B>(volumes.data(), j);
    const std::uint64_t mask = bits(disjoint(a, b));
    const B gaps = gap(a, b);
    const auto moved = posed(gather<B>(locals.data(), i), placement);
    const std::uint64_t again = bits(disjoint(moved, b));
    for (int lane = 0; lane < W; ++lane) {
      const bool apart = disjoint(volumes[i[lane]], volumes[j[lane]]);
      ASSERT_EQ(mask >> lane & 1, apart);
      ASSERT_EQ(again >> lane & 1, apart);
      ASSERT_EQ(gaps[static_cast<std::size_t>(lane)], gap(volumes[i[lane]], volumes[j[lane]]));
    }
  }
}

TYPED_TEST_P(VolumeLaws, BatchesSayWhatTheScalarSays) {
  constexpr int widest = std::max(4, native_width<typename TypeParam::scalar>);
  batches_agree<TypeParam, 2>();
  batches_agree<TypeParam, 4>();
  if constexpr (widest >= 8) batches_agree<TypeParam, 8>();
  if constexpr (widest >= 16) batches_agree<TypeParam, 16>();
}

REGISTER_TYPED_TEST_SUITE_P(VolumeLaws, SatisfiesTheConcept, WhatIsGivenIsInsideAndMergingKeepsItSo,
                            WhatIsFittedTightlyHoldsItsTriangles, PosingKeepsVerticesInside,
                            VolumesThatShareAPointAreNotDisjoint, TheGapIsAtMostTheDistance,
                            OverflowIsNotDisjoint, BatchesSayWhatTheScalarSays);

}  // namespace
}  // namespace bvlab
