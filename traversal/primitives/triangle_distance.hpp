// SPDX-License-Identifier: BSD-3-Clause
/// How far two closed triangles are apart, and where: 0 exactly where they share a point.
///
/// Triangles that are apart are nearest to each other at a corner and an edge, at two edges, or at
/// a corner and a face. All 33 such candidates are formed in float64; whichever could be the
/// nearest and is not accurate enough is formed again in double-double. Zero area, parallel edges
/// and slivers need no case of their own: a candidate that does not exist is left to the others,
/// for each gives points of the two triangles and so never too small a distance.
///
/// Error: with d the true distance and L the largest difference of coordinates in the pair, the
/// distance is off by at most 1e-14 d + 2^-90 L + 2^-1074, whatever finite corners: where the
/// triangles are 10^13 times as large as their distance, that is still 1e-14 of it. (It is infinite
/// where it is beyond the largest number.) A candidate's vector r = w - s e - t f carries the
/// roundings of its terms, 3 u R, R = |w| + 2 |s e| + 2 |t f|, to first order. An error of s and t,
/// at most 12 u R along e and f, stays in r at a right angle, since r is stationary in them: in
/// |r|, that is second order unless r itself is that short. So a candidate whose value passes R /
/// 20 is right to 60 u; one whose value, lowered by 16 u R, is above the least is not the nearest;
/// the others are formed again with u = 2^-102, as are those of which float64 cannot tell where
/// they are.
///
/// Range: `apart` is for pairs in which no number is above 2^100 and L is not below 2^-100. What
/// underflows is then an edge, or a difference, too short by 2^-300 to matter beside 2^-90 L; all
/// other pairs are moved and scaled there first, without error as far as that matters.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "hierarchies/geometry/double_double.hpp"
#include "traversal/primitives/triangle_intersection.hpp"

namespace bvlab {

struct TriangleDistance {
  double distance = 0;
  Vec3<double> on_a = Vec3<double>::Zero(), on_b = Vec3<double>::Zero();  ///< the nearest points

