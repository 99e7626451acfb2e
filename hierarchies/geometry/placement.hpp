// SPDX-License-Identifier: BSD-3-Clause
/// A pose made ready for bounding volumes over T: rounded to T, relative to an origin chosen near
/// the bodies, and accompanied by a bound on everything that rounding can have moved.
///
/// Let w = fl64(Rv + t) be a vertex as it stands in the world (Pose::operator()), o the origin,
/// u = 2^-53, and let a volume in the mesh's frame be given by reference points c in T with
/// |v|, |c| <= reach. With p = fl_T(fl_T(R) c + fl_T(t - o)) as `moved` computes it, and
/// e = unit roundoff of T,
///
///   |w - o - p| <= |w - (Rv + t)| + |R (v - c)| + |R c + t - o - p|
///               <= 8u (reach + |t|) + stretch |v - c| + 10e (reach + |t - o|):
///
/// - each component of w is a sum of four products and terms, off by at most
///   gamma_4 (|R_i| |v| + |t_i|); over three components and with |R_i| <= 1.01 that is less than
///   8u (|v| + |t|);
/// - |R x| <= |x| sqrt(1 + |R'R - I|_F), whatever matrix the user gave as a rotation;
/// - rounding R, c's products, t - o and the sums is gamma_5 per component, less than
///   10e (|c| + |t - o|) over three components.
///
/// `slack` is the sum of the first and the last term, plus a length whose square is still a normal
/// number of T, which pays for every underflow in what is computed from posed volumes. Lengths
/// therefore become `length * stretch + slack`, and that is what `grown` gives, rounded safely.
#pragma once

#include <cmath>

#include "hierarchies/geometry/pose.hpp"
#include "hierarchies/geometry/scalar.hpp"

namespace bvlab {

template <class T>
requires std::is_floating_point_v<T>
struct Placement {
  Mat3<T> rotation = Mat3<T>::Identity();
  Vec3<T> translation = Vec3<T>::Zero();
  T stretch = 1;  ///< at least the 2-norm of the rotation, with room for two roundings
  T slack = 0;    ///< in units of the mesh

  Placement() = default;

  /// `reach`: the largest distance of any vertex and any volume's reference point from the mesh's
  /// own origin.
  Placement(const Pose& pose, const Vec3<double>& origin, double reach) {
    constexpr double u = unit_roundoff<double>, e = unit_roundoff<T>;
    const Vec3<double> offset = pose.translation - origin;
    rotation = pose.rotation.cast<T>();
    translation = rounded<T>(offset);
    const Mat3<double> defect =
        pose.rotation.transpose() * pose.rotation - Mat3<double>::Identity();
    // `grown` rounds twice, and the defect itself is computed with an error below 16u.
    const double room = 1 + 4 * e;
    stretch = rounded_up<T>(std::sqrt(1 + defect.norm() + 16 * u) * room);
    const double tiny = std::ldexp(1.0, std::numeric_limits<T>::min_exponent / 2 + 2);
    slack = rounded_up<T>(
        (8 * u * (reach + pose.translation.norm()) + 10 * e * (reach + offset.norm()) + tiny) *
        room);
  }

  /// The point c, given in the mesh's frame, relative to the origin. S is T or a batch of it.
  template <Scalar S>
  Vec3<S> moved(const Vec3<S>& c) const {
    return directed(c) + translation.template cast<S>();
  }

  /// The direction d, given in the mesh's frame.
  template <Scalar S>
  Vec3<S> directed(const Vec3<S>& d) const {
    Vec3<S> result;
    for (int i = 0; i < 3; ++i)
      result[i] = S(rotation(i, 0)) * d[0] + S(rotation(i, 1)) * d[1] + S(rotation(i, 2)) * d[2];
    return result;
  }

  /// A length that still suffices once its ends have been moved.
  template <Scalar S>
  S grown(const S& length) const {
    return length * S(stretch) + S(slack);
  }
};

}  // namespace bvlab
