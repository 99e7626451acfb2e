// SPDX-License-Identifier: BSD-3-Clause
/// An oriented box: three axes, three half lengths, a centre (gottschalk1996obbtree). Fits flat and
/// elongated surfaces closely; costs more to pose and to test than a sphere.
///
/// The box is the set of points centre + sum s_i a_i with |s_i| <= half_i, for the axes a_i as
/// stored. They are orthonormal up to rounding: with A the matrix of rows a_i,
///
///   |AA' - I| <= 72e      (e the unit roundoff of S; the 2-norm)
///
/// - `enclosing` rounds orthonormal axes: each is off by e in length, their matrix by sqrt(3)e, and
///   AA' by 4e;
/// - `posed` rotates them by a matrix with |QQ' - I| <= 32u + 9u, the second for the accuracy
///   of the float64 check, and rounds:
///   7e an axis (see Placement), 12.2e the matrix, 25e its product.
///
/// Posing (C_u) takes about 65 multiplications and additions, a test (C_v) about 200.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>

#include "hierarchies/geometry/placement.hpp"
#include "hierarchies/geometry/principal_axes.hpp"
#include "hierarchies/geometry/tight_axes.hpp"

namespace bvlab {

template <class S>
struct ObbSiblingTest;

template <Scalar S>
struct Obb {
  static constexpr std::string_view name = "obb";
  static constexpr std::string_view description =
      "oriented box along the principal axes of the surface (Gottschalk 1996)";
  using scalar = S;
  template <class Other>
  using over = Obb<Other>;
  /// Its test in a relative frame; include wide/obb_sibling_test.hpp to use it.
  using sibling_test = ObbSiblingTest<S>;

  Vec3<S> centre;
  std::array<Vec3<S>, 3> axes;
  Vec3<S> half;

  static Obb enclosing(std::span<const Vec3<double>> points)
    requires(!Batched<S>)
  {
    return along(principal_axes(points), points);
  }
  static Obb enclosing(std::span<const Vec3<double>> points, std::span<const Triangle> triangles)
    requires(!Batched<S>)
  {
    return along(principal_axes(points, triangles), points);
  }
  /// The box around the points with `tight_axes`, a local optimum from the principal axes.
  static Obb tight(std::span<const Vec3<double>> points, std::span<const Triangle> triangles)
    requires(!Batched<S>)
  {
    return along(tight_axes(principal_axes(points, triangles), points), points);
  }

  /// The smallest box with these axes (orthonormal rows) around the points.
  ///
  /// With x = p - centre, s = (AA')^-1 A x are the point's coordinates along the rounded axes; A x
  /// differs from that by less than 5e |x|, and is computed in float64 with four roundings.
  static Obb along(const Mat3<double>& directions, std::span<const Vec3<double>> points)
    requires(!Batched<S>)
  {
    constexpr double u = unit_roundoff<double>, e = unit_roundoff<S>;
    Vec3<double> low = Vec3<double>::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const auto& p : points) {
      const Vec3<double> x = directions * (p - points[0]);
      low = low.cwiseMin(x), high = high.cwiseMax(x);
    }
    Obb box;
    box.centre = rounded<S>(points[0] + directions.transpose() * (low + high) / 2);
    const Vec3<double> centre = box.centre.template cast<double>();
    Mat3<double> axes;
    for (int i = 0; i < 3; ++i) {
      box.axes[i] = rounded<S>(directions.row(i).transpose());
      axes.row(i) = box.axes[i].template cast<double>().transpose();
    }
    Vec3<double> half = Vec3<double>::Zero();
    double farthest = 0;
    for (const auto& p : points) {
      const Vec3<double> x = p - centre;
      half = half.cwiseMax((axes * x).cwiseAbs());
      farthest = std::max(farthest, x.lpNorm<1>());
    }
    const double tiny = std::ldexp(1.0, std::numeric_limits<double>::min_exponent / 2);
    for (int i = 0; i < 3; ++i)
      box.half[i] = rounded_up<S>(half[i] + (5 * e + 8 * u) * farthest + tiny);
    return box;
  }
};