  double squared() const { return distance * distance; }
};

namespace nearest {

template <class T>
using Vector = std::array<T, 3>;

template <class T>
Vector<T> difference(const Vec3<double>& a, const Vec3<double>& b) {
  if constexpr (std::is_same_v<T, DoubleDouble>)
    return {T::sum(a[0], -b[0]), T::sum(a[1], -b[1]), T::sum(a[2], -b[2])};
  else
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T>
Vector<T> cross(const Vector<T>& u, const Vector<T>& v) {
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}
template <class T>
T dot(const Vector<T>& u, const Vector<T>& v) {
  return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/// Whether float64 can be trusted on where, or whether, a candidate is. `parallel`: two edges, or a
/// face's own, at an angle below 2^-48. Then some end or edge is as near in all but the second
/// order, (2^-48 L)^2 / 2d, which matters only where d is much smaller than L. `open`: an angle
/// below 2^-20, or points so close to where the candidate ends that rounding may have put them
/// outside, and that would matter.
enum class Doubt { none, parallel, open };

/// One way in which two triangles can be nearest: the vector from a's point to b's and the
/// parameters of those points. Infinite where there is no such way.
template <class T>
struct Candidate {
  T squared = T(std::numeric_limits<double>::infinity());
  T s = T(0), t = T(0);
  double rounding = 0;  ///< |w| + 2 |s e| + 2 |t f|, each the sum of coordinates' magnitudes
  Doubt doubt = Doubt::none;
};

template <class T>
double magnitude(const Vector<T>& v) {
  return std::abs(static_cast<double>(v[0])) + std::abs(static_cast<double>(v[1])) +
         std::abs(static_cast<double>(v[2]));
}

/// The vector w - s e - t f.
template <class T>
Candidate<T> reached(const Vector<T>& w, const T& s, const Vector<T>& e, const T& t,
                     const Vector<T>& f) {
  Candidate<T> candidate;
  Vector<T> r;
  for (int i = 0; i < 3; ++i) r[i] = w[i] - s * e[i] - t * f[i];
  candidate.squared = dot(r, r);
  candidate.s = s, candidate.t = t;
  candidate.rounding = magnitude(w) + 2 * (std::abs(static_cast<double>(s)) * magnitude(e) +
                                           std::abs(static_cast<double>(t)) * magnitude(f));
  return candidate;
}

/// The vector w between two corners.
template <class T>
Candidate<T> corners_apart(const Vector<T>& w) {
  Candidate<T> candidate;
  candidate.squared = dot(w, w);
  candidate.rounding = magnitude(w);
  return candidate;
}

/// Corner p, edge a b: the point of the edge is a + s (b - a).
///
/// s |e| is off by up to 12 u |w|, so that a point said to be at an end may be inside by as much.
/// At a that is next to nothing beside |r| = |w|. At b, where |w| <= |e| + |r|, it makes |r| too
/// long by a factor of up to 1 + (12 u |w| / |r|)^2 / 2, which is below 1 + 2u only if |r| > 2^-24
/// |e|.
template <class T>
Candidate<T> corner_edge(const Vec3<double>& p, const Vec3<double>& a, const Vec3<double>& b) {
  const Vector<T> e = difference<T>(b, a), w = difference<T>(p, a);
  const T along = dot(w, e), length = dot(e, e);
  if (!(along > T(0))) return corners_apart<T>(w);
  if (!(along < length)) {
    Candidate<T> end = corners_apart<T>(difference<T>(p, b));
    end.s = T(1);
    if (!(static_cast<double>(end.squared) > 0x1p-48 * static_cast<double>(length)))
      end.doubt = Doubt::open;
    return end;
  }
  return reached<T>(w, along / length, e, T(0), e);
}

/// The nearest points of two lines or of a point and a plane: w - s e - t f is orthogonal to e and
/// f. By cross products, which lose half as many digits as Gram's determinant where e and f are
/// nearly parallel. `inner` says whether s and t are inside, given by how much (negative: outside).
template <class T, class Inside>
Candidate<T> orthogonal(const Vector<T>& w, const Vector<T>& e, const Vector<T>& f,
                        const Inside& inside) {
  const Vector<T> n = cross(e, f);
  const T square = dot(n, n);
  const double sine_squared = static_cast<double>(square) /
                              (static_cast<double>(dot(e, e)) * static_cast<double>(dot(f, f)));
  Candidate<T> candidate;
  // So written that 0 / 0 is parallel.
  const Doubt narrow = !(sine_squared >= 0x1p-96) ? Doubt::parallel
                       : sine_squared < 0x1p-40   ? Doubt::open
                                                  : Doubt::none;
  candidate.doubt = narrow;
  if (!(square > T(0))) return candidate;
  // What is wrong with n would stay in s e + t f; t made from s leaves only s's own error, and of
  // that what is orthogonal to f.
  const T s = dot(cross(w, f), n) / square;
  Vector<T> rest;
  for (int i = 0; i < 3; ++i) rest[i] = w[i] - s * e[i];
  const T t = dot(rest, f) / dot(f, f);
  const double depth = static_cast<double>(inside(s, t));
  if (depth > 0) {
    candidate = reached<T>(w, s, e, t, f);
    candidate.doubt = narrow;
  } else if (narrow == Doubt::none &&
             -depth < 0x1p-20 * (1 + magnitude(w) / std::min(magnitude(e), magnitude(f)))) {
    candidate.doubt = Doubt::open;
  }
  return candidate;
}

/// Inner points of the edges a b and c d: a + s (b - a) and c + t (d - c).
template <class T>
Candidate<T> edge_edge(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c,
                       const Vec3<double>& d) {
  return orthogonal<T>(difference<T>(c, a), difference<T>(b, a), difference<T>(c, d),
                       [](const T& s, const T& t) {
                         return std::min(std::min(s, t), std::min(T(1) - s, T(1) - t));
                       });
}

/// Corner p, inner point a + s (b - a) + t (c - a) of a face.
template <class T>
Candidate<T> corner_face(const Vec3<double>& p, const Vec3<double>& a, const Vec3<double>& b,
                         const Vec3<double>& c) {
  return orthogonal<T>(
      difference<T>(p, a), difference<T>(b, a), difference<T>(c, a),
      [](const T& s, const T& t) { return std::min(std::min(s, t), T(1) - s - t); });
}

constexpr int corner_edges = 18, edge_edges = 9, corner_faces = 6;
constexpr int candidates = corner_edges + edge_edges + corner_faces;

/// The k-th candidate: corners of a against edges of b, the reverse, edges, corners of a against b,
/// corners of b against a.
template <class T>
Candidate<T> candidate(const Triangle& a, const Triangle& b, int k) {
  const auto next = [](int i) { return i == 2 ? 0 : i + 1; };
  if (k < corner_edges) {
    const int i = k % 9 / 3, j = k % 3;
    return k < 9 ? corner_edge<T>(a[i], b[j], b[next(j)]) : corner_edge<T>(b[i], a[j], a[next(j)]);
  }
  k -= corner_edges;
  if (k < edge_edges) return edge_edge<T>(a[k / 3], a[next(k / 3)], b[k % 3], b[next(k % 3)]);
  k -= edge_edges;
  return k < 3 ? corner_face<T>(a[k], b[0], b[1], b[2])
               : corner_face<T>(b[k - 3], a[0], a[1], a[2]);
}

/// The points of the k-th candidate, from its parameters.
inline std::array<Vec3<double>, 2> points_of(const Triangle& a, const Triangle& b, int k, double s,
                                             double t) {
  const auto next = [](int i) { return i == 2 ? 0 : i + 1; };
  const auto along = [&](const Triangle& triangle, int j, double r) -> Vec3<double> {
    const auto &p = triangle[j], &q = triangle[next(j)];
    return r == 1 ? q : Vec3<double>(p + r * (q - p));
  };
  const auto inside = [&](const Triangle& q) -> Vec3<double> {
    return q[0] + s * (q[1] - q[0]) + t * (q[2] - q[0]);
  };
  if (k < 9) return {a[k / 3], along(b, k % 3, s)};
  if (k < corner_edges) return {along(a, k % 3, s), b[k % 9 / 3]};
  k -= corner_edges;
  if (k < edge_edges) return {along(a, k / 3, s), along(b, k % 3, t)};
  k -= edge_edges;
  if (k < 3) return {a[k], inside(b)};
  return {inside(a), b[k - 3]};
}

template <class T>
Vec3<double> between(const Vec3<double>& p, const Vec3<double>& q, const T& r) {
  const Vector<T> e = difference<T>(q, p);
  Vec3<double> point;
  for (int i = 0; i < 3; ++i) point[i] = static_cast<double>(T(p[i]) + r * e[i]);
  return point;
}

/// Where the edges of `edges` cross the plane of `t`: each point, and how far it is from `t`,
/// squared.
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

/// A point that touching triangles share, up to rounding: where an edge crosses the other's plane,
/// or the nearest candidate.
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
      offer(points_of(a, b, k, static_cast<double>(c.s), static_cast<double>(c.t))[0],
            static_cast<double>(c.squared));
  }
  for_each_crossing<T>(a, b, offer);
  for_each_crossing<T>(b, a, offer);
  // Far from both, for rounding: in slivers float64 can miss the place.
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
  /// Its longest side; at most the largest number.
  double longest() const {
    return std::min((high - low).maxCoeff(), std::numeric_limits<double>::max());
  }
};

/// For triangles that are apart, of coordinates and extents in the range said above.
template <class = double>
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
  // Below `reach` lies the nearest for certain, but for the doubtful.
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
  const auto [on_a, on_b] = points_of(a, b, best, s, t);
  // Apart is never 0, however small.
  return {std::max(std::sqrt(least), std::numeric_limits<double>::denorm_min()), on_a, on_b};
}

/// The power of two by which coordinates are divided before they are squared and multiplied; none
/// where that is safe as they stand.
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

/// The same for any that are apart. Where all six coordinates along an axis lie within a factor of
/// two they are taken from the lowest of them, which rounds nothing; all others are at most twice
/// the extent along their axis. Divided by the power of two above the largest extent, none is above
/// 4 then, and what underflows loses less than 2^-1074 of the extent.
template <class = double>
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
  TriangleDistance result = apart(moved(a), moved(b));
  result.distance =
      std::max(std::ldexp(result.distance, exponent), std::numeric_limits<double>::denorm_min());
  result.on_a = scaled(result.on_a, exponent) + origin;
  result.on_b = scaled(result.on_b, exponent) + origin;
  return result;
}

}  // namespace nearest

/// The distance of two closed triangles with finite corners; 0 if and only if they share a point.
// A template, so that a program can compile it once (extern template).
template <class = double>
TriangleDistance distance(const Triangle& a, const Triangle& b) {
  using namespace nearest;
  const int k = exponent_of(a, b);
  if (intersect(a, b)) {
    if (k == 0) return touching<double>(a, b);
    TriangleDistance result = touching<double>(scaled(a, -k), scaled(b, -k));
    result.on_a = scaled(result.on_a, k), result.on_b = scaled(result.on_b, k);
    return result;
  }
  if (k != 0) return apart_at_any_scale(a, b);
  const TriangleDistance result = apart(a, b);
  // Coordinates may be neither large nor small and yet stand next to each other: only so can the
  // distance be this small, be it right or not.
  return result.distance < 0x1p-98 ? apart_at_any_scale(a, b) : result;
}

}  // namespace bvlab
