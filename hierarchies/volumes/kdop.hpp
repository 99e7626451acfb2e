// SPDX-License-Identifier: BSD-3-Clause
/// A K-DOP: the intersection of K/2 slabs with fixed directions (klosowski1998efficient). K = 6 is
/// the axis-aligned box, 14 adds a cube's corner directions, 18 its edge directions, 26 both.
///
/// Stored as K support values bounds[m] >= n_m.x, where n_{2k} is a direction and n_{2k+1} its
/// opposite. A rotated K-DOP is bounded again in the same directions; how is a policy, Realigned by
/// default. A test (C_v) takes K additions and comparisons.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>

#include "hierarchies/volumes/kdop_directions.hpp"
#include "hierarchies/volumes/kdop_realigned.hpp"

namespace bvlab {

/// `Posing` is the policy: how a rotated K-DOP is bounded again, and what is stored for that.
/// A policy stores nothing but the bounds.
template <Scalar S, int K, class Posing = Realigned>
struct Kdop {
  static constexpr std::string_view name = Posing::template name<K>;
  static constexpr std::string_view description = Posing::template description<K>;
  using scalar = S;
  template <class Other>
  using over = Kdop<Other, K, Posing>;
  using placement = typename Posing::template placement<Element<S>, K>;
  using Directions = detail::KdopDirections<K>;

  std::array<S, K> bounds;

  static Kdop enclosing(std::span<const Vec3<double>> points)
    requires(!Batched<S>)
  {
    std::array<double, K> most;
    most.fill(-std::numeric_limits<double>::infinity());
    for (const auto& p : points)
      for (int k = 0; k < K / 2; ++k) {
        const double at = Directions::along(k, p);
        // Covers rounding; projections to the axes are exact.
        const double room = Directions::squared_length(k) == 1
                                ? 0
                                : 4 * unit_roundoff<double> * p.template lpNorm<1>();
        most[2 * k] = std::max(most[2 * k], at + room);
        most[2 * k + 1] = std::max(most[2 * k + 1], room - at);
      }
    Kdop result;
    for (int m = 0; m < K; ++m) result.bounds[m] = rounded_up<S>(most[m]);
    return result;
  }
};

template <class S, int K, class Posing>
Kdop<S, K, Posing> merge(const Kdop<S, K, Posing>& a, const Kdop<S, K, Posing>& b) {
  Kdop<S, K, Posing> both;
  for (int m = 0; m < K; ++m) both.bounds[m] = std::max(a.bounds[m], b.bounds[m]);
  return both;
}

template <class S, int K>
Kdop<S, K> posed(const Kdop<S, K>& volume, const Realignment<Element<S>, K>& pose) {
  Kdop<S, K> result;
  for (int k = 0; k < K / 2; ++k) {
    const auto& [weight, from, offset, opposite_offset] = pose.rows[k];
    const auto along = [&](int opposite) {
      return (S(weight[0]) * volume.bounds[from[0] ^ opposite] +
              S(weight[1]) * volume.bounds[from[1] ^ opposite]) +
             S(weight[2]) * volume.bounds[from[2] ^ opposite];
    };
    result.bounds[2 * k] = along(0) + S(offset);
    result.bounds[2 * k + 1] = along(1) + S(opposite_offset);
  }
  return result;
}

/// A rounded sum has the sign of the exact one, so no margin is needed. A comparison with NaN (from
/// an overflow) means not disjoint.
template <class S, int K>
[[gnu::always_inline]] inline Mask<S> disjoint(const Kdop<S, K>& a, const Kdop<S, K>& b) {
  Mask<S> apart(false);
  for (int m = 0; m < K; ++m) apart = apart || a.bounds[m] + b.bounds[m ^ 1] < S(0);
  return apart;
}

/// A lower bound on the distance: that of the boxes along the axes, or of the two slabs that are
/// farthest apart, whichever is larger. At most five roundings, all relative.
template <class S, int K>
S gap(const Kdop<S, K>& a, const Kdop<S, K>& b) {
  using std::max, std::min, std::sqrt;
  S squared(0), farthest(0);
  for (int k = 0; k < K / 2; ++k) {
    const S above = -(a.bounds[2 * k] + b.bounds[2 * k + 1]),
            below = -(a.bounds[2 * k + 1] + b.bounds[2 * k]);
    // At most one is positive; written so that NaN counts as no gap.
    const S apart = select(above > S(0), above, S(0)) + select(below > S(0), below, S(0));
    if (k < 3)
      squared = squared + apart * apart;
    else
      farthest =
          max(farthest, apart * S(static_cast<Element<S>>(1 / Kdop<S, K>::Directions::length(k))));
  }
  // Where a square overflows, the largest number is still a lower bound.
  const S largest(std::numeric_limits<Element<S>>::max());
  return max(sqrt(min(largest, squared)), min(largest, farthest)) * S(1 - 8 * unit_roundoff<S>);
}

template <class S, int K>
bool contains(const Kdop<S, K>& volume, const Vec3<long double>& point) {
  for (int k = 0; k < K / 2; ++k) {
    const long double at = detail::KdopDirections<K>::along(k, point);
    if (at > static_cast<long double>(volume.bounds[2 * k]) ||
        -at > static_cast<long double>(volume.bounds[2 * k + 1]))
      return false;
  }
  return true;
}

/// Half the diagonal of the box along the axes.
template <class S, int K, class Posing>
S size(const Kdop<S, K, Posing>& volume) {
  S squared(0);
  for (int k = 0; k < 3; ++k) {
    const S width = volume.bounds[2 * k] + volume.bounds[2 * k + 1];
    squared = squared + width * width;
  }
  using std::sqrt;
  return sqrt(squared) / S(2);
}

/// The largest distance from the origin of a slab's face or of a corner of the box.
template <class S, int K, class Posing>
S reach(const Kdop<S, K, Posing>& volume) {
  using std::abs, std::max, std::sqrt;
  S squared(0), farthest(0);
  for (int k = 0; k < K / 2; ++k) {
    const S most = max(abs(volume.bounds[2 * k]), abs(volume.bounds[2 * k + 1]));
    if (k < 3) squared = squared + most * most;
    farthest =
        max(farthest, most * S(static_cast<Element<S>>(1 / Kdop<S, K>::Directions::length(k))));
  }
  return max(sqrt(squared), farthest);
}

template <class S>
using Aabb = Kdop<S, 6>;
template <class S>
using Kdop14 = Kdop<S, 14>;
template <class S>
using Kdop18 = Kdop<S, 18>;
template <class S>
using Kdop26 = Kdop<S, 26>;

}  // namespace bvlab
