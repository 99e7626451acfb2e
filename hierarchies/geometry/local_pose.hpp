// SPDX-License-Identifier: BSD-3-Clause
/// The pose of a mesh about an origin o of its own (LocalMesh), and how far from it the vertices of
/// the world may be: these remain w = fl64(Rv + t) of the vertices v as given.
///
/// Why the bound holds. Let x = v - o, the local vertex l = fl64(x), |x| <= reach, u = 2^-53, A the
/// origin in the world about which positions are wanted, and t' = fl64(Ro + t - A), summed with
/// twice the digits. Then w - A = R l + t' but for
///
/// - the roundings in w. Along axis i these are three of products and three of sums, each at most u
///   times its result, at the origin or within |R_i| reach of what it is there:
///   e_i = u (|R_i0 o_0| + |R_i1 o_1| + |R_i2 o_2| + |R_i0 o_0 + R_i1 o_1| + |R_i o| + |(Ro + t)_i|
///   + 4 |R_i| reach). Where row i of R is a unit vector or its opposite, products and sums are
///   exact: e_i = u |w_i|, and 0 where t_i = 0. So identity poses lose nothing, however far the
///   vertices are.
/// - R (l - x), at most u |R| reach;
/// - the rounding of t', which is the second half of the sum, and 2^-96 (|R||o| + |t| + |A|).
///
/// A term proportional to the distance is of the vertices themselves: in the world they are float64
/// and no nearer to R v + t than that. `error` is at least the sum, with a factor for higher orders
/// and its own rounding. It is infinite where anything overflows.
#pragma once

#include <cmath>
#include <limits>

#include "hierarchies/geometry/double_double.hpp"
#include "hierarchies/geometry/local_mesh.hpp"
#include "hierarchies/geometry/pose.hpp"

namespace bvlab {

struct LocalPose {
  Pose pose;         ///< of local vertices, relative to A
  double error = 0;  ///< at least |(w - A) - (R l + t')|, in units of the mesh

  LocalPose(const Pose& given, const Vec3<double>& origin, double reach,
            const Vec3<double>& about = Vec3<double>::Zero()) {
    constexpr double u = unit_roundoff<double>;
    pose.rotation = given.rotation;
    const double size = given.rotation.norm();
    Vec3<double> rounding, lost;
    for (int i = 0; i < 3; ++i) {
      const Vec3<double> row = given.rotation.row(i).transpose();
      DoubleDouble at = given.translation[i];
      for (int j = 0; j < 3; ++j) at = at + DoubleDouble::product(row[j], origin[j]);
      const DoubleDouble to = at - DoubleDouble(about[i]);
      pose.translation[i] = to.high, lost[i] = to.low;
      const double length = row.norm();
      const Vec3<double> products = row.cwiseProduct(origin);
      const double within = products.cwiseAbs().sum() + std::abs(products[0] + products[1]) +
                            std::abs(products.sum()) + 3 * length * reach;
      const bool exact = row.cwiseAbs().maxCoeff() == 1 && row.cwiseAbs().sum() == 1;
      const double last = u * (std::abs(static_cast<double>(at)) + length * reach);
      rounding[i] = !exact ? u * within + last : given.translation[i] == 0 ? 0 : last;
    }
    error = (rounding.norm() + u * size * reach + lost.norm() +
             0x1p-96 * (size * origin.norm() + given.translation.norm() + about.norm())) *
            (1 + 0x1p-40);
    if (std::isfinite(error)) return;
    pose.translation.setZero();
    error = std::numeric_limits<double>::infinity();
  }
};

/// The position of a point of the mesh, given relative to `of_mesh`, about an origin in the world.
inline Vec3<double> position_about(const Vec3<double>& origin, const Pose& pose,
                                   const Vec3<double>& of_mesh, const Vec3<double>& point) {
  if (!LocalMesh::has_own_origin(of_mesh)) return pose(point) - origin;
  return LocalPose(pose, of_mesh, 0, origin).pose(point);
}

}  // namespace bvlab
