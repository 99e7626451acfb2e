// SPDX-License-Identifier: BSD-3-Clause
/// The distance of two closed triangles and their nearest points: 0 exactly where they touch.
///
/// Disjoint triangles are nearest to each other at a corner and an edge, at two edges, or at a
/// corner and a face. All 33 such candidates are computed in float64; those that could be the
/// nearest but are not accurate enough are computed again in double-double. Zero area, parallel
/// edges and slivers need no special case: the other candidates remain, and each is attained by
/// points of the two triangles, so it is never too small.
///
/// Error: with d the true distance and L the largest difference of coordinates in the pair, the
/// distance is off by at most 1e-14 d + 2^-90 L + 2^-1074, for all finite corners: where the
/// triangles are 10^13 times as large as d, that is still 1e-14 of d. (The result is infinite
/// where d exceeds the largest number.) A candidate's vector r = w - s e - t f carries the
/// roundings of its terms, 3 u R, R = |w| + 2 |s e| + 2 |t f|, to first order. An error of s and t,
/// at most 12 u R along e and f, stays in r at a right angle, since r is stationary in them: in
/// |r|, that is second order unless r itself is that short. So a candidate whose value passes R /
/// 20 is right to 60 u; one whose value, lowered by 16 u R, is above the least is not the nearest;
/// the others are formed again with u = 2^-102, as are those of which float64 cannot tell where
/// they are.
///
/// Range: `apart` is for pairs in which no number is above 2^100 and L is not below 2^-100. What
/// underflows is then an edge, or a difference, too short by 2^-300 to matter beside 2^-90 L; all
/// other pairs are first translated and scaled into that range, with an error that is negligible
/// beside the bound above.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "traversal/primitives/nearest_candidates.hpp"
#include "traversal/primitives/triangle_intersection.hpp"

namespace bvlab {

struct TriangleDistance {
  double distance = 0;
  Vec3<double> on_a = Vec3<double>::Zero(), on_b = Vec3<double>::Zero();  ///< the nearest points
};

namespace nearest {

template <class T>
Vec3<double> between(const Vec3<double>& p, const Vec3<double>& q, const T& r) {
  const Vector<T> e = difference<T>(q, p);
  Vec3<double> point;
  for (int i = 0; i < 3; ++i) point[i] = static_cast<double>(T(p[i]) + r * e[i]);
  return point;
}

/// Calls f(point, squared) for each point where an edge of `edges` crosses the plane of `t`, with
/// its squared distance from `t`.
template <class T, class F>
void for_each_crossing(const Triangle& t, const Triangle& edges, const F& f) {
  const Vector<T> n = cross(difference<T>(t[1], t[0]), difference<T>(t[2], t[0]));
  T side[3];
  for (int i = 0; i < 3; ++i) side[i] = dot(n, difference<T>(edges[i], t[0]));
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    if (!(side[i] > T(0) && side[j] < T(0)) && !(side[i] < T(0) && side[j] > T(0))) continue;
    const Vec3<double> point = between<T>(edges[i], edges[j], side[i] / (side[i] - side[j]));
    double squared = static_cast<double>(corner_face<T>(point, t[0], t[1], t[2]).squared);
    for (int k = 0; k < 3; ++k)
      squared = std::min(squared,
                         static_cast<double>(corner_edge<T>(point, t[k], t[(k + 1) % 3]).squared));
    f(point, squared);
  }
}

/// A point shared by touching triangles, up to rounding: an edge's crossing with the other's plane,
/// or that of the nearest candidate.
template <class T>
TriangleDistance touching(const Triangle& a, const Triangle& b) {
  double least = std::numeric_limits<double>::infinity();
  TriangleDistance result;
  const auto offer = [&](const Vec3<double>& point, double squared) {
    if (squared < least) least = squared, result.on_a = result.on_b = point;
  };
  for (int k = 0; k < candidates; ++k) {
    const auto c = candidate<T>(a, b, k);
    if (static_cast<double>(c.squared) < least)
      offer(points_of<T>(a, b, k, c.s, c.t)[0], static_cast<double>(c.squared));
  }
  for_each_crossing<T>(a, b, offer);
  for_each_crossing<T>(b, a, offer);
  // Farther from both than rounding explains: in slivers float64 can be that wrong.
  if constexpr (std::is_same_v<T, double>) {
    const double grain = 4 * unit_roundoff<double> * result.on_a.cwiseAbs().maxCoeff();
    if (least > grain * grain) return touching<DoubleDouble>(a, b);
  }
  return result;
}

/// The box of all six corners.
struct Extent {
  Vec3<double> low, high;

