// SPDX-License-Identifier: BSD-3-Clause
/// The laws of volumes where wide trees test them: in the world or in the other body's frame, one
/// node against the siblings of another, all that is rounded on the way included.
///
///   conservatism  what is told apart does not touch, in the world, as float64 has it;
///   gaps          no gap exceeds the distance of the triangles below, there;
///   lanes         all of which holds for each of the siblings by itself.
///
/// Bodies are put so that a corner of one meets a corner of the other, or nearly; near the origin
/// and far from it, turned by rotations and by matrices that are hardly any, of all sizes.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>

#include "experiments/scenes/formula_mesh.hpp"
#include "hierarchies/builds.hpp"
#include "traversal/counters.hpp"
#include "traversal/primitives/triangle_distance.hpp"
#include "traversal/primitives/triangle_intersection.hpp"
#include "traversal/wide/relative_frame.hpp"

namespace bvlab {

namespace frame_laws {

struct Setting {
  double scale, offset, far, drift, apart;  ///< offset, far and apart in scales
};

inline const std::vector<Setting>& settings() {
  static const std::vector<Setting> all = [] {
    std::vector<Setting> made;
    for (const double scale : {1.0, 1e-4, 3e5})
      for (const double offset : {0.0, 20.0})
        for (const double far : {0.0, 1e3, 1e8})
          for (const double drift : {0.0, 1e-9, 0.004, 0.2})
            for (const double apart : {0.0, 1e-6, 0.3})
              made.push_back({scale, offset, far, drift, apart});
    return made;
  }();
  return all;
}

/// Two bodies, and how far all their triangles are from each other; `nothing` where they touch.
struct Meeting {
  static constexpr double nothing = 0;
  TriangleMesh mesh[2];
  Pose pose[2];
  std::vector<std::vector<double>> distances;

  Meeting(const Setting& setting, std::mt19937& random) {
    std::uniform_real_distribution<double> unit(-1, 1);
    const auto vector = [&] { return Vec3<double>(unit(random), unit(random), unit(random)); };
    mesh[0] = formula_mesh("star", 30), mesh[1] = formula_mesh("torus", 32);
    const Vec3<double> origin = setting.far * setting.scale * vector();
    for (int side = 0; side < 2; ++side) {
      const Vec3<double> offset = setting.offset * vector();
      for (auto& v : mesh[side].vertices) v = setting.scale * (v + offset);
      pose[side] = *pose_from(origin, unit(random), unit(random), unit(random), unit(random) + 2);
      for (int k = 0; k < 9; ++k) pose[side].rotation.data()[k] += setting.drift * unit(random);
    }
    const auto corner = [&](int side) {
      return pose[side](mesh[side].vertices[random() % mesh[side].vertices.size()]);
    };
    const Vec3<double> between = corner(0) - corner(1);
    pose[1].translation += between + setting.apart * setting.scale * vector();
    const auto first = world(0), second = world(1);
    for (const auto& a : first) {
      distances.emplace_back();
      for (const auto& b : second)
        distances.back().push_back(intersect(a, b) ? nothing
                                                   : std::max(std::numeric_limits<double>::min(),
                                                              distance(a, b).distance));
    }
  }

 private:
  std::vector<Triangle> world(int side) const {
    std::vector<Triangle> all;
    for (std::size_t t = 0; t < mesh[side].triangles.size(); ++t) {
      all.push_back(mesh[side].corners(t));
      for (auto& corner : all.back()) corner = pose[side](corner);
    }
    return all;
  }
};

inline const std::vector<Meeting>& meetings() {
  static const std::vector<Meeting> all = [] {
    std::mt19937 random(20261122);
    std::vector<Meeting> made;
    for (const auto& setting : settings()) made.emplace_back(setting, random);
    return made;
  }();
  return all;
}

template <class Hierarchy>
void collect(const Hierarchy& hierarchy, std::uint32_t node, std::vector<std::uint32_t>& found);

/// The triangles below one child.
template <class Hierarchy>
std::vector<std::uint32_t> below(const Hierarchy& hierarchy, std::uint32_t node, int lane) {
  const auto& parent = hierarchy.node(node);
  const std::uint32_t child = parent.first + static_cast<std::uint32_t>(lane);
  if (parent.leaf) return {hierarchy.triangle(child)};
  std::vector<std::uint32_t> found;
  collect(hierarchy, child, found);
  return found;
}

template <class Hierarchy>
void collect(const Hierarchy& hierarchy, std::uint32_t node, std::vector<std::uint32_t>& found) {
  for (int lane = 0; lane < std::popcount(hierarchy.node(node).lanes); ++lane)
    for (const auto triangle : below(hierarchy, node, lane)) found.push_back(triangle);
}

template <BoundingVolume V, int F>
class Law {
  using Body = WideBody<WideHierarchy<V, F>>;
  using PairFrame = RelativeFrame<V, F>;

