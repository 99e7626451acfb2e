// SPDX-License-Identifier: BSD-3-Clause
/// The second stage of the triangle test: decides with double the digits pairs that the float64
/// filter left open, W at a time, at about a third of the cost of exact integers.
///
/// Differences are kept with their rounding errors, so they are exact; products and sums with
/// theirs, in float64. Let side_i be the sides of the box around both triangles, u the unit
/// roundoff, and A_k = side_i side_j for (i, j, k) = (k + 1, k + 2, k) mod 3. To second order (high
/// parts below side_i, low ones below u side_i):
/// - a minor u_i v_j - u_j v_i, kept as high + low with |high| <= 2 A, |low| <= 8 u A, is off by at
///   most 28 u^2 A: 2 for the products of two low parts left out, 4 + 4 + 4 for the four mixed
///   products, their two sums and the difference, 2 + 4 + 8 for what the exact products and the
///   exact sum lost, and for all together. `minor_error` = 32 leaves room for the third order.
/// - a determinant, three minors times a difference, with V = side_x side_y side_z: 3 * 28 from the
///   minors, 3 * 8 for products of low parts left out, 3 (2 + 8 + 10 + 12) for the mixed products
///   and their sums, 24 + 36 + 10 + 46 for adding up what was lost: 320 u^2 V.
///   `determinant_error` = 384 leaves room for the third order and for V's own rounding.
/// Underflow: an exact product without a fused multiply-add is off by at most 5 h, h half the least
/// positive number, a mixed one by h; 6 exact and 12 mixed products are multiplied by a difference,
/// 3 and 6 are not: less than 128 h max(side, 1). Overflow: as in the first stage.
///
/// Zeros. Where all differences to one corner are exact in float64 and survive being added to
/// C_i = 2^23 side_i and freed of it again, they are multiples of a power of two above 2^-53 times
/// the least such sum, which is at least (1 - 2^-23) C_i. A determinant is then a multiple of a
/// number above V 2^-90 (1 - 2^-21), a minor of one above A 2^-60 (1 - 2^-21): what is smaller is
/// 0. So coordinates on a grid of up to 2^29 steps a side need no integers.
#pragma once

#include <array>
#include <limits>

#include "traversal/primitives/paired_arithmetic.hpp"

namespace bvlab {

namespace filter {

/// The error bounds and the grid test, for all determinants of one pair.
template <Scalar S>
struct RefinedBounds {
  static constexpr double u2 = 0x1p-106, minor_error = 32, determinant_error = 384;
  static constexpr double least = std::numeric_limits<double>::denorm_min();
  S side[3], determinant, plane[3];  ///< the box, and the error bounds of a determinant and a minor
  Mask<S> flat;                      ///< the box is flat: all determinants are 0
  Mask<S> on_grid;                   ///< a determinant within its error bound is 0
  Mask<S> on_grid_2;                 ///< a minor within its error bound is 0

  [[gnu::always_inline]] RefinedBounds(const Corners<S>& a, const Corners<S>& b,
                                       const std::array<PairVector<S>, 5>& differences) {
    for (int i = 0; i < 3; ++i)
      side[i] = max(max(max(a[0][i], a[1][i]), a[2][i]), max(max(b[0][i], b[1][i]), b[2][i])) -
                min(min(min(a[0][i], a[1][i]), a[2][i]), min(min(b[0][i], b[1][i]), b[2][i]));
    const S volume = (side[0] * side[1]) * side[2];
    const S longest = max(max(side[0], side[1]), max(side[2], S(1)));
    const Mask<S> in_reach = longest < S(0x1p340);
    const S infinite(std::numeric_limits<double>::infinity());
    flat = min(min(side[0], side[1]), side[2]) == S(0);
    determinant =
        select<S>(in_reach, (determinant_error * u2) * volume + (64 * least) * longest, infinite);
    on_grid = 2 * determinant < 0x1p-91 * volume;
    on_grid_2 = in_reach;
    for (int k = 0; k < 3; ++k) {
      const S area = side[(k + 1) % 3] * side[(k + 2) % 3];
      plane[k] = select<S>(in_reach, (minor_error * u2) * area + S(64 * least), infinite);
      on_grid_2 = on_grid_2 && ((2 * plane[k] < 0x1p-61 * area) || (area == S(0)));
    }
    for (int k = 0; k < 3; ++k) {
      const S c = 0x1p23 * side[k];
      Mask<S> multiple(true);
      for (const auto& d : differences)
        multiple = multiple && (d[k].low == S(0)) && ((d[k].high + c) - c == d[k].high);
      on_grid = on_grid && multiple;
      on_grid_2 = on_grid_2 && multiple;
    }
  }
};

/// Signs -1, 0 or 1, valid where `known` is set.
template <Scalar S>
struct Signs {
  S sign;
  Mask<S> known;
};

template <Scalar S>
[[gnu::always_inline]] inline Signs<S> sign_of(const S& determinant,
                                               const RefinedBounds<S>& bounds) {
  const Mask<S> above = determinant > bounds.determinant, below = determinant < -bounds.determinant;
  // A flat box has volume 0, but an error bound above it for underflow.
  const Mask<S> zero = bounds.flat || (bounds.on_grid && !(above || below));
  return {select<S>(zero, S(0), select<S>(above, S(1), select<S>(below, S(-1), S(0)))),
          above || below || zero};
}

/// The sides of a plane, given by its normal, on which three points lie, given relative to a corner
/// in the plane.
template <Scalar S>
struct RefinedSides {
  Vector<S> sign;
  Mask<S> all_known, beyond, in_plane;