/// The box around the corners of both, each off by at most 8u of the magnitudes in its sum.
template <class S>
Obb<S> merge(const Obb<S>& a, const Obb<S>& b) {
  std::array<Vec3<double>, 16> corners;
  double largest = 0;
  for (std::size_t i = 0; i < 16; ++i) {
    const Obb<S>& box = i < 8 ? a : b;
    corners[i] = box.centre.template cast<double>();
    for (std::size_t k = 0; k < 3; ++k)
      corners[i] +=
          (i >> k & 1 ? 1.0 : -1.0) * double(box.half[k]) * box.axes[k].template cast<double>();
    largest = std::max(largest, box.centre.template cast<double>().template lpNorm<1>() +
                                    box.half.template cast<double>().sum());
  }
  Obb<S> both = Obb<S>::enclosing(corners);
  for (int i = 0; i < 3; ++i)
    both.half[i] = rounded_up<S>(both.half[i] + 16 * unit_roundoff<double> * largest);
  return both;
}

/// A point centre + sum s_i a_i goes to within slack + tilt sum |s_i| of the posed centre plus sum
/// s_i a'_i (see Placement). In coordinates along the new axes this error is longer by at most 1 +
/// 73e, and five more roundings are made here.
template <class S>
Obb<S> posed(const Obb<S>& box, const Placement<Element<S>>& placement) {
  Obb<S> result;
  result.centre = placement.moved(box.centre);
  for (int i = 0; i < 3; ++i) result.axes[i] = placement.directed(box.axes[i]);
  const S blur =
      S(placement.slack) + S(placement.tilt) * ((box.half[0] + box.half[1]) + box.half[2]);
  for (int i = 0; i < 3; ++i)
    result.half[i] =
        (box.half[i] + blur * S(1 + 80 * unit_roundoff<S>)) * S(1 + 4 * unit_roundoff<S>);
  return result;
}

namespace detail {

/// Two boxes in each other's axes, and the error margin of the separating-axis test.
///
/// For ANY vector n the boxes are apart where
///   |n.t| > sum_i half_a_i |n.a_i| + sum_j half_b_j |n.b_j|,   t the vector between the centres.
/// With c_ij = a_i.b_j the fifteen n are a_i, b_j, and n_ij = c_{i+1,j} a_{i+2} - c_{i+2,j} a_{i+1}
/// (indices modulo 3), which is a_i x b_j but for rounding. Then
///   n_ij.t        = c_{i+1,j} (a_{i+2}.t) - c_{i+2,j} (a_{i+1}.t), whatever the axes,
///   |n_ij.a_k|    = 0, |c_{i+2,j}|, |c_{i+1,j}| for k = i, i+1, i+2, but for 2d,
///   |n_ij.b_k|    = 0, |c_{i,j+2}|, |c_{i,j+1}| for k = j, j+1, j+2, but for 3d: a minor of an
///                   orthogonal matrix is its opposite entry, and (c_ij) is one but for d,
/// where d = 72e bounds |AA' - I| and |BB' - I|. Rounding adds 4e to each c_ij, 5e |t| to each a.t,
/// and 8e of what is summed. So all fifteen inequalities are safe with
///   margin = 256e (|t_0| + |t_1| + |t_2| + sum half_a + sum half_b)
/// on the right: 1.02 (3d + 4e) + 2 * 8e < 244e of the lengths, and 32e of |t|. The margin does not
/// shrink with n: where edges are near parallel n vanishes, and no axis found there separates. It
/// is infinite where any sum above could overflow, and then nothing is found apart.
template <class S>
struct ObbPair {
  Vec3<S> along_a, along_b;  // t
  std::array<std::array<S, 3>, 3> cosine, absolute;
  S margin;

  ObbPair(const Obb<S>& a, const Obb<S>& b) {
    using std::abs;
    const Vec3<S> t = b.centre - a.centre;
    S scale = (abs(t[0]) + abs(t[1])) + abs(t[2]);
    for (int i = 0; i < 3; ++i) {
      along_a[i] = dot<S>(a.axes[i], t);
      along_b[i] = dot<S>(b.axes[i], t);
      for (int j = 0; j < 3; ++j) {
        cosine[i][j] = dot<S>(a.axes[i], b.axes[j]);
        absolute[i][j] = abs(cosine[i][j]);
      }
      scale = scale + (a.half[i] + b.half[i]);
    }
    margin = (scale * S(4)) * S(64 * unit_roundoff<S>);
  }

