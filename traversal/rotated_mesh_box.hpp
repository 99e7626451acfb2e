// SPDX-License-Identifier: BSD-3-Clause
/// The axis-aligned box, in the world, around a mesh in any pose, from the mesh's support values in
/// the 26 directions of a cube's faces, edges and corners, which are computed once.
///
/// Along an axis d the rotated mesh reaches as far as the mesh reaches along n = R'd. With
/// coordinates x >= y >= z >= 0 of n, up to order and signs, n = (x-y)(1,0,0) + (y-z)(1,1,0) +
/// z(1,1,1), so that it reaches no farther than the same sum of support values (zachmann1998rapid).
/// The result is smaller than the box of the rotated box, costs the same for every mesh, and holds
/// whether or not R is a rotation.
///
/// With u = 2^-53, no vertex farther than `reach` from the mesh's origin, and r the largest number
/// of R's row, the weights times support values are at most 1.74 r reach in all; their roundings
/// are below 6u of that. The vertex itself, ((R_i0 x + R_i1 y) + R_i2 z) + t_i, is off by less than
/// 4.1u (1.74 r reach + |t_i|), and adding t_i - o_i by 3u (1.74 r reach + |t_i| + |o_i|). Together
/// less than the slack of 32u (r reach + |t_i| + |o_i|). Where the mesh has an origin of its own,
/// v, t and o are local, and the error of LocalPose is added.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "broadphase/box.hpp"
#include "hierarchies/geometry/local_pose.hpp"
#include "hierarchies/geometry/small_matrices.hpp"

namespace bvlab {

class RotatedMeshBox {
 public:
  explicit RotatedMeshBox(const TriangleMesh& mesh) : RotatedMeshBox(LocalMesh(mesh)) {}

  /// Where the origin of the mesh (LocalMesh) is in a pose.
  Vec3<double> mesh_origin(const Pose& pose) const { return pose(origin_); }

  /// The box in a pose, relative to `origin`. Bounds beyond the range of float are clipped to it.
  Box<float> operator()(const Pose& pose, const Vec3<double>& origin) const {
    if (!LocalMesh::has_own_origin(origin_)) return box(pose, origin, 0);
    const LocalPose local(pose, origin_, reach_, origin);
    return box(local.pose, Vec3<double>::Zero(), local.error);
  }

 private:
  explicit RotatedMeshBox(const LocalMesh& local) : origin_(local.origin()) {
    support_.fill(-std::numeric_limits<double>::infinity());
    for (const auto& v : local.mesh().vertices) {
      // Covers the two roundings of a sum of three.
      const double room = 4 * unit_roundoff<double> * v.lpNorm<1>();
      for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
          for (int z = -1; z <= 1; ++z) {
            double& most = support_[at(x, y, z)];
            most = std::max(most, ((x * v[0] + y * v[1]) + z * v[2]) + room);
          }
      reach_ = std::max(reach_, stable_norm(v));
    }
    reach_ *= 1 + 8 * unit_roundoff<double>;
  }

  Box<float> box(const Pose& pose, const Vec3<double>& origin, double error) const {
    constexpr float most = std::numeric_limits<float>::max();
    Box<float> box;
    for (int i = 0; i < 3; ++i) {
      const auto [lo, hi] = along({pose.rotation(i, 0), pose.rotation(i, 1), pose.rotation(i, 2)},
                                  pose.translation[i], origin[i], error);
      const float below = -beyond(-lo), above = beyond(hi);
      // Written so that NaN gives the box of everything.
      const bool sound = below >= -most && above <= most && below <= above;
      box.lo[i] = sound ? below : -most;
      box.hi[i] = sound ? above : most;
    }
    return box;
  }

  struct Interval {
    double lo, hi;
  };

  /// A float above x, by less than two steps where it is large enough; NaN stays NaN. A step is at
  /// most 2^-23 of a number, so that the sum ends at the next float or above.
  static float beyond(double x) {
    const float y = static_cast<float>(x);
    return y + (std::abs(y) * std::numeric_limits<float>::epsilon() +
                std::numeric_limits<float>::min());
  }

  static constexpr int at(int x, int y, int z) { return (x + 1) * 9 + (y + 1) * 3 + (z + 1); }

  Interval along(const std::array<double, 3>& n, double translation, double origin,
                 double error) const {
    constexpr int weight[3] = {9, 3, 1};
    const double size[3] = {std::abs(n[0]), std::abs(n[1]), std::abs(n[2])};
    // Without branches: which component is largest cannot be predicted.
    const auto step = [&](int axis) { return n[axis] < 0 ? -weight[axis] : weight[axis]; };
    const int steps[3] = {step(0), step(1), step(2)};
    const bool second = size[1] > size[0];
    const double more = second ? size[1] : size[0], less = second ? size[0] : size[1];
    const int of_more = second ? steps[1] : steps[0], of_less = second ? steps[0] : steps[1];
    const bool third = size[2] > more, last = size[2] < less;
    const double large = third ? size[2] : more, small = last ? size[2] : less;
    const double median = third ? more : last ? less : size[2];
    const int face = third ? steps[2] : of_more, corner = steps[0] + steps[1] + steps[2];
    const int edge = corner - (last ? steps[2] : of_less);
    const double x = large - median, y = median - small, z = small;
    constexpr int none = at(0, 0, 0);
    const auto reached = [&](int sign) {
      return (x * support_[none + sign * face] + y * support_[none + sign * edge]) +
             z * support_[none + sign * corner];
    };
    const double offset = translation - origin;
    const double slack =
        32 * unit_roundoff<double> * (large * reach_ + std::abs(translation) + std::abs(origin)) +
        std::numeric_limits<double>::min() + error;
    return {offset - reached(-1) - slack, offset + reached(1) + slack};
  }

  std::array<double, 27> support_;
  double reach_ = 0;
  Vec3<double> origin_;  // of the mesh
};

}  // namespace bvlab
