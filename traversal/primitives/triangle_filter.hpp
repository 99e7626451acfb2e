// SPDX-License-Identifier: BSD-3-Clause
/// A filter: decides in rounded arithmetic whether two closed triangles touch, except where the
/// error bound leaves it open. Written once for any scalar or batch S.
///
/// All predicates are signs of determinants of three differences between corners of the pair, so
/// one error bound, computed once per pair from the box of all six corners, serves them all.
///
/// The bound. Let W_x, W_y, W_z be the sides of that box, u the unit roundoff, and D_x the largest
/// error of a computed difference of x coordinates: u W_x for its own rounding, and 2 u M_x more
/// where the corners themselves were rounded to S first (M_x their largest |x|). A determinant is
/// the sum of six products of a difference along each axis. Errors of differences change it by at
/// most 6 (D_x W_y W_z + W_x D_y W_z + W_x W_y D_z) to first order. On its way to the result each
/// product is rounded at most five times (twice multiplied, thrice added): 6 * 5 u W_x W_y W_z.
/// Without rounded corners that is 48 u W_x W_y W_z. The factors of 49 / 48, and of 1 + 64 u, below
/// cover the terms of higher order, the roundings of W and of the bound itself. Underflow: a
/// product is off by at most half the least positive number, h; those of the six products in the
/// minors are then multiplied by at most W, and the products in the bound itself err likewise. All
/// together are below 32 h max(W, 1). Overflow: nothing is certain unless every W is below a reach
/// R with 6 R^3 still finite. A corner beyond S is infinite when it has been rounded: then the
/// bound is infinite or NaN, and only boxes decide, since rounding keeps order.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "hierarchies/geometry/scalar.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// The corners of a triangle in each of W lanes: corners[i] is the i-th corner's x, y, z.
template <Scalar S>
using Corners = std::array<std::array<S, 3>, 3>;

/// Whether the corners are exact in S, or were rounded to S.
enum class CornersAre { given, rounded };