 public:
  explicit Law(const Meeting& meeting)
      : meeting_(meeting),
        hierarchies_{made(meeting.mesh[0]), made(meeting.mesh[1])},
        bodies_{Body(meeting.mesh[0], hierarchies_[0]), Body(meeting.mesh[1], hierarchies_[1])} {
    for (int side = 0; side < 2; ++side) bodies_[side].set_pose(meeting.pose[side]);
    pair_frame_.begin(bodies_[0], bodies_[1]);
  }

  void expect() {
    for (std::size_t side = 0; side < 2; ++side)
      for (std::uint32_t many = 0; many < hierarchies_[side].size(); ++many)
        for (std::uint32_t one = 0; one < hierarchies_[1 - side].size(); ++one) {
          std::vector<std::uint32_t> triangles;
          collect(hierarchies_[1 - side], one, triangles);
          expect(side, many, pair_frame_.posed_node(1 - side, one, counter_), triangles);
          for (int lane = 0; lane < std::popcount(hierarchies_[1 - side].node(one).lanes); ++lane)
            expect(side, many, pair_frame_.posed_child(1 - side, one, lane, counter_),
                   below(hierarchies_[1 - side], one, lane));
        }
  }

  std::size_t tested = 0, apart = 0, touching = 0;

 private:
  static WideHierarchy<V, F> made(const TriangleMesh& mesh) {
    return {mesh, builds::TopDownMedian::topology(mesh, 1), Fit::published, 4};
  }

  void expect(std::size_t side, std::uint32_t many, const typename PairFrame::PosedNode& one,
              const std::vector<std::uint32_t>& triangles) {
    const auto overlap = pair_frame_.overlap(side, many, one);
    const auto gaps = pair_frame_.gaps(side, many, one);
    const auto separation = pair_frame_.separation(side, many, one);
    const auto told_apart = bits(overlap.apart);
    for (int lane = 0; lane < std::popcount(hierarchies_[side].node(many).lanes); ++lane) {
      const double truth = distance_of(side, below(hierarchies_[side], many, lane), triangles);
      const auto k = static_cast<std::size_t>(lane);
      const bool is_apart = told_apart >> k & 1;
      ++tested, apart += is_apart, touching += truth == Meeting::nothing;
      EXPECT_FALSE(is_apart && truth == Meeting::nothing) << many << ' ' << lane;
      EXPECT_LE(static_cast<double>(gaps[k]), truth * (1 + 1e-12)) << many << ' ' << lane;
      EXPECT_LE(static_cast<double>(separation.gap[k]), truth * (1 + 1e-12)) << many << ' ' << lane;
    }
  }

  double distance_of(std::size_t side, const std::vector<std::uint32_t>& lanes,
                     const std::vector<std::uint32_t>& one) const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto i : lanes)
      for (const auto j : one)
        least = std::min(least, side ? meeting_.distances[j][i] : meeting_.distances[i][j]);
    return least;
  }

  const Meeting& meeting_;
  WideHierarchy<V, F> hierarchies_[2];
  Body bodies_[2];
  PairFrame pair_frame_;
  Counting counter_;
};

}  // namespace frame_laws

template <BoundingVolume V, int F>
void expect_frame_laws() {
  std::size_t tested = 0, apart = 0, touching = 0;
  const auto& meetings = frame_laws::meetings();
  for (std::size_t i = 0; i < meetings.size(); ++i) {
    const auto& setting = frame_laws::settings()[i];
    SCOPED_TRACE(testing::Message() << V::name << ' ' << F << ": scale " << setting.scale
                                    << ", offset " << setting.offset << ", far " << setting.far
                                    << ", drift " << setting.drift << ", apart " << setting.apart);
    frame_laws::Law<V, F> law(meetings[i]);
    law.expect();
    tested += law.tested, apart += law.apart, touching += law.touching;
    if (testing::Test::HasFailure()) return;
  }
  // Worth its name only where both happen, and much is told apart.
  EXPECT_GT(touching, tested / 1000) << V::name;
  EXPECT_GT(apart, tested / 4) << V::name;
}

}  // namespace bvlab