  [[gnu::always_inline]] RefinedSides(const PairVector<S>& normal, const PairVector<S>& p,
                                      const PairVector<S>& q, const PairVector<S>& r,
                                      const RefinedBounds<S>& bounds) {
    const Signs<S> s = sign_of<S>(dot<S>(normal, p), bounds);
    const Signs<S> t = sign_of<S>(dot<S>(normal, q), bounds);
    const Signs<S> w = sign_of<S>(dot<S>(normal, r), bounds);
    sign = {s.sign, t.sign, w.sign};
    all_known = s.known && t.known && w.known;
    beyond = abs(s.sign + t.sign + w.sign) == S(3);
    in_plane = all_known && (abs(s.sign) + abs(t.sign) + abs(w.sign) == S(0));
  }
};

/// The corners rotated so that the first is alone on its side, or beyond the others, or the only
/// one off the plane: as filter::Rotated, for sides that may be 0, but not all.
template <Scalar S>
struct RefinedTurned {
  Vector<S> apex, next, last;
  Mask<S> above;

  [[gnu::always_inline]] RefinedTurned(const Corners<S>& t, const Vector<S>& side) {
    const S zero(0);
    const auto alone = [&](const S& s, const S& x, const S& y) {
      return ((s != zero) && (s * x <= zero) && (s * y <= zero)) || ((s == zero) && (x * y > zero));
    };
    const auto effective = [&](const S& s, const S& x) { return select<S>(s == zero, -x, s); };
    const Mask<S> first = alone(side[0], side[1], side[2]);
    const Mask<S> second = !first && alone(side[1], side[2], side[0]);
    apex = choose<S>(first, t[0], choose<S>(second, t[1], t[2]));
    next = choose<S>(first, t[1], choose<S>(second, t[2], t[0]));
    last = choose<S>(first, t[2], choose<S>(second, t[0], t[1]));
    above = select<S>(first, effective(side[0], side[1]),
                      select<S>(second, effective(side[1], side[2]), effective(side[2], side[0]))) >
            zero;
  }
};

/// Decides coplanar triangles with area in the projection along the axis in which a's normal is
/// longest: they are apart exactly where an edge of one separates them strictly.
template <Scalar S>
[[gnu::always_inline]] inline Certainly<S> coplanar(const Corners<S>& a, const Corners<S>& b,
                                                    const PairVector<S>& normal_a,
                                                    const PairVector<S>& normal_b,
                                                    const RefinedBounds<S>& bounds) {
  const S x = abs(normal_a[0].high), y = abs(normal_a[1].high), z = abs(normal_a[2].high);
  const Mask<S> along_x = (x >= y) && (x >= z), along_y = !along_x && (y >= z);
  const auto by_axis = [&](const S& if_x, const S& if_y, const S& if_z) {
    return select<S>(along_x, if_x, select<S>(along_y, if_y, if_z));
  };
  const auto turn_of = [&](const PairVector<S>& n) {
    return by_axis(n[0].high + n[0].low, n[1].high + n[1].low, n[2].high + n[2].low);
  };
  const S bound = by_axis(bounds.plane[0], bounds.plane[1], bounds.plane[2]);
  const S turn_a = turn_of(normal_a), turn_b = turn_of(normal_b);
  const Mask<S> have_area = (abs(turn_a) > bound) && (abs(turn_b) > bound);
  S p[3][2], q[3][2];
  for (int i = 0; i < 3; ++i) {
    p[i][0] = by_axis(a[i][1], a[i][2], a[i][0]), p[i][1] = by_axis(a[i][2], a[i][0], a[i][1]);
    q[i][0] = by_axis(b[i][1], b[i][2], b[i][0]), q[i][1] = by_axis(b[i][2], b[i][0], b[i][1]);
  }
  Pair<S> across[3][3][2];  // from p to q
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int c = 0; c < 2; ++c) across[i][j][c] = exact_difference<S>(q[j][c], p[i][c]);
  // How far the other reaches to the inner side of the most separating edge.
  S inside(std::numeric_limits<double>::infinity());
  const S way_a = select<S>(turn_a > S(0), S(1), S(-1)),
          way_b = select<S>(turn_b > S(0), S(1), S(-1));
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3;
    const Pair<S> ex = exact_difference<S>(p[k][0], p[i][0]),
                  ey = exact_difference<S>(p[k][1], p[i][1]);
    const Pair<S> fx = exact_difference<S>(q[k][0], q[i][0]),
                  fy = exact_difference<S>(q[k][1], q[i][1]);
    S most_a(-std::numeric_limits<double>::infinity()), most_b = most_a;
    for (int j = 0; j < 3; ++j) {
      const auto& to_b = across[i][j];
      const auto& from_a = across[j][i];
      const Pair<S> s = minor<S>(ex, ey, to_b[0], to_b[1]);
      const Pair<S> t = minor<S>(fx, fy, from_a[0], from_a[1]);
      most_a = max(most_a, way_a * (s.high + s.low));
      most_b = max(most_b, -way_b * (t.high + t.low));
    }
    inside = min(inside, min(most_a, most_b));
  }
  return {have_area && (inside < -bound),
          have_area && ((inside > bound) || (bounds.on_grid_2 && (inside >= -bound)))};
}

