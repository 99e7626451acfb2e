// SPDX-License-Identifier: BSD-3-Clause
/// A pose made ready for bounding volumes over T: rounded to T, relative to an origin chosen near
/// the bodies, and accompanied by a bound on everything that rounding can have moved.
///
/// Let w = fl64(Rv + t) be a vertex as it stands in the world (Pose::operator()), o the origin,
/// u = 2^-53, and let a volume in the mesh's frame be given by reference points c in T with
/// |v|, |c| <= reach. With p = fl_T(fl_T(R) c + fl_T(t - o)) as `moved` computes it, and
/// e = unit roundoff of T,
///
///   |w - o - p| <= |w - (Rv + t)| + |R (v - c)| + |R c - Q c| + |Q c + t - o - p|
///               <= 8u (reach + |t|) + stretch |v - c| + |R - Q| reach + 10e (reach + |t - o|):
///
/// - Q is R where R is orthonormal to 32u, as far as that can be told in float64; else the
///   orthonormal matrix next to it, by Newton's iteration for the polar factor (higham1986polar):
///   a product of a thousand rotations has drifted, and volumes with axes rely on right angles.
///   where R is off by more than 0.01, `slack` is infinite, and nothing is told apart;
/// - each component of w is a sum of four products and terms, off by at most
///   gamma_4 (|R_i| |v| + |t_i|); over three components and with |R_i| <= 1.01 that is less than
///   8u (|v| + |t|);
/// - |R x| <= |x| sqrt(1 + |R'R - I|_F), whatever matrix the user gave as a rotation;
/// - rounding Q, c's products, t - o and the sums is gamma_5 per component, less than
///   10e (|c| + |t - o|) over three components.
///
/// Likewise |R d - directed(d)| <= (|R - Q| + 8e) |d| = tilt |d| for a direction: there are four
/// roundings in a component, none larger than e |Q_i| |d|, and 4 sqrt(3) < 7.
///
/// `slack` is the sum of all terms but the second, plus a length whose square is still a normal
/// number of T, which pays for every underflow in what is computed from posed volumes. Lengths
/// therefore become `length * stretch + slack`, and that is what `grown` gives, rounded safely.
#pragma once

#include <cmath>

#include "hierarchies/geometry/pose.hpp"
#include "hierarchies/geometry/scalar.hpp"
#include "hierarchies/geometry/written_out.hpp"

namespace bvlab {

template <class T>
  requires std::is_floating_point_v<T>
struct Placement {
  Mat3<T> rotation = Mat3<T>::Identity();
  Vec3<T> translation = Vec3<T>::Zero();
  T stretch = 1;  ///< at least the 2-norm of the rotation, with room for two roundings
  T slack = 0;    ///< in units of the mesh
  T tilt = 0;     ///< at least |R d - directed(d)| for a unit vector d

  Placement() = default;

  /// `reach`: the largest distance of any vertex and any volume's reference point from the mesh's
  /// own origin.
  Placement(const Pose& pose, const Vec3<double>& origin, double reach) {
    constexpr double u = unit_roundoff<double>, e = unit_roundoff<T>;
    const Vec3<double> offset = pose.translation - origin;
    const double defect = defect_of(pose.rotation);
    const bool sound = defect <= sound_defect;
    const Mat3<double> nearest = sound ? pose.rotation : orthonormal(pose.rotation, defect);
    const double turned = sound ? 0 : (pose.rotation - nearest).norm() + 8 * u;
    rotation = nearest.cast<T>();
    translation = rounded<T>(offset);
    // `grown` rounds twice, and the defect itself is computed with an error below 16u.
    const double room = 1 + 4 * e;
    stretch = rounded_up<T>(std::sqrt(1 + defect + 16 * u) * room);
    tilt = rounded_up<T>((turned + 8 * e) * room);
    const double tiny = std::ldexp(1.0, std::numeric_limits<T>::min_exponent / 2 + 2);
    slack = rounded_up<T>((8 * u * (reach + pose.translation.norm()) +
                           10 * e * (reach + offset.norm()) + (turned > 0 ? turned * reach : 0) +
                           tiny) *
                          room);
    if (!sound && !(defect <= 0.01 && defect_of(nearest) <= sound_defect))
      slack = std::numeric_limits<T>::infinity();
    for (int k = 0; k < 3; ++k)
      columns_[k] = Quad{rotation(0, k), rotation(1, k), rotation(2, k), 0};
  }

  /// The same for a rotation that is known to be orthonormal to 128u (float volumes only: theirs is
  /// the larger rounding by far), and `error bound` beside what is said above.
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

  /// The point c, given in the mesh's frame, relative to the origin. S is T or a batch of it.
  template <Scalar S>
  Vec3<S> moved(const Vec3<S>& c) const {
    return directed(c) + translation.template cast<S>();
  }

  /// The direction d, given in the mesh's frame.
  template <Scalar S>
  Vec3<S> directed(const Vec3<S>& d) const {
    if constexpr (std::is_same_v<S, T>) {
      // The same sums, all three at once.
      const Quad sum = (columns_[0] * d[0] + columns_[1] * d[1]) + columns_[2] * d[2];
      return {sum[0], sum[1], sum[2]};
    }
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

 private:
  using Quad [[gnu::vector_size(4 * sizeof(T))]] = T;
  Quad columns_[3] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};

  static constexpr double sound_defect = 32 * unit_roundoff<double>;

  /// Each step squares the defect, down to less than 32u, which is rounding. What is no rotation by
  /// far is replaced, lest it make numbers that are none.
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
