// SPDX-License-Identifier: BSD-3-Clause
/// A hunt for a false "disjoint": two patches of triangles whose surfaces share a point, exactly,
/// and hardly more than that, in the shapes and attitudes that are worst for volumes.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdlib>
#include <random>

#include "hierarchies/bounding_volume.hpp"
#include "hierarchies/wide/sibling_test.hpp"
#include "traversal/primitives/triangle_distance.hpp"
#include "traversal/primitives/triangle_intersection.hpp"

namespace bvlab {
namespace {

using Patch = std::vector<Triangle>;

class Hunter {
 public:
  explicit Hunter(std::uint64_t seed) : random_(seed) {}

  double uniform(double low = -1, double high = 1) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
  Vec3<double> point() {
    const double x = uniform(), y = uniform(), z = uniform();
    return {x, y, z};
  }
  Eigen::Quaterniond attitude() {
    return Eigen::Quaterniond(uniform(), uniform(), uniform(), uniform()).normalized();
  }

  /// A box (flat, needle-like, or neither), a cap of a ball (a half angle of 0, a right angle, a
  /// straight one, or anything), or loose triangles; about 1 in size, the middle anywhere.
  Patch patch() {
    Patch patch;
    switch (below(3)) {
      case 0:
        patch = box();
        break;
      case 1:
        patch = cap();
        break;
      default:
        for (int i = 1 + below(6); i > 0; --i) patch.push_back({point(), point(), point()});
    }
    const Mat3<double> turn = attitude().toRotationMatrix();
    const Vec3<double> middle = below(3) ? Vec3<double>(point() * std::pow(10, uniform(-2, 4)))
                                         : Vec3<double>(Vec3<double>::Zero());
    for (auto& t : patch)
      for (auto& p : t) p = Vec3<double>(turn * p + middle);
    return patch;
  }

  /// From a quaternion of any length, or the product of as many small turns as there are.
  Pose pose(const Eigen::Quaterniond& turn) {
    const double length = std::pow(10, uniform(-100, 100));
    Pose pose = *pose_from(Vec3<double>::Zero(), length * turn.w(), length * turn.x(),
                           length * turn.y(), length * turn.z());
    if (below(8) == 0) {
      const Mat3<double> step = Eigen::AngleAxisd(0.01, point().normalized()).toRotationMatrix();
      for (int i = 0; i < 3000; ++i) pose.rotation = pose.rotation * step;
    }
    return pose;
  }

  /// Turned against the first by nothing, by last digits, by a little, or by anything.
  Eigen::Quaterniond near(const Eigen::Quaterniond& turn) {
    const int kind = below(4);
    if (kind == 0) return turn;
    if (kind == 3) return attitude();
    const double angle = std::pow(10, kind == 1 ? uniform(-17, -14) : uniform(-14, -2));
    return turn * Eigen::Quaterniond(Eigen::AngleAxisd(angle, point().normalized()));
  }

 private:
  Patch box() {
    Vec3<double> size(1, 1, 1);
    for (int axis = below(3); axis > 0; --axis)
      size[axis] = below(3) ? std::pow(10, uniform(-16, -1)) : 0;
    const auto corner = [&](int i) {
      return Vec3<double>(i & 1 ? size[0] : -size[0], i & 2 ? size[1] : -size[1],
                          i & 4 ? size[2] : -size[2]);
    };
    constexpr int sides[][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
    Patch patch;
    for (const auto& s : sides) {
      patch.push_back({corner(s[0]), corner(s[1]), corner(s[2])});
      patch.push_back({corner(s[0]), corner(s[2]), corner(s[3])});
    }
    return patch;
  }

  Patch cap() {
    const double angles[] = {0, 1e-9, M_PI / 2, M_PI, uniform(0, M_PI)};
    const double widest = angles[below(5)];
    const auto on_ball = [&](double part, double round) {
      const double angle = part * widest;
      return Vec3<double>(std::sin(angle) * std::cos(round), std::sin(angle) * std::sin(round),
                          std::cos(angle));
    };
    Patch patch;
    for (int i = 0; i < 5; ++i)
      for (int k = 0; k < 2; ++k) {
        const double round = 2 * M_PI * i / 5, next = 2 * M_PI * (i + 1) / 5;
        const double inner = 0.5 * k, outer = 0.5 * (k + 1);
        patch.push_back({on_ball(inner, round), on_ball(outer, round), on_ball(outer, next)});
        patch.push_back({on_ball(inner, round), on_ball(outer, next), on_ball(inner, next)});
      }
    return patch;
  }

  std::mt19937_64 random_;
};

inline Patch posed_patch(const Patch& patch, const Pose& pose) {
  Patch moved = patch;
  for (auto& t : moved)
    for (auto& p : t) p = pose(p);
  return moved;
}

template <class V>
struct Hunted {
  V local;
  double reach = 0;

