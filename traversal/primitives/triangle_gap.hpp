// SPDX-License-Identifier: BSD-3-Clause
/// A cheap lower bound on the distance of two triangles: their gap along the normal of each, and
/// along the line between their centres. It is far below the distance, and often 0, where two edges
/// are nearest.
///
/// Along a vector n, as computed, the corners of one lie `s` beyond those of the other, s by dot
/// products with differences d of corners and the first corner of a. Corners are within `off` of
/// those given, in each coordinate, so d is off by 2 sqrt(3) off and by u |d|, its product with n
/// by 3 u |n| |d| more, and s, a difference of two, by |n| (8 u D + 7 off), D at least as long as
/// any d. |n| and the division are off by less than 6 u of themselves. Numbers below 2^-90 |n|,
/// which may have underflowed, are covered, too. Where |n|^2 itself is not above 2^-100, or is not
/// finite, n gives no bound.
#pragma once

#include <array>
#include <limits>

#include "traversal/primitives/triangle_filter.hpp"

namespace bvlab {

namespace filter {

/// The gap between the projections on n, in units of length; 0 where n gives no bound.
/// `from_first`: the differences of the six corners to a's first.
template <Batched S>
[[gnu::always_inline]] inline S gap_along(const Vector<S>& n,
                                          const std::array<Vector<S>, 6>& from_first) {
  using T = Element<S>;
  S low[2], high[2];
  for (std::size_t side = 0; side < 2; ++side)
    for (std::size_t i = 0; i < 3; ++i) {
      const S along = dot<S>(n, from_first[3 * side + i]);
      low[side] = i ? min(low[side], along) : along;
      high[side] = i ? max(high[side], along) : along;
    }
  const S squared = dot<S>(n, n);
  const S apart = max(low[1] - high[0], low[0] - high[1]);
  const Mask<S> valid = squared > S(T(0x1p-100)) && squared < S(std::numeric_limits<T>::max());
  return select<S>(valid, apart / stdx::sqrt(squared), S(0));
}

}  // namespace filter

/// A lower bound on the distance of each pair of triangles whose corners are within `off` of those
/// given, in each coordinate; 0 where no bound is known.
template <Batched S>
[[gnu::always_inline]] inline S triangle_gap(const Corners<S>& a, const Corners<S>& b,
                                             const S& off) {
  using namespace filter;
  using T = Element<S>;
  constexpr T u = unit_roundoff<S>;
  const std::array<Vector<S>, 6> from_first{a[0] - a[0], a[1] - a[0], a[2] - a[0],
                                            b[0] - a[0], b[1] - a[0], b[2] - a[0]};
  S longest(0);
  Vector<S> between;
  for (std::size_t k = 0; k < 3; ++k) {
    S side = abs(from_first[1][k]);
    for (std::size_t i = 2; i < 6; ++i) side = max(side, abs(from_first[i][k]));
    longest = longest + side;
    between[k] = ((from_first[3][k] + from_first[4][k]) + from_first[5][k]) -
                 (from_first[1][k] + from_first[2][k]);
  }
  const Vector<S> normal_a = cross<S>(from_first[1], from_first[2]);
  const Vector<S> normal_b = cross<S>(b[1] - b[0], b[2] - b[0]);
  const S apart = max(max(gap_along<S>(normal_a, from_first), gap_along<S>(normal_b, from_first)),
                      gap_along<S>(between, from_first));
  const S gap = apart * S(1 - 8 * u) - (S(10 * u) * longest + S(8) * off + S(T(0x1p-90)));
  // Written so that NaN gives 0, as does what has overflowed.
  return select<S>(gap > S(0) && gap < S(std::numeric_limits<T>::infinity()), gap, S(0));
}

}  // namespace bvlab
