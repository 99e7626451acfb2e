// SPDX-License-Identifier: BSD-3-Clause
/// A pose prepared for bounding volumes over T: rounded to T, relative to an origin chosen near the
/// bodies, with a bound on the position error that all this rounding can cause.
///
/// Let w = fl64(Rv + t) be the position of a vertex in the world (Pose), o the origin,
/// u = 2^-53, and let a volume in the mesh's frame be given by reference points c in T with
/// |v|, |c| <= reach. With p = fl_T(fl_T(R) c + fl_T(t - o)) as `moved` computes it, and
/// e = unit roundoff of T,
///
///   |w - o - p| <= |w - (Rv + t)| + |R (v - c)| + |R c - Q c| + |Q c + t - o - p|
///               <= 8u (reach + |t|) + stretch |v - c| + |R - Q| reach + 10e (reach + |t - o|):
///
/// - Q is R where R is orthonormal to 32u, as far as float64 can show; else the
///   nearest orthonormal matrix, by Newton's iteration for the polar factor (higham1986polar):
///   a product of a thousand rotations drifts, and volumes with axes rely on right angles.
///   Where R is off by more than 0.01, `slack` is infinite, and no volumes are found disjoint;
/// - each component of w is a sum of four products and terms, off by at most
///   gamma_4 (|R_i| |v| + |t_i|); over three components and with |R_i| <= 1.01 that is less than
///   8u (|v| + |t|);
/// - |R x| <= |x| sqrt(1 + |R'R - I|_F), whatever matrix the user gave as a rotation;
/// - rounding Q, c's products, t - o and the sums is gamma_5 per component, less than
///   10e (|c| + |t - o|) over three components.
///
/// For a mesh about an origin of its own, v, t and o are local (LocalPose), and what the world's
/// vertices are off by is added to `slack` (placement_with_error).
///
/// Likewise |R d - directed(d)| <= (|R - Q| + 8e) |d| = tilt |d| for a direction: there are four
/// roundings in a component, none larger than e |Q_i| |d|, and 4 sqrt(3) < 7.
///
/// `slack` is the sum of all terms but the second, plus a length whose square is still a normal
/// number of T, which covers every underflow in tests of posed volumes. A length therefore becomes
/// `length * stretch + slack`, which is what `grown` computes, safely rounded.
#pragma once

#include <cmath>
#include <limits>
#include <type_traits>

#include "hierarchies/geometry/pose.hpp"
#include "hierarchies/geometry/scalar.hpp"
#include "hierarchies/geometry/small_matrices.hpp"

namespace bvlab {

template <class T>
  requires std::is_floating_point_v<T>
struct Placement {
  Mat3<T> rotation = Mat3<T>::Identity();
  Vec3<T> translation = Vec3<T>::Zero();
  T stretch = 1;  ///< at least the 2-norm of the rotation, with room for two roundings
  T slack = 0;    ///< position error, in units of the mesh
  T tilt = 0;     ///< at least |R d - directed(d)| for a unit vector d

  Placement() = default;

  /// `origin` is the common origin in the world; `reach`, in units of the mesh, is the largest
  /// distance of any vertex or reference point from the mesh's own origin.
  Placement(const Pose& pose, const Vec3<double>& origin, double reach) {
    constexpr double u = unit_roundoff<double>, e = unit_roundoff<T>;
    const Vec3<double> offset = pose.translation - origin;
    const double defect = defect_of(pose.rotation);
    const bool sound = defect <= sound_defect;
    const Mat3<double> nearest = sound ? pose.rotation : orthonormal(pose.rotation, defect);
    const double rotation_error = sound ? 0 : (pose.rotation - nearest).norm() + 8 * u;
    rotation = nearest.cast<T>();
    translation = rounded<T>(offset);
    // `grown` rounds twice, and the defect itself is computed with an error below 16u.
    const double room = 1 + 4 * e;
    stretch = rounded_up<T>(std::sqrt(1 + defect + 16 * u) * room);
    tilt = rounded_up<T>((rotation_error + 8 * e) * room);
    const double tiny = std::ldexp(1.0, std::numeric_limits<T>::min_exponent / 2 + 2);
    slack = rounded_up<T>((8 * u * (reach + pose.translation.norm()) +
                           10 * e * (reach + offset.norm()) +
                           (rotation_error > 0 ? rotation_error * reach : 0) + tiny) *
                          room);
    if (!sound && !(defect <= 0.01 && defect_of(nearest) <= sound_defect))
      slack = std::numeric_limits<T>::infinity();
    for (int k = 0; k < 3; ++k)
      columns_[k] = Quad{rotation(0, k), rotation(1, k), rotation(2, k), 0};
  }

  /// The same for a rotation that is known to be orthonormal to 128u, with `error_bound` added to
  /// `slack`. For float volumes only, whose own rounding is far larger than 128u.
  struct Orthonormal {};
  Placement(Orthonormal, const Mat3<double>& exactly, const Vec3<double>& offset, double reach,
            double error_bound) {
    constexpr double e = unit_roundoff<T>;
    static_assert(e > 0x1p-30);
    rotation = exactly.cast<T>();
    translation = rounded<T>(offset);
    constexpr double room = 1 + 4 * e;
    stretch = static_cast<T>(1 + 8 * e);
    tilt = static_cast<T>(9 * e);
    const double tiny = std::ldexp(1.0, std::numeric_limits<T>::min_exponent / 2 + 2);
    slack = rounded_up<T>((10 * e * (reach + offset.norm()) + error_bound + tiny) * room);
    for (int k = 0; k < 3; ++k)
      columns_[k] = Quad{rotation(0, k), rotation(1, k), rotation(2, k), 0};
  }

  /// The point c of the mesh's frame, posed relative to the origin. S is T or a batch of T.
  template <Scalar S>
  Vec3<S> moved(const Vec3<S>& c) const {
    return directed(c) + translation.template cast<S>();
  }

  /// The direction d of the mesh's frame, rotated.
  template <Scalar S>
  Vec3<S> directed(const Vec3<S>& d) const {
    if constexpr (std::is_same_v<S, T>) {
      // The same sums, all three components at once.
      const Quad sum = (columns_[0] * d[0] + columns_[1] * d[1]) + columns_[2] * d[2];
      return {sum[0], sum[1], sum[2]};
    }
    Vec3<S> result;
    for (int i = 0; i < 3; ++i)
      result[i] = S(rotation(i, 0)) * d[0] + S(rotation(i, 1)) * d[1] + S(rotation(i, 2)) * d[2];
    return result;
  }

  /// `length` enlarged to cover the stretch and the position error of posing.
  template <Scalar S>
  S grown(const S& length) const {
    return length * S(stretch) + S(slack);
  }

 private:
  using Quad [[gnu::vector_size(4 * sizeof(T))]] = T;
  Quad columns_[3] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};

  static constexpr double sound_defect = 32 * unit_roundoff<double>;

  /// The nearest orthonormal matrix. Each step squares the defect, down to rounding, below 32u. A
  /// matrix far from any rotation is replaced by the identity, to avoid NaN.
  static Mat3<double> orthonormal(Mat3<double> m, double defect) {
    if (!(defect <= 0.01)) return Mat3<double>::Identity();
    for (int step = 0; step < 8 && !(defect <= sound_defect); ++step) {
      m = towards_orthonormal(m);
      defect = defect_of(m);
    }
    return m;
  }
};

}  // namespace bvlab