  Hunted(const Patch& patch, Fit fit) {
    std::vector<Vec3<double>> points;
    for (const auto& t : patch) points.insert(points.end(), t.begin(), t.end());
    if constexpr (FittedToTriangles<V>)
      local = V::enclosing(points, patch);
    else
      local = V::enclosing(points);
    if constexpr (FittedTightly<V>)
      if (fit == Fit::tight) local = V::tight(points, patch);
    for (const auto& p : points) reach = std::max(reach, p.stableNorm());
    reach = std::max(reach, static_cast<double>(reach_of(local)));
    reach *= 1 + 8 * unit_roundoff<typename V::scalar>;
  }
  Posed<V> at(const Pose& pose, const Vec3<double>& origin) const {
    return posed(local, PlacementOf<V>(pose, origin, reach));
  }
};

/// As one volume of a body and a lane of the other say it, in the frame of the other.
template <class V>
struct SeenFromTheOther {
  bool apart;
  double gap;

  SeenFromTheOther(const Hunted<V>& a, const Pose& pose_a, const Hunted<V>& b, const Pose& pose_b) {
    using T = typename V::scalar;
    using S = Batch<T, 8>;
    using SiblingTest = SiblingTestOf<V>;
    const RelativePose pose(OrthonormalPose(pose_a, a.reach), OrthonormalPose(pose_b, b.reach));
    const auto change = SiblingTest::frame_change(pose, a.reach, b.reach);
    const auto one = SiblingTest::posed_node(a.local, T(1), change);
    const auto lanes = in_all_lanes<S>(b.local);
    apart = any_of(SiblingTest::template overlap<S>(one, change, lanes, S(T(1))).apart);
    gap = static_cast<double>(SiblingTest::template gaps<S>(one, change, lanes)[0]);
    // The same, turned as lanes are.
    if constexpr (requires { SiblingTest::in_lanes(lanes, change); }) {
      const auto turned = SiblingTest::in_lanes(in_all_lanes<S>(a.local), change);
      apart |= any_of(SiblingTest::template overlap<S>(turned, change, lanes, S(T(1))).apart);
      gap = std::max(gap,
                     static_cast<double>(SiblingTest::template gaps<S>(turned, change, lanes)[0]));
      const S separation = separation_of<SiblingTest, S>(turned, change, lanes, S(T(1))).gap;
      gap = std::max(gap, static_cast<double>(separation[0]));
    }
  }
};

/// How many rounds: more where the environment says so.
inline int hunting_rounds() {
  const char* text = std::getenv("BVLAB_HUNT_ROUNDS");
  return text ? std::atoi(text) : 4000;
}

template <class V>
void hunt() {
  // Each volume meets other patches, the same in every run.
  std::uint64_t seed = 0;
  for (const char letter : V::name) seed = 31 * seed + static_cast<unsigned char>(letter);
  Hunter hunter(seed);
  int sharing = 0, apart = 0, told = 0, told_by_the_other = 0;
  const int rounds = hunting_rounds();
  for (int round = 0; round < rounds; ++round) {
    const double scale = std::pow(10, hunter.uniform(-15, 15));
    Patch a = hunter.patch(), b = hunter.patch();
    for (auto* patch : {&a, &b})
      for (auto& t : *patch)
        for (auto& p : t) p *= scale;
    const Eigen::Quaterniond turn = hunter.attitude();
    Pose pose_a = hunter.pose(turn), pose_b = hunter.pose(hunter.near(turn));
    if (hunter.below(2))
      pose_a.translation = hunter.point() * scale * std::pow(10, hunter.uniform(-3, 9));
    // b's foremost corner against a's foremost face, corner or edge, or a last digit off.
    const Patch world_a = posed_patch(a, pose_a);
    const Patch turned_b = posed_patch(b, pose_b);
    const Vec3<double> way = hunter.point().normalized();
    Vec3<double> foremost = world_a[0][0], hindmost = turned_b[0][0];
    for (const auto& t : world_a)
      for (const auto& p : t)
        if (p.dot(way) > foremost.dot(way)) foremost = p;
    for (const auto& t : turned_b)
      for (const auto& p : t)
        if (p.dot(way) < hindmost.dot(way)) hindmost = p;
    if (hunter.below(2)) {
      const Triangle& t =
          world_a[static_cast<std::size_t>(hunter.below(static_cast<int>(world_a.size())))];
      const double s = hunter.uniform(0, 1);
      foremost = t[0] + s * (t[1] - t[0]) + hunter.uniform(0, 1 - s) * (t[2] - t[0]);
    }
    const double hairs[] = {0, 1e-16, -1e-16, 1e-12, -1e-12, 1e-7, 1e-5, 1e-3};
    pose_b.translation = foremost - hindmost + way * scale * hairs[hunter.below(8)];
    const Patch world_b = posed_patch(b, pose_b);
    bool share = false;
    double distance_ab = std::numeric_limits<double>::infinity();
    for (const auto& s : world_a)
      for (const auto& t : world_b) share = share || intersect(s, t);
    const Vec3<double> origins[] = {Vec3<double>::Zero(), pose_a.translation, pose_b.translation};
    const Fit fit = round % 2 ? Fit::tight : Fit::published;
    const Hunted<V> hunted_a(a, fit), hunted_b(b, fit);
    const auto expect_at_most_the_distance = [&](double gap) {
      if (!(gap > 0)) return;
      if (std::isinf(distance_ab))
        for (const auto& s : world_a)
          for (const auto& t : world_b)
            distance_ab = std::min(distance_ab, distance(s, t).distance);
      // The distance itself is right to 1e-14 of it and 2^-90 of the extent.
      ASSERT_LE(gap, distance_ab * (1 + 2e-14)) << V::name << " round " << round;
    };
    for (const auto& origin : origins) {
      const auto p = hunted_a.at(pose_a, origin), q = hunted_b.at(pose_b, origin);
      const bool said = disjoint(p, q);
      const auto g = gap(p, q);
      ASSERT_FALSE(share && said) << V::name << " round " << round;
      ASSERT_GE(g, 0) << V::name << " round " << round;
      ASSERT_FALSE(share && g > 0) << V::name << " round " << round << " gap " << g;
      ASSERT_FALSE(share && disjoint(q, p)) << V::name << " round " << round;
      expect_at_most_the_distance(static_cast<double>(g));
      if (testing::Test::HasFatalFailure()) return;
      told += said;
    }
    for (const auto& seen : {SeenFromTheOther<V>(hunted_a, pose_a, hunted_b, pose_b),
                             SeenFromTheOther<V>(hunted_b, pose_b, hunted_a, pose_a)}) {
      ASSERT_FALSE(share && seen.apart) << V::name << " round " << round << " from the other";
      ASSERT_FALSE(share && seen.gap > 0) << V::name << " round " << round << " from the other";
      expect_at_most_the_distance(seen.gap);
      if (testing::Test::HasFatalFailure()) return;
      told_by_the_other += seen.apart;
    }
    ++(share ? sharing : apart);
  }
  EXPECT_GT(sharing, rounds / 10);
  EXPECT_GT(apart, rounds / 10);
  // A volume that is never disjoint would pass.
  EXPECT_GT(told, 0);
  EXPECT_GT(told_by_the_other, 0);
}

}  // namespace
}  // namespace bvlab