  Extent(const Triangle& a, const Triangle& b) : low(a[0]), high(a[0]) {
    for (const Triangle* t : {&a, &b})
      for (const auto& p : *t) low = low.cwiseMin(p), high = high.cwiseMax(p);
  }
  /// Its longest side, or the largest number if that overflows.
  double longest() const {
    return std::min((high - low).maxCoeff(), std::numeric_limits<double>::max());
  }
};

/// For disjoint triangles whose coordinates and extents are in the range stated above; the points
/// are computed in T.
template <class T = double>
TriangleDistance apart(const Triangle& a, const Triangle& b) {
  constexpr double u = unit_roundoff<double>;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::array<Candidate<double>, candidates> all;
  double least = infinity;
  int best = 0;
  for (int k = 0; k < candidates; ++k) {
    all[k] = candidate<double>(a, b, k);
    if (all[k].squared < least) least = all[k].squared, best = k;
  }
  // The nearest candidate is below `reach`, if it is not among the doubtful.
  const auto error = [](const auto& c) { return 16 * u * c.rounding; };
  const double nearest = std::sqrt(least), reach = nearest + error(all[best]);
  const auto far_apart = [&] { return Extent(a, b).longest() <= 0x1p20 * nearest; };
  least = infinity;
  double s = 0, t = 0;
  for (int k = 0; k < candidates; ++k) {
    const auto& rough = all[k];
    const double value = std::sqrt(rough.squared);
    const bool certain =
        rough.doubt == Doubt::none || (rough.doubt == Doubt::parallel && far_apart());
    if (certain && (!(value < infinity) || value - error(rough) > reach)) continue;
    if (certain && rough.rounding <= 20 * value) {
      if (rough.squared < least) least = rough.squared, best = k, s = rough.s, t = rough.t;
      continue;
    }
    const auto again = candidate<DoubleDouble>(a, b, k);
    if (again.squared.high < least)
      least = again.squared.high, best = k, s = again.s.high, t = again.t.high;
  }
  auto [on_a, on_b] = points_of<double>(a, b, best, s, t);
  if constexpr (!std::is_same_v<T, double>)
    if (const auto exact = candidate<T>(a, b, best);
        std::isfinite(static_cast<double>(exact.squared))) {
      const auto points = points_of<T>(a, b, best, exact.s, exact.t);
      on_a = points[0], on_b = points[1];
    }
  // The distance of disjoint triangles is never 0, however small.
  return {std::max(std::sqrt(least), std::numeric_limits<double>::denorm_min()), on_a, on_b};
}

/// The exponent of the power of two by which coordinates must be divided before they are squared
/// and multiplied; 0 where they are safe as they are.
inline int exponent_of(const Triangle& a, const Triangle& b) {
  double largest = 0;
  for (const Triangle* t : {&a, &b})
    for (const auto& p : *t) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  if (largest == 0 || (largest < 0x1p100 && largest > 0x1p-100)) return 0;
  int exponent;
  std::frexp(largest, &exponent);
  return exponent;
}

inline Vec3<double> scaled(const Vec3<double>& p, int exponent) {
  return {std::ldexp(p[0], exponent), std::ldexp(p[1], exponent), std::ldexp(p[2], exponent)};
}

inline Triangle scaled(const Triangle& t, int exponent) {
  return {scaled(t[0], exponent), scaled(t[1], exponent), scaled(t[2], exponent)};
}

/// The same for disjoint triangles of any scale. On an axis where all six coordinates are within a
/// factor of two the lowest is subtracted, which is exact; on the others they are at most twice the
/// extent. Divided by the power of two above the largest extent, no coordinate is above 4, and what
/// underflows is less than 2^-1074 of the extent.
template <class T = double>
TriangleDistance apart_at_any_scale(const Triangle& a, const Triangle& b) {
  const Extent extent(a, b);
  Vec3<double> origin = Vec3<double>::Zero();
  for (int i = 0; i < 3; ++i) {
    const double low = extent.low[i], high = extent.high[i];
    if ((low > 0 && high <= 2 * low) || (high < 0 && low >= 2 * high)) origin[i] = low;
  }
  int exponent;
  std::frexp(extent.longest(), &exponent);
  const auto moved = [&](const Triangle& t) {
    return scaled(Triangle{t[0] - origin, t[1] - origin, t[2] - origin}, -exponent);
  };
  TriangleDistance result = apart<T>(moved(a), moved(b));
  result.distance =
      std::max(std::ldexp(result.distance, exponent), std::numeric_limits<double>::denorm_min());
  result.on_a = scaled(result.on_a, exponent) + origin;
  result.on_b = scaled(result.on_b, exponent) + origin;
  return result;
}

}  // namespace nearest

/// The distance of two closed triangles with finite corners; 0 if and only if they share a point.
/// The points are computed in T, float64 or double-double; the distance does not depend on it.
// A template, so that a program can compile it once (extern template).
template <class T = double>
TriangleDistance distance(const Triangle& a, const Triangle& b) {
  using namespace nearest;
  const int k = exponent_of(a, b);
  if (intersect(a, b)) {
    if (k == 0) return touching<T>(a, b);
    TriangleDistance result = touching<T>(scaled(a, -k), scaled(b, -k));
    result.on_a = scaled(result.on_a, k), result.on_b = scaled(result.on_b, k);
    return result;
  }
  if (k != 0) return apart_at_any_scale<T>(a, b);
  const TriangleDistance result = apart<T>(a, b);
  // Coordinates of moderate size may be next to each other: only then is the computed distance this
  // small, whether right or not.
  return result.distance < 0x1p-98 ? apart_at_any_scale<T>(a, b) : result;
}

}  // namespace bvlab
