// SPDX-License-Identifier: BSD-3-Clause
/// Tests spheres about the origins of two meshes (LocalMesh) by the translations alone: no volume
/// is posed. After spheres that overlap, the test is skipped for eight runs.
#pragma once

#include <algorithm>
#include <cstdint>

#include "hierarchies/geometry/relative_pose.hpp"
#include "hierarchies/geometry/small_matrices.hpp"
#include "hierarchies/hierarchy_extent.hpp"

namespace bvlab {

class SphereTest {
 public:
  enum class Result : std::uint8_t { apart, near, not_tested };

  template <class Pair>
  Result operator()(const Pair& pair) {
    if (until_test_ > 0) return --until_test_, Result::not_tested;
    // The enlargement of the radii far exceeds all rounding. Where a rotation is not orthonormal,
    // the pose's error bound is what it adds to lengths.
    if (radii_ == 0)
      radii_ = (radius(pair.a().extent()) + radius(pair.b().extent())) * (1 + 0x1p-20) +
               (pair.a().extent().reach + pair.b().extent().reach) * 0x1p-40;
    const OrthonormalPose &at_a = pair.a().orthonormal_pose(), &at_b = pair.b().orthonormal_pose();
    const Vec3<double>&a = at_a.translation, &b = at_b.translation;
    const double radii = radii_ + (at_a.error_bound + at_b.error_bound) +
                         (a - b).lpNorm<1>() * 0x1p-40 + pair.query().limit();
    const double squared = (a - b).squaredNorm();
    if (squared > radii * radii && squared > tiny) return Result::apart;
    until_test_ = rest;
    return Result::near;
  }

  /// Counts a run in which the roots were tested instead; returns whether the pause is over.
  bool batch_is_over() { return --until_test_ <= 0; }
  void test_now() { until_test_ = 0; }

 private:
  static constexpr int rest = 8;            // runs
  static constexpr double tiny = 0x1p-900;  // smaller squares are inexact by underflow

  /// The radius of a sphere about the mesh's origin that encloses the mesh, if not all volumes.
  static double radius(const HierarchyExtent& extent) {
    return std::min(extent.reach, stable_norm(extent.centre) + extent.radius);
  }

  int until_test_ = 0;
  double radii_ = 0;  // of both bodies, together
};

}  // namespace bvlab