  /// A lower bound on the gap along a_i; negative where the boxes overlap there. In units of a
  /// vector whose length is at most 1 + 37e.
  [[gnu::always_inline]] S beyond_a(const Obb<S>& a, const Obb<S>& b, int i) const {
    using std::abs;
    return abs(along_a[i]) - (((a.half[i] + b.half[0] * absolute[i][0]) +
                               (b.half[1] * absolute[i][1] + b.half[2] * absolute[i][2])) +
                              margin);
  }
  [[gnu::always_inline]] S beyond_b(const Obb<S>& a, const Obb<S>& b, int j) const {
    using std::abs;
    return abs(along_b[j]) - (((b.half[j] + a.half[0] * absolute[0][j]) +
                               (a.half[1] * absolute[1][j] + a.half[2] * absolute[2][j])) +
                              margin);
  }
  [[gnu::always_inline]] Mask<S> apart_along_edges(const Obb<S>& a, const Obb<S>& b, int i,
                                                   int j) const {
    using std::abs;
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
    return abs(cosine[i1][j] * along_a[i2] - cosine[i2][j] * along_a[i1]) >
           ((a.half[i1] * absolute[i2][j] + a.half[i2] * absolute[i1][j]) +
            (b.half[j1] * absolute[i][j2] + b.half[j2] * absolute[i][j1])) +
               margin;
  }
};

}  // namespace detail

/// A comparison with NaN (from an overflow) means not disjoint.
template <class S>
[[gnu::always_inline]] inline Mask<S> disjoint(const Obb<S>& a, const Obb<S>& b) {
  const detail::ObbPair<S> pair(a, b);
  Mask<S> apart(false);
  for (int i = 0; i < 3; ++i)
    apart = apart || pair.beyond_a(a, b, i) > S(0) || pair.beyond_b(a, b, i) > S(0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) apart = apart || pair.apart_along_edges(a, b, i, j);
  return apart;
}

/// A lower bound on the distance: that of one box from the box around the other along the first
/// one's axes, the larger of both ways. 0 where they may overlap.
template <class S>
S gap(const Obb<S>& a, const Obb<S>& b) {
  using std::max, std::min, std::sqrt;
  const detail::ObbPair<S> pair(a, b);
  S squared_a(0), squared_b(0);
  for (int i = 0; i < 3; ++i) {
    const S x = pair.beyond_a(a, b, i), y = pair.beyond_b(a, b, i);
    // Written so that NaN counts as no gap.
    const S p = select(x > S(0), x, S(0)), q = select(y > S(0), y, S(0));
    squared_a = squared_a + p * p, squared_b = squared_b + q * q;
  }
  // Where a square overflows, the largest number is still a lower bound. Coordinates along the axes
  // are at most 1 + 37e longer than lengths, and four roundings are made.
  const S largest(std::numeric_limits<Element<S>>::max());
  return sqrt(min(largest, max(squared_a, squared_b))) * S(1 - 64 * unit_roundoff<S>);
}

/// Whether the point is inside; true where the box is not finite.
template <class S>
bool contains(const Obb<S>& box, const Vec3<long double>& point) {
  using Wide = Vec3<long double>;
  const Wide x = point - box.centre.template cast<long double>();
  const std::array<Wide, 3> axes{box.axes[0].template cast<long double>(),
                                 box.axes[1].template cast<long double>(),
                                 box.axes[2].template cast<long double>()};
  for (std::size_t i = 0; i < 3; ++i) {
    const Wide normal = axes[(i + 1) % 3].cross(axes[(i + 2) % 3]);
    if (std::abs(x.dot(normal)) >
        static_cast<long double>(box.half[static_cast<int>(i)]) * std::abs(axes[i].dot(normal)))
      return false;
  }
  return true;
}

/// Half the diagonal.
template <class S>
S size(const Obb<S>& box) {
  return box.half.norm();
}

/// An upper bound on the distance of the box's points and centre from the origin of its frame.
template <class S>
S reach(const Obb<S>& box) {
  return box.centre.norm() + box.half.norm() * S(1 + 80 * unit_roundoff<S>);
}

}  // namespace bvlab
