// SPDX-License-Identifier: BSD-3-Clause
/// The margin of a verdict on two closed triangles: how far they can be moved, in any way, before
/// the verdict whether they share a point can change. While every point of one moves by less than
/// the margin relative to every point of the other, the verdict holds. In float, for up to eight
/// pairs at once.
///
/// Apart: the margin is a lower bound on the distance. Every direction n proves a distance of
/// (least n.q - greatest n.p) / |n|; tried are the two normals and the vector between the nearest
/// points of the nearest two edges, which is the best direction unless a normal is.
///
/// Touching: an edge pq of one crosses the other, T. It crosses T until one of its ends reaches T
/// or pq reaches T's boundary: in between the map (x, y) -> x - y of pq times T is not zero on the
/// boundary of its domain, so its degree, 1 or -1, is constant and there is a zero inside. The
/// margin is the least of the ends' distances from T's plane and of the distances of the line pq
/// from the lines of T's edges; the best of six such crossings is used. It is 0 where none is
/// certain: coplanar and grazing contacts have no margin.
///
/// Rounding, with u = 2^-24. The corners are taken relative to one of them and divided by the
/// power of two above the largest such coordinate, in double, then rounded to float: all of them
/// lie in [-1, 1], and each has moved by less than sqrt(3) u (1 + 2^-20) < 1.8u. A margin changes
/// by no more than what the two triangles are moved by, 3.6u. In a pair so scaled differences are
/// below 2 and
/// - a projection n.x of a difference |x| < 3.5 is off by u |n||x| for the difference and 3u |n||x|
///   for the sum of products, 14u |n|; the difference of two of them by 28u |n| and its own 7u |n|;
/// - a cross product of two differences is off by 32u in a component (24u for two products of at
///   most 4, each wrong by 3u of itself, and 8u for their difference of at most 8), so by less
///   than 56u in norm;
/// - its product with a third, |x| < 3.5, is off by 56u |x| + 3u |n||x| + u |n||x|
///   < 196u + 14u |n|,
///   where |n| <= 12: less than 364u.
/// `slack` = 512u covers the last, and 64u |n| for the first, each with room for 3.6u |n| of
/// the rounded corners and for the roots and quotients, which are off by a factor of 1 - 8u. What
/// divides has a square above 2^-40, so that it is a normal number and known to a few hundred u.
///
/// Range: the largest coordinate is a normal number from 2^-959 to 2^957 before it is scaled, and
/// all others are at most as large; what of them underflows, in double or in float, is below
/// 2^-149, and a margin is above 8u. Other pairs have no margin, and are decided exactly.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "traversal/primitives/triangle_intersection.hpp"
#include "traversal/transpose.hpp"