template <Scalar S>
[[gnu::always_inline]] inline bool anywhere(const Mask<S>& mask) {
  if constexpr (!Batched<S>)
    return mask;
  else
    return stdx::any_of(mask);
}

}  // namespace filter

/// As `certainly`, for corners that are exact in float64, of triangles whose boxes overlap.
template <Scalar S>
Certainly<S> certainly_refined(const Corners<S>& a, const Corners<S>& b) {
  using namespace filter;
  Certainly<S> verdict{Mask<S>(false), share_a_corner<S>(a, b)};
  if (everywhere<S>(verdict.meeting)) return verdict;
  // From a's first corner, then from b's.
  const std::array<PairVector<S>, 5> from_a = {
      exact_difference<S>(a[1], a[0]), exact_difference<S>(a[2], a[0]),
      exact_difference<S>(b[0], a[0]), exact_difference<S>(b[1], a[0]),
      exact_difference<S>(b[2], a[0])};
  const RefinedBounds<S> bounds(a, b, from_a);
  const PairVector<S> normal_a = cross<S>(from_a[0], from_a[1]);
  const PairVector<S> normal_b =
      cross<S>(exact_difference<S>(b[1], b[0]), exact_difference<S>(b[2], b[0]));
  const auto add = [&](const Mask<S>& where, const Certainly<S>& more) {
    verdict.apart = verdict.apart || (where && more.apart);
    verdict.meeting = verdict.meeting || (where && more.meeting);
  };
  if (everywhere<S>(bounds.flat || verdict.meeting)) {
    add(!verdict.meeting, coplanar<S>(a, b, normal_a, normal_b, bounds));
    return verdict;
  }
  const RefinedSides<S> sides_b(normal_a, from_a[2], from_a[3], from_a[4], bounds);
  verdict.apart = sides_b.beyond && !verdict.meeting;
  if (everywhere<S>(verdict.apart || verdict.meeting)) return verdict;
  const RefinedSides<S> sides_a(normal_b, -from_a[2], exact_difference<S>(a[1], b[0]),
                                exact_difference<S>(a[2], b[0]), bounds);
  verdict.apart = verdict.apart || (sides_a.beyond && !verdict.meeting);
  const Mask<S> open = !(verdict.apart || verdict.meeting);
  const Mask<S> crossing =
      open && sides_a.all_known && sides_b.all_known && !(sides_a.in_plane || sides_b.in_plane);
  if (anywhere<S>(crossing)) {
    // As in the first stage.
    const RefinedTurned<S> p(a, sides_a.sign), s(b, sides_b.sign);
    const Vector<S> q = choose<S>(s.above, p.next, p.last), r = choose<S>(s.above, p.last, p.next);
    const Vector<S> t = choose<S>(p.above, s.next, s.last), w = choose<S>(p.above, s.last, s.next);
    const PairVector<S> to_s = exact_difference<S>(s.apex, p.apex);
    const Signs<S> first =
        sign_of<S>(dot<S>(cross<S>(exact_difference<S>(t, q), exact_difference<S>(s.apex, q)),
                          exact_difference<S>(p.apex, q)),
                   bounds);
    const Signs<S> second = sign_of<S>(
        dot<S>(cross<S>(to_s, exact_difference<S>(r, p.apex)), exact_difference<S>(w, p.apex)),
        bounds);
    add(crossing, {(first.sign > S(0)) || (second.sign > S(0)),
                   first.known && second.known && (first.sign <= S(0)) && (second.sign <= S(0))});
  }
  const Mask<S> flat = open && sides_a.in_plane && sides_b.in_plane;
  if (anywhere<S>(flat)) add(flat, coplanar<S>(a, b, normal_a, normal_b, bounds));
  return verdict;
}

}  // namespace bvlab
