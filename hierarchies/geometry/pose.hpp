// SPDX-License-Identifier: BSD-3-Clause
/// The pose of a body: a rotation and a translation, object to world, in double precision.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "hierarchies/geometry/scalar.hpp"

namespace bvlab {

struct Pose {
  /// Finite. Answers are exact for any such matrix; volumes cull only where it is orthonormal to
  /// within about 0.01.
  Mat3<double> rotation = Mat3<double>::Identity();
  Vec3<double> translation = Vec3<double>::Zero();  ///< in units of the mesh

  /// The position of vertex `v` in the world.
  ///
  /// No other code moves a vertex, and the order of operations is part of the definition of every
  /// exact answer: ((R_i0 x + R_i1 y) + R_i2 z) + t_i, each step rounded to float64, without
  /// contraction to fused operations (the build sets -ffp-contract=off).
  Vec3<double> operator()(const Vec3<double>& v) const {
    Vec3<double> world;
    for (int i = 0; i < 3; ++i)
      world[i] = ((rotation(i, 0) * v[0] + rotation(i, 1) * v[1]) + rotation(i, 2) * v[2]) +
                 translation[i];
    return world;
  }
  /// The positions of a triangle's corners in the world.
  std::array<Vec3<double>, 3> operator()(const std::array<Vec3<double>, 3>& corners) const {
    return {(*this)(corners[0]), (*this)(corners[1]), (*this)(corners[2])};
  }

  friend bool operator==(const Pose& a, const Pose& b) {
    return a.rotation == b.rotation && a.translation == b.translation;
  }
};

/// The pose with this translation and the rotation of the quaternion (w, x, y, z), which need not
/// be of unit length. Nothing where the quaternion is zero or a number is not finite.
inline std::optional<Pose> pose_from(const Vec3<double>& translation, double w, double x, double y,
                                     double z) {
  const double largest = std::max({std::abs(w), std::abs(x), std::abs(y), std::abs(z)});
  const bool finite = std::isfinite(w) && std::isfinite(x) && std::isfinite(y) &&
                      std::isfinite(z) && std::isfinite(translation[0]) &&
                      std::isfinite(translation[1]) && std::isfinite(translation[2]);
  if (!finite || largest == 0) return std::nullopt;
  // Scaling by a power of two is exact, and keeps the squares from over- or underflowing.
  if (largest < 0x1p-301 || largest >= 0x1p300) {
    int exponent = 0;
    std::frexp(largest, &exponent);
    w = std::ldexp(w, -exponent), x = std::ldexp(x, -exponent);
    y = std::ldexp(y, -exponent), z = std::ldexp(z, -exponent);
  }
  const double norm = std::sqrt(w * w + x * x + y * y + z * z);
  w /= norm, x /= norm, y /= norm, z /= norm;
  Pose pose;
  pose.rotation << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),  //
      2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),               //
      2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y);
  pose.translation = translation;
  return pose;
}

}  // namespace bvlab