namespace bvlab {

namespace margin {

using filter::cross;
using filter::dot;
using filter::max;
using filter::min;
using filter::operator-;
template <class S>
using Vector = filter::Vector<S>;

constexpr float u = unit_roundoff<float>;
constexpr float slack = 512 * u;
constexpr float infinity = std::numeric_limits<float>::infinity();

template <class S>
[[gnu::always_inline]] inline S root(const S& x) {
  using std::sqrt;
  using stdx::sqrt;
  return sqrt(x);
}

/// A lower bound on the distance of the triangles, by their projections on direction n.
template <Scalar S>
[[gnu::always_inline]] inline S apart_along(const Vector<S>& n, const Corners<S>& a,
                                            const Corners<S>& b) {
  const S a1 = dot<S>(n, a[1] - a[0]), a2 = dot<S>(n, a[2] - a[0]);
  const S b0 = dot<S>(n, b[0] - a[0]), b1 = dot<S>(n, b[1] - a[0]), b2 = dot<S>(n, b[2] - a[0]);
  const S low_a = min(S(0), min(a1, a2)), high_a = max(S(0), max(a1, a2));
  const S low_b = min(b0, min(b1, b2)), high_b = max(b0, max(b1, b2));
  const S square = dot<S>(n, n);
  const S distance = max(low_b - high_a, low_a - high_b) / root(square);
  return select<S>(square > S(0x1p-40f), distance * S(1 - 8 * u) - S(64 * u), S(0));
}

template <Scalar S>
[[gnu::always_inline]] inline S clamped(const S& x) {
  return min(max(x, S(0)), S(1));
}

/// Approximates the vector between the nearest points of the nearest two edges.
template <Scalar S>
[[gnu::always_inline]] inline Vector<S> between_edges(const Corners<S>& a, const Corners<S>& b) {
  constexpr float least = 0x1p-60f;
  Vector<S> nearest{};
  S least_square = S(infinity);
  Vector<S> of_a[3], of_b[3];
  S square_a[3], square_b[3], inverse_a[3], inverse_b[3];
  for (int i = 0; i < 3; ++i) {
    of_a[i] = a[(i + 1) % 3] - a[i], of_b[i] = b[(i + 1) % 3] - b[i];
    square_a[i] = max(dot<S>(of_a[i], of_a[i]), S(least));
    square_b[i] = max(dot<S>(of_b[i], of_b[i]), S(least));
    inverse_a[i] = S(1) / square_a[i], inverse_b[i] = S(1) / square_b[i];
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Vector<S> r = a[i] - b[j];
      const S along_a = dot<S>(of_a[i], r), along_b = dot<S>(of_b[j], r);
      const S both = dot<S>(of_a[i], of_b[j]);
      const S sine = max(square_a[i] * square_b[j] - both * both, S(least));
      const S s0 = clamped<S>((both * along_b - along_a * square_b[j]) / sine);
      const S t = clamped<S>((both * s0 + along_b) * inverse_b[j]);
      const S s = clamped<S>((both * t - along_a) * inverse_a[i]);
      Vector<S> d;
      for (int k = 0; k < 3; ++k) d[k] = r[k] + s * of_a[i][k] - t * of_b[j][k];
      const S square = dot<S>(d, d);
      const Mask<S> nearer = square < least_square;
      least_square = select<S>(nearer, square, least_square);
      nearest = filter::choose<S>(nearer, d, nearest);
    }
  return nearest;
}

/// The margin of disjoint triangles; not positive if they are not certainly disjoint.
template <Scalar S>
[[gnu::always_inline]] inline S apart(const Corners<S>& a, const Corners<S>& b) {
  const S edges = apart_along<S>(between_edges<S>(a, b), a, b);
  const S face_a = apart_along<S>(cross<S>(a[1] - a[0], a[2] - a[0]), a, b);
  const S face_b = apart_along<S>(cross<S>(b[1] - b[0], b[2] - b[0]), a, b);
  return max(edges, max(face_a, face_b));
}

/// A lower bound on 1 / |n|; 0 where |n| is too small.
template <Scalar S>
[[gnu::always_inline]] inline S over_norm(const Vector<S>& n) {
  const S square = dot<S>(n, n);
  return select<S>(square > S(0x1p-40f), S(1 - 8 * u) / (root(square) + S(64 * u)), S(0));
}

/// The best margin of the edges of `edges` as crossings of `t`; not positive where no edge
/// certainly crosses it.
template <Scalar S>
[[gnu::always_inline]] inline S crossed(const Corners<S>& t, const Corners<S>& edges) {
  const Vector<S> normal = cross<S>(t[1] - t[0], t[2] - t[0]);
  const S scale = over_norm<S>(normal);
  S height[3];
  for (int i = 0; i < 3; ++i) height[i] = dot<S>(normal, edges[i] - t[0]);
  S best = S(0);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const Vector<S> along = edges[j] - edges[i];
    S least = (min(max(height[i], height[j]), -min(height[i], height[j])) - S(slack)) * scale;
    S left = S(infinity), right = S(infinity);
    for (int k = 0; k < 3; ++k) {
      const Vector<S> axis = cross<S>(along, t[(k + 1) % 3] - t[k]);
      const S side = dot<S>(axis, t[k] - edges[i]), inverse = over_norm<S>(axis);
      left = min(left, (side - S(slack)) * inverse);
      right = min(right, (-side - S(slack)) * inverse);
    }
    // If the line crosses t, it passes all three edges of t on the same side.
    least = min(least, max(left, right));
    best = max(best, least);
  }
  return best - S(8 * u);
}

/// The margin of triangles, one of which has an edge that certainly crosses the other; else not
/// positive.
template <Scalar S>
[[gnu::always_inline]] inline S crossing(const Corners<S>& a, const Corners<S>& b) {
  return max(crossed<S>(a, b), crossed<S>(b, a));
}

using Four [[gnu::vector_size(32)]] = double;
using FourWords [[gnu::vector_size(32)]] = std::int64_t;
using FourFloats [[gnu::vector_size(16)]] = float;

/// The i-th corner as x, y, z and an arbitrary fourth number.
[[gnu::always_inline]] inline Four corner(const Triangle& t, int i) {
  // The last corner is read from one number before it, to stay inside the triangle.
  const double* const first = t[0].data() + 3 * i - (i == 2);
  Four four;
  std::memcpy(&four, first, sizeof four);
  return i == 2 ? __builtin_shufflevector(four, four, 1, 2, 3, 3) : four;
}

/// The corners of W pairs, one a lane, relative to the first one and divided by a power of two.
template <int W>
struct Scaled {
  using S = Batch<float, W>;
  Corners<S> a, b;
  double scale[W];

