// SPDX-License-Identifier: BSD-3-Clause
/// A rectangle swept by a sphere (RSS): all points within `radius` of centre + s side_0 + t side_1,
/// |s| <= half_0 and |t| <= half_1 (larsen2000fast). Fits flat surfaces as a box does, with rounded
/// edges: the usual choice for distance queries.
///
/// The set is defined by the sides exactly as stored; correctness does not need them orthonormal,
/// only tightness does. Posing (C_u) takes about 50 multiplications and additions, a test (C_v)
/// about 150.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>

#include "hierarchies/geometry/placement.hpp"
#include "hierarchies/geometry/principal_axes.hpp"
#include "hierarchies/geometry/swept_rectangle.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

template <Scalar S>
struct Rss {
  static constexpr std::string_view name = "rss";
  static constexpr std::string_view description =
      "rectangle swept by a sphere, along the principal axes of the surface (Larsen 2000)";
  using scalar = S;
  template <class Other>
  using over = Rss<Other>;

  Vec3<S> centre;
  std::array<Vec3<S>, 2> side;  ///< of unit length up to rounding
  std::array<S, 2> half;
  S radius;

  static Rss enclosing(std::span<const Vec3<double>> points)
    requires(!Batched<S>)
  {
    return along(principal_axes(points), points);
  }
  static Rss enclosing(std::span<const Vec3<double>> points, std::span<const Triangle> triangles)
    requires(!Batched<S>)
  {
    return along(principal_axes(points, triangles), points);
  }
  /// The volume around the points with the least surface that a search from the principal axes
  /// finds: four to five times as expensive to fit.
  static Rss tight(std::span<const Vec3<double>> points, std::span<const Triangle> triangles)
    requires(!Batched<S>)
  {
    return of(tight_swept_rectangle(principal_axes(points, triangles), points), points);
  }

  /// The volume with its rectangle in the plane of the first two directions (orthonormal rows).
  static Rss along(const Mat3<double>& directions, std::span<const Vec3<double>> points)
    requires(!Batched<S>)
  {
    return of(swept_rectangle(directions, points), points);
  }

  /// The rounded rectangle, with the radius that the points then need.
  static Rss of(const SweptRectangle& rectangle, std::span<const Vec3<double>> points)
    requires(!Batched<S>)
  {
    Rss rss;
    rss.centre = rounded<S>(rectangle.centre());
    for (int k = 0; k < 2; ++k) {
      const auto i = static_cast<std::size_t>(k);
      rss.side[i] = rounded<S>(rectangle.axes.row(k).transpose());
      rss.half[i] = rounded_up<S>(rectangle.half(k));
    }
    rss.radius = radius_for(rss, points);
    return rss;
  }

  /// A bound on the farthest point's distance from the stored rectangle: the distance to any point
  /// of the rectangle is one. Sums and squares take fewer than ten roundings, each less than u of
  /// the lengths in the sum.
  static S radius_for(const Rss& rss, std::span<const Vec3<double>> points)
    requires(!Batched<S>)
  {
    constexpr double u = unit_roundoff<double>;
    const Vec3<double> centre = rss.centre.template cast<double>();
    double radius = 0, farthest = 0;
    for (const auto& p : points) {
      Vec3<double> x = p - centre;
      farthest = std::max(farthest, x.lpNorm<1>());
      for (std::size_t k = 0; k < 2; ++k) {
        const Vec3<double> side = rss.side[k].template cast<double>();
        x -= std::clamp<double>(side.dot(x), -rss.half[k], rss.half[k]) * side;
      }
      radius = std::max(radius, x.norm());
    }
    const double tiny = std::ldexp(1.0, std::numeric_limits<double>::min_exponent / 2);
    return rounded_up<S>(
        radius + 16 * u * (farthest + radius + double(rss.half[0]) + double(rss.half[1])) + tiny);
  }
};

/// The volume around the corners of both rectangles, its radius enlarged by the larger of the two;
/// the corners are off by at most 8u of the magnitudes in their sums.
template <class S>
Rss<S> merge(const Rss<S>& a, const Rss<S>& b) {
  constexpr double u = unit_roundoff<double>;
  std::array<Vec3<double>, 8> corners;
  double largest = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    const Rss<S>& rss = i < 4 ? a : b;
    corners[i] = rss.centre.template cast<double>();
    for (std::size_t k = 0; k < 2; ++k)
      corners[i] +=
          (i >> k & 1 ? 1.0 : -1.0) * double(rss.half[k]) * rss.side[k].template cast<double>();
    largest = std::max(largest, rss.centre.template cast<double>().template lpNorm<1>() +
                                    double(rss.half[0]) + double(rss.half[1]));
  }
  Rss<S> both = Rss<S>::enclosing(corners);
  const double larger_radius = std::max(a.radius, b.radius);
  both.radius = rounded_up<S>((both.radius + larger_radius) * (1 + 4 * u) + 16 * u * largest);
  return both;
}