namespace filter {

using std::abs;
using stdx::abs;

// Always inlined, since whole registers are passed between these small functions.

// By value, so that this compiles to one instruction and no branch.
template <Scalar S>
[[gnu::always_inline]] inline S min(S x, S y) {
  if constexpr (Batched<S>)
    return stdx::min(x, y);
  else
    return x < y ? x : y;
}
template <Scalar S>
[[gnu::always_inline]] inline S max(S x, S y) {
  if constexpr (Batched<S>)
    return stdx::max(x, y);
  else
    return x > y ? x : y;
}

template <Scalar S>
[[gnu::always_inline]] inline bool everywhere(const Mask<S>& mask) {
  if constexpr (!Batched<S>)
    return mask;
  else
    return stdx::all_of(mask);
}

template <Scalar S>
using Vector = std::array<S, 3>;

template <Scalar S>
[[gnu::always_inline]] inline Vector<S> operator-(const Vector<S>& a, const Vector<S>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

template <Scalar S>
[[gnu::always_inline]] inline Vector<S> cross(const Vector<S>& u, const Vector<S>& v) {
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

template <Scalar S>
[[gnu::always_inline]] inline S dot(const Vector<S>& u, const Vector<S>& v) {
  return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

template <Scalar S>
[[gnu::always_inline]] inline Mask<S> share_a_corner(const Corners<S>& a, const Corners<S>& b) {
  Mask<S> shared(false);
  for (const auto& p : a)
    for (const auto& q : b) shared = shared || ((p[0] == q[0]) && (p[1] == q[1]) && (p[2] == q[2]));
  return shared;
}

template <Scalar S>
[[gnu::always_inline]] inline Vector<S> choose(const Mask<S>& condition, const Vector<S>& yes,
                                               const Vector<S>& no) {
  return {select<S>(condition, yes[0], no[0]), select<S>(condition, yes[1], no[1]),
          select<S>(condition, yes[2], no[2])};
}

/// The error of a determinant of differences up to `side` that are each off by up to `wrong`.
template <Scalar S>
[[gnu::always_inline]] inline S error_of_rounded(const S (&side)[3], const S (&wrong)[3]) {
  constexpr Element<S> u = unit_roundoff<S>;
  return (1 + 64 * u) * (6 * (wrong[0] * side[1] * side[2] + side[0] * wrong[1] * side[2] +
                              side[0] * side[1] * wrong[2]) +
                         (30 * u) * ((side[0] * side[1]) * side[2]));
}

/// An error bound, with what underflow adds to `error`; infinite where products may overflow.
template <Scalar S>
[[gnu::always_inline]] inline S with_underflow(const S (&side)[3], const S& error,
                                               Element<S> tiny) {
  using T = Element<S>;
  constexpr T reach = sizeof(T) == 8 ? T(0x1p340) : T(0x1p41);
  const S longest = max(max(side[0], side[1]), max(side[2], S(1)));
  return select<S>(longest < S(reach), error + tiny * longest,
                   S(std::numeric_limits<T>::infinity()));
}

/// Whether the boxes are apart (a comparison of corners, hence exact, and valid for the given
/// corners if it holds for rounded ones), and the error bound of a determinant.
template <Scalar S, CornersAre corners>
struct BoxAndBound {
  Mask<S> apart;
  S bound;

  [[gnu::always_inline]] BoxAndBound(const Corners<S>& a, const Corners<S>& b) {
    using T = Element<S>;
    constexpr T u = unit_roundoff<S>;
    constexpr T least = std::numeric_limits<T>::denorm_min();
    S side[3], wrong[3];
    for (int i = 0; i < 3; ++i) {
      const S low_a = min(min(a[0][i], a[1][i]), a[2][i]),
              high_a = max(max(a[0][i], a[1][i]), a[2][i]);
      const S low_b = min(min(b[0][i], b[1][i]), b[2][i]),
              high_b = max(max(b[0][i], b[1][i]), b[2][i]);
      const Mask<S> gap = (high_a < low_b) | (high_b < low_a);
      apart = i == 0 ? gap : apart | gap;
      const S low = min(low_a, low_b), high = max(high_a, high_b);
      side[i] = high - low;
      if constexpr (corners == CornersAre::rounded) {
        wrong[i] = T(2) * (u * max(abs(low), abs(high)) + least) + u * side[i];
        side[i] = side[i] + wrong[i];
      }
    }
    if constexpr (corners == CornersAre::given)
      bound = with_underflow<S>(side, (49 * u) * ((side[0] * side[1]) * side[2]), 16 * least);
    else
      bound = with_underflow<S>(side, error_of_rounded<S>(side, wrong), 16 * least);
  }
};

/// The three determinants whose signs tell on which side of the plane of `t` the points lie.
template <Scalar S>
[[gnu::always_inline]] inline Vector<S> sides_of(const Corners<S>& t, const Corners<S>& points) {
  const Vector<S> normal = cross<S>(t[1] - t[0], t[2] - t[0]);
  return {dot<S>(normal, points[0] - t[0]), dot<S>(normal, points[1] - t[0]),
          dot<S>(normal, points[2] - t[0])};
}

template <Scalar S>
[[gnu::always_inline]] inline Mask<S> all_beyond(const Vector<S>& sides, const S& bound) {
  return (min(min(sides[0], sides[1]), sides[2]) > bound) ||
         (max(max(sides[0], sides[1]), sides[2]) < -bound);
}

template <Scalar S>
[[gnu::always_inline]] inline Mask<S> all_known(const Vector<S>& sides, const S& bound) {
  return min(min(abs(sides[0]), abs(sides[1])), abs(sides[2])) > bound;
}

/// The corners rotated so that the first one is alone on its side of the other's plane; `above`:
/// whether that side is the positive one. All sides must be known, and not all equal.
template <Scalar S>
struct Rotated {
  Vector<S> apex, next, last;
  Mask<S> above;

  [[gnu::always_inline]] Rotated(const Corners<S>& t, const Vector<S>& sides) {
    const Mask<S> p0 = sides[0] > 0, p1 = sides[1] > 0, p2 = sides[2] > 0;
    const Mask<S> last_alone = !(p0 ^ p1), next_alone = !(p0 ^ p2);
    apex = choose<S>(last_alone, t[2], choose<S>(next_alone, t[1], t[0]));
    next = choose<S>(last_alone, t[0], choose<S>(next_alone, t[2], t[1]));
    last = choose<S>(last_alone, t[1], choose<S>(next_alone, t[0], t[2]));
    const Mask<S> first_alone = !(last_alone | next_alone);
    above = (last_alone & p2) | (next_alone & p1) | (first_alone & p0);
  }
};

}  // namespace filter

template <Scalar S>
struct Certainly {
  Mask<S> apart, meeting;
};

namespace filter {

/// Decides by the signs of determinants, given whether the boxes are apart and the error bound.
template <Scalar S>
[[gnu::always_inline]] inline Certainly<S> decided_by_signs(const Corners<S>& a,
                                                            const Corners<S>& b,
                                                            const Mask<S>& boxes_apart,
                                                            const S& bound) {
  Certainly<S> verdict{boxes_apart, Mask<S>(false)};
  if (everywhere<S>(verdict.apart)) return verdict;
  const Vector<S> sides_b = sides_of<S>(a, b);
  verdict.apart = verdict.apart | all_beyond<S>(sides_b, bound);
  if (everywhere<S>(verdict.apart)) return verdict;
  const Vector<S> sides_a = sides_of<S>(b, a);
  verdict.apart = verdict.apart | all_beyond<S>(sides_a, bound);
  const Mask<S> known = all_known<S>(sides_a, bound) & all_known<S>(sides_b, bound);
  if (everywhere<S>(verdict.apart | !known)) return verdict;
  // The planes cross in a line from which each triangle cuts an interval. With each apex above the
  // other's plane, they overlap unless one of two determinants is positive [guigue2003fast].
  Rotated<S> p(a, sides_a), s(b, sides_b);
  const Vector<S> q = choose<S>(s.above, p.next, p.last), r = choose<S>(s.above, p.last, p.next);
  const Vector<S> t = choose<S>(p.above, s.next, s.last), w = choose<S>(p.above, s.last, s.next);
  const S first = dot<S>(cross<S>(t - q, s.apex - q), p.apex - q);
  const S second = dot<S>(cross<S>(s.apex - p.apex, r - p.apex), w - p.apex);
  verdict.apart = verdict.apart | (known & (max(first, second) > bound));
  verdict.meeting = known & !verdict.apart & (max(first, second) < -bound);
  return verdict;
}

}  // namespace filter

/// Decides pairs in rounded arithmetic. Neither mask is set where the error bound leaves the answer
/// open.
template <Scalar S, CornersAre corners = CornersAre::given>
[[gnu::always_inline]] inline Certainly<S> certainly(const Corners<S>& a, const Corners<S>& b) {
  const filter::BoxAndBound<S, corners> box(a, b);
  return filter::decided_by_signs<S>(a, b, box.apart, box.bound);
}

/// The same for triangles whose corners are within `off` of those given, in each coordinate. A
/// difference of coordinates is off by 2 off and by its rounding; the error bound follows as above.
template <Scalar S>
[[gnu::always_inline]] inline Certainly<S> certainly_within(const Corners<S>& a,
                                                            const Corners<S>& b, const S& off) {
  using namespace filter;
  using T = Element<S>;
  constexpr T u = unit_roundoff<S>;
  // Covers underflow, and is fast: products of subnormal numbers take microcode.
  constexpr T tiny = std::numeric_limits<T>::min();
  S side[3], wrong[3];
  Mask<S> apart(false);
  const S twice = (off + off) * T(1 + 4 * u);
  for (int i = 0; i < 3; ++i) {
    const S low_a = min(min(a[0][i], a[1][i]), a[2][i]),
            high_a = max(max(a[0][i], a[1][i]), a[2][i]);
    const S low_b = min(min(b[0][i], b[1][i]), b[2][i]),
            high_b = max(max(b[0][i], b[1][i]), b[2][i]);
    // Differences round, but not across `twice`, which is a number of S.
    apart = apart | (low_b - high_a > twice) | (low_a - high_b > twice);
    side[i] = max(high_a, high_b) - min(low_a, low_b);
  }
  if (everywhere<S>(apart)) return {apart, Mask<S>(false)};
  for (int i = 0; i < 3; ++i) {
    wrong[i] = twice + u * side[i] + tiny;
    side[i] = side[i] + wrong[i];
  }
  return decided_by_signs<S>(a, b, apart,
                             with_underflow<S>(side, error_of_rounded<S>(side, wrong), tiny));
}

}  // namespace bvlab