  Scaled(const Triangle* const* as, const Triangle* const* bs, int used) {
    alignas(64) float rows[W][24] = {}, columns[24][W];
    for (int lane = 0; lane < used; ++lane) scale[lane] = scaled(*as[lane], *bs[lane], rows[lane]);
    for (int field = 0; field < 24; field += 4) {
      const auto four = bvlab::detail::columns_of<float, W>([&](int i) { return rows[i] + field; });
      std::memcpy(columns[field], &four, sizeof four);
    }
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        a[i][j].copy_from(columns[4 * i + j], stdx::vector_aligned);
        b[i][j].copy_from(columns[12 + 4 * i + j], stdx::vector_aligned);
      }
  }

  /// Writes four numbers for each corner to `row`. Returns the divisor, or 0 where numbers are too
  /// large or too small.
  [[gnu::always_inline]] static double scaled(const Triangle& p, const Triangle& q, float* row) {
    const Four origin = corner(p, 0);
    Four x[6];
    for (int i = 0; i < 3; ++i) x[i] = corner(p, i) - origin, x[3 + i] = corner(q, i) - origin;
    // Compared as integers, which gives the same order without the sign.
    constexpr std::int64_t all = std::numeric_limits<std::int64_t>::max();
    FourWords most{};
    for (const Four& corner : x) {
      const FourWords words = std::bit_cast<FourWords>(corner) & FourWords{all, all, all, 0};
      most = words > most ? words : most;
    }
    const std::int64_t exponent = std::max(std::max(most[0], most[1]), most[2]) >> 52;
    if (exponent < 64 || exponent > 1980) return 0;
    const auto inverse = std::bit_cast<double>((2045 - exponent) << 52);
    for (int i = 0; i < 6; ++i) {
      const FourFloats rounded = __builtin_convertvector(x[i] * inverse, FourFloats);
      std::memcpy(row + 4 * i, &rounded, sizeof rounded);
    }
    return std::bit_cast<double>((exponent + 1) << 52);
  }
};

}  // namespace margin

/// A triangle test: bit i is set if the pair (*a[i], *b[i]) shares a point, i < count <= 64.
using TriangleTest = std::uint64_t (*)(const Triangle* const* a, const Triangle* const* b,
                                       int count);

/// The same, with the pairs' margins. A margin decides most pairs; the rest go to `test`.
// Flattened, because GCC does not inline everything into a function of this length. A template, so
// that a program can compile it once (extern template).
template <class = double>
[[gnu::flatten]] std::uint64_t touching_with_margins(const Triangle* const* a,
                                                     const Triangle* const* b, int count,
                                                     TriangleTest test, double* margins) {
  constexpr int width = std::clamp(native_width<float>, 4, 8);
  using S = Batch<float, width>;
  std::uint64_t touching = 0;
  for (int first = 0; first < count; first += width) {
    const int used = std::min(width, count - first);
    const margin::Scaled<width> pairs(a + first, b + first, used);
    const std::uint64_t all = (std::uint64_t{1} << used) - 1;
    // NaN counts as no margin.
    const S apart = margin::apart<S>(pairs.a, pairs.b);
    std::uint64_t open = ~bits(apart > S(0)) & all;
    S margin = apart;
    if (open) {
      const S crossing = margin::crossing<S>(pairs.a, pairs.b);
      const std::uint64_t crossed = bits(crossing > S(0)) & open;
      stdx::where(!(apart > S(0)), margin) = crossing;
      open &= ~crossed;
      touching |= crossed << first;
    }
    for (int lane = 0; lane < used; ++lane)
      margins[first + lane] = margin[lane] * pairs.scale[lane];
    for (; open; open &= open - 1) {
      const int i = first + std::countr_zero(open);
      touching |= test(a + i, b + i, 1) << i;
      margins[i] = 0;
    }
  }
  return touching;
}

/// Writes the margins of those pairs (*a[i], *b[i]), i < count, in which an edge of one certainly
/// crosses the other; for all others, a number that is not positive.
template <class = double>
[[gnu::flatten]] void crossing_margins(const Triangle* const* a, const Triangle* const* b,
                                       int count, double* margins) {
  constexpr int width = std::clamp(native_width<float>, 4, 8);
  using S = Batch<float, width>;
  for (int first = 0; first < count; first += width) {
    const int used = std::min(width, count - first);
    const margin::Scaled<width> pairs(a + first, b + first, used);
    const S margin = margin::crossing<S>(pairs.a, pairs.b);
    for (int lane = 0; lane < used; ++lane)
      margins[first + lane] = margin[lane] * pairs.scale[lane];
  }
}

}  // namespace bvlab