/// A point centre + sum s_k side_k + y goes to within slack + tilt (|s_0| + |s_1|) + stretch |y| of
/// the posed rectangle (see Placement); four more roundings are made here.
template <class S>
Rss<S> posed(const Rss<S>& rss, const Placement<Element<S>>& placement) {
  Rss<S> result;
  result.centre = placement.moved(rss.centre);
  for (std::size_t k = 0; k < 2; ++k) result.side[k] = placement.directed(rss.side[k]);
  result.half = rss.half;
  const S tilted = S(placement.tilt) * (rss.half[0] + rss.half[1]);
  result.radius = (placement.grown(rss.radius) + tilted) * S(1 + 8 * unit_roundoff<S>);
  return result;
}

/// A lower bound on the distance, found along one direction; 0 where they may overlap.
///
/// For ANY vector n their distance is at least
///   (n.t - sum_k half_a_k |n.a_k| - sum_k half_b_k |n.b_k|) / |n| - radius_a - radius_b
/// with t the vector between the centres, and exactly that where n joins the nearest points of
/// the rectangles. So n joins points that are nearly nearest: each in turn is replaced by
/// its rectangle's nearest point to the other, which converges (Cheney, Goldstein 1959). How
/// n was rounded does not matter; t is off by e in each coordinate, each product with n by 4e
/// |n| of the other factor's length, and what is summed by 5e: with lengths 1.01 at most for the
/// sides, all of it is less than
///   16e |n| (|t_0| + |t_1| + |t_2| + sum of the half lengths).
template <class S>
[[gnu::always_inline]] inline S gap(const Rss<S>& a, const Rss<S>& b) {
  using std::abs, std::max, std::min, std::sqrt;
  using T = Element<S>;
  constexpr T e = unit_roundoff<S>;
  constexpr int rounds = 3;
  const Vec3<S> t = b.centre - a.centre;
  Vec3<S> on_b = t, on_a;
  for (int round = 0; round < rounds; ++round) {
    on_a = Vec3<S>(S(0), S(0), S(0));
    for (std::size_t k = 0; k < 2; ++k) {
      const S s = min(max(dot<S>(on_b, a.side[k]), -a.half[k]), a.half[k]);
      on_a = on_a + a.side[k] * s;
    }
    const Vec3<S> offset = on_a - t;
    on_b = t;
    for (std::size_t k = 0; k < 2; ++k) {
      const S s = min(max(dot<S>(offset, b.side[k]), -b.half[k]), b.half[k]);
      on_b = on_b + b.side[k] * s;
    }
  }
  const Vec3<S> n = on_b - on_a;
  const S squared = squared_norm<S>(n);
  const S length = sqrt(squared);
  const S extent = (a.half[0] * abs(dot<S>(n, a.side[0])) + a.half[1] * abs(dot<S>(n, a.side[1]))) +
                   (b.half[0] * abs(dot<S>(n, b.side[0])) + b.half[1] * abs(dot<S>(n, b.side[1])));
  const S scale =
      ((abs(t[0]) + abs(t[1])) + abs(t[2])) + ((a.half[0] + a.half[1]) + (b.half[0] + b.half[1]));
  const S apart = ((dot<S>(n, t) - extent) / length) * S(1 - 8 * e) -
                  ((a.radius + b.radius) * S(1 + 4 * e) + scale * S(16 * e));
  // Where squares under- or overflow the gap is unknown, so 0; NaN counts as 0.
  const S largest(std::numeric_limits<T>::max() / 16), smallest(std::numeric_limits<T>::min() * 64);
  const Mask<S> known = apart > S(0) && squared > smallest && scale * scale < largest;
  return select(known, apart, S(0));
}

template <class S>
[[gnu::always_inline]] inline Mask<S> disjoint(const Rss<S>& a, const Rss<S>& b) {
  return gap(a, b) > S(0);
}

/// Whether the point is inside, by the nearest point of the rectangle, found by alternating between
/// its two coordinates: exact at once where the sides are at right angles, soon where they nearly
/// are. True where the volume is not finite.
template <class S>
bool contains(const Rss<S>& rss, const Vec3<long double>& point) {
  const Vec3<long double> x = point - rss.centre.template cast<long double>();
  const std::array<Vec3<long double>, 2> side{rss.side[0].template cast<long double>(),
                                              rss.side[1].template cast<long double>()};
  long double at[2] = {0, 0};
  for (int round = 0; round < 8; ++round)
    for (std::size_t k = 0; k < 2; ++k) {
      const Vec3<long double> rest = x - at[1 - k] * side[1 - k];
      const long double half = rss.half[k];
      at[k] = std::clamp(side[k].dot(rest) / side[k].squaredNorm(), -half, half);
    }
  const auto radius = static_cast<long double>(rss.radius);
  return !((x - at[0] * side[0] - at[1] * side[1]).squaredNorm() > radius * radius);
}

/// Half the diagonal of the rectangle, plus the radius.
template <class S>
S size(const Rss<S>& rss) {
  using std::sqrt;
  return sqrt(rss.half[0] * rss.half[0] + rss.half[1] * rss.half[1]) + rss.radius;
}

/// An upper bound on the distance of the volume and its centre from the origin of its frame.
template <class S>
S reach(const Rss<S>& rss) {
  return rss.centre.norm() + size(rss) * S(1 + 80 * unit_roundoff<S>);
}

}  // namespace bvlab
