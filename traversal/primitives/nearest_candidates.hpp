// SPDX-License-Identifier: BSD-3-Clause
/// The 33 pairs of features at which two disjoint triangles can be nearest: 18 of a corner and an
/// edge, 9 of two edges, 6 of a corner and a face. Each is computed in T, float64 or double-double,
/// with a bound on its rounding error and whether float64 is reliable for it. The error bounds are
/// derived in triangle_distance.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "hierarchies/geometry/double_double.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

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

/// Whether float64 can tell whether a candidate exists, and where it lies. `parallel`: two edges,
/// or a face's own, at an angle below 2^-48. Then an end or another edge is as near up to second
/// order, (2^-48 L)^2 / 2d, which matters only where d is much smaller than L. `open`: an angle
/// below 2^-20, or points so near the limits of the candidate that rounding may have put them
/// outside, and that would matter.
enum class Doubt { none, parallel, open };

/// One candidate: the squared distance and the parameters of the two nearest points. The distance
/// is infinite where the candidate does not exist.
template <class T>
struct Candidate {
  T squared = T(std::numeric_limits<double>::infinity());
  T s = T(0), t = T(0);
  double rounding = 0;  ///< |w| + 2 |s e| + 2 |t f|, in the 1-norm
  Doubt doubt = Doubt::none;
};

template <class T>
double magnitude(const Vector<T>& v) {
  return std::abs(static_cast<double>(v[0])) + std::abs(static_cast<double>(v[1])) +
         std::abs(static_cast<double>(v[2]));
}

/// The candidate with the vector w - s e - t f.
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

/// The candidate with the vector w between two corners.
template <class T>
Candidate<T> corners_apart(const Vector<T>& w) {
  Candidate<T> candidate;
  candidate.squared = dot(w, w);
  candidate.rounding = magnitude(w);
  return candidate;
}

/// Corner p and edge a b: the point on the edge is a + s (b - a).
///
/// s |e| is off by up to 12 u |w|, so a point computed to be at an end may be inside by as much.
/// At a that is negligible relative to |r| = |w|. At b, where |w| <= |e| + |r|, it makes |r| too
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

/// The nearest points of two lines, or of a point and a plane: w - s e - t f is orthogonal to e and
/// f. Computed by cross products, which lose half as many digits as Gram's determinant where e and
/// f are nearly parallel. `inside(s, t)` is how far s and t are inside (negative: outside).
template <class T, class Inside>
Candidate<T> orthogonal(const Vector<T>& w, const Vector<T>& e, const Vector<T>& f,
                        const Inside& inside) {
  const Vector<T> n = cross(e, f);
  const T square = dot(n, n);
  const double sine_squared = static_cast<double>(square) /
                              (static_cast<double>(dot(e, e)) * static_cast<double>(dot(f, f)));
  Candidate<T> candidate;
  // Written so that 0 / 0 counts as parallel.
  const Doubt narrow = !(sine_squared >= 0x1p-96) ? Doubt::parallel
                       : sine_squared < 0x1p-40   ? Doubt::open
                                                  : Doubt::none;
  candidate.doubt = narrow;
  if (!(square > T(0))) return candidate;
  // An error of n would stay in s e + t f; with t computed from s, only the error of s stays, and
  // of that the part orthogonal to f.
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

/// Inner points of edges a b and c d: a + s (b - a) and c + t (d - c).
template <class T>
Candidate<T> edge_edge(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c,
                       const Vec3<double>& d) {
  return orthogonal<T>(difference<T>(c, a), difference<T>(b, a), difference<T>(c, d),
                       [](const T& s, const T& t) {
                         return std::min(std::min(s, t), std::min(T(1) - s, T(1) - t));
                       });
}

/// Corner p and the inner point a + s (b - a) + t (c - a) of a face.
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

/// The points of the k-th candidate, from its parameters; computed in T, then rounded.
template <class T>
std::array<Vec3<double>, 2> points_of(const Triangle& a, const Triangle& b, int k, const T& s,
                                      const T& t) {
  const auto next = [](int i) { return i == 2 ? 0 : i + 1; };
  const auto along = [&](const Triangle& triangle, int j, const T& r) -> Vec3<double> {
    const auto &p = triangle[j], &q = triangle[next(j)];
    if (!(r < T(1))) return q;
    const Vector<T> e = difference<T>(q, p);
    return {static_cast<double>(T(p[0]) + r * e[0]), static_cast<double>(T(p[1]) + r * e[1]),
            static_cast<double>(T(p[2]) + r * e[2])};
  };
  const auto inside = [&](const Triangle& q) -> Vec3<double> {
    const Vector<T> e = difference<T>(q[1], q[0]), f = difference<T>(q[2], q[0]);
    Vec3<double> point;
    for (int i = 0; i < 3; ++i) point[i] = static_cast<double>(T(q[0][i]) + (s * e[i] + t * f[i]));
    return point;
  };
  if (k < 9) return {a[k / 3], along(b, k % 3, s)};
  if (k < corner_edges) return {along(a, k % 3, s), b[k % 9 / 3]};
  k -= corner_edges;
  if (k < edge_edges) return {along(a, k / 3, s), along(b, k % 3, t)};
  k -= edge_edges;
  if (k < 3) return {a[k], inside(b)};
  return {inside(a), b[k - 3]};
}

}  // namespace nearest

}  // namespace bvlab
