// SPDX-License-Identifier: BSD-3-Clause
/// The intersection of K/2 slabs with fixed directions (klosowski1998efficient): K = 6 is the
/// axis-aligned box, 14 adds the directions of a cube's corners, 18 those of its edges, 26 both.
///
/// Kept as K support values bounds[m] >= n_m.x, where n_{2k} is a direction and n_{2k+1} its
/// opposite. A turned one is bounded again by the same directions after zachmann1998rapid: see
/// Realignment. One N_u is 3K multiplications and as many additions, one N_v is K additions and
/// comparisons.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>

#include "hierarchies/geometry/placement.hpp"

namespace bvlab {

namespace detail {

/// Axes, corners and edges of a cube, up to sign.
inline constexpr std::int8_t cube_directions[13][3] = {
    {1, 0, 0}, {0, 1, 0},  {0, 0, 1},                                       //
    {1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {1, -1, -1},                         //
    {1, 1, 0}, {1, -1, 0}, {1, 0, 1},  {1, 0, -1},  {0, 1, 1}, {0, 1, -1},  //
};

template <int K>
struct KdopDirections {
  static_assert(K == 6 || K == 14 || K == 18 || K == 26);
  static constexpr int slabs = K / 2;
  static constexpr bool has_corners = K == 14 || K == 26, has_edges = K == 18 || K == 26;

  static constexpr const std::int8_t* direction(int slab) {
    return cube_directions[K == 18 && slab >= 3 ? slab + 4 : slab];
  }
  static constexpr int squared_length(int slab) {
    const auto* d = direction(slab);
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  }
  static constexpr double length(int slab) {
    constexpr double root[] = {0, 1, 1.4142135623730951, 1.7320508075688774};
    return root[squared_length(slab)];
  }
  /// Which support value is the one of the direction (x, y, z).
  static constexpr int index(int x, int y, int z) {
    for (int k = 0; k < slabs; ++k) {
      const auto* d = direction(k);
      if (d[0] == x && d[1] == y && d[2] == z) return 2 * k;
      if (d[0] == -x && d[1] == -y && d[2] == -z) return 2 * k + 1;
    }
    return -1;
  }

  /// Products with 1, 0, -1 are exact; there are at most two roundings, each of at most the sum of
  /// the magnitudes.
  template <class X>
  static X along(int slab, const Vec3<X>& p) {
    const auto* d = direction(slab);
    return (X(d[0]) * p[0] + X(d[1]) * p[1]) + X(d[2]) * p[2];
  }
};

}  // namespace detail

/// A pose made ready for K-DOPs.
///
/// Let n = R'd for a direction d. For weights w >= 0 with sum w_m n_m = n, every x of the volume
/// has n.x <= sum w_m bounds[m] (the weak half of linear duality), so that the turned volume is
/// bounded along d by three old support values. The three are those around n in the fan of
/// directions that the symmetries of the cube cut into congruent pieces: sorting the coordinates of
/// n leaves one piece.
///
/// `offset` is d.(t - o) plus all that rounding can do. With |v| and bounds[m] / |n_m| at most
/// reach, and sum w_m |n_m| <= sqrt(3) |d| in each piece,
///   8u (reach + |t|) |d|         for the vertex in the world, see Placement
///   (sqrt(3) e + 16u) reach |d|  for n and its weights, rounded to T
///   4.1e (sqrt(3) reach + |t - o| + this) |d|  for the three products and three sums
/// is less than 2 |d| slack, with `slack` that of Placement.
template <class T, int K>
struct Realignment {
  struct Row {
    std::array<T, 3> weight;
    std::array<std::int32_t, 3> from;  ///< for the opposite direction: from ^ 1
    T offset, opposite_offset;
  };
  std::array<Row, K / 2> rows;

  Realignment() {
    for (int k = 0; k < K / 2; ++k) rows[k] = {{1, 0, 0}, {2 * k, 2 * k, 2 * k}, 0, 0};
  }

  Realignment(const Pose& pose, const Vec3<double>& origin, double reach) {
    const Vec3<double> offset = pose.translation - origin;
    double slack = Placement<T>(pose, origin, reach).slack;
    // Sums of numbers this large could overflow on their way.
    if (!(16 * (reach + offset.norm()) < std::numeric_limits<T>::max()))
      slack = std::numeric_limits<double>::infinity();
    for (int k = 0; k < K / 2; ++k) {
      const auto* d = Directions::direction(k);
      rows[k] = combination(pose.rotation.transpose() * Vec3<double>(d[0], d[1], d[2]));
      const double along = Directions::along(k, offset);
      const double room = Directions::length(k) *
                          (2 * slack + 8 * unit_roundoff<double> * offset.template lpNorm<1>());
      rows[k].offset = rounded_up<T>(along + room);
      rows[k].opposite_offset = rounded_up<T>(room - along);
    }
  }

 private:
  using Directions = detail::KdopDirections<K>;

  static Row combination(const Vec3<double>& n) {
    int order[3] = {0, 1, 2};
    if (std::abs(n[order[0]]) < std::abs(n[order[1]])) std::swap(order[0], order[1]);
    if (std::abs(n[order[1]]) < std::abs(n[order[2]])) std::swap(order[1], order[2]);
    if (std::abs(n[order[0]]) < std::abs(n[order[1]])) std::swap(order[0], order[1]);
    const double x = std::abs(n[order[0]]), y = std::abs(n[order[1]]), z = std::abs(n[order[2]]);
    const auto index = [&](int i, int j, int k) {
      int d[3];
      d[order[0]] = n[order[0]] < 0 ? -i : i;
      d[order[1]] = n[order[1]] < 0 ? -j : j;
      d[order[2]] = n[order[2]] < 0 ? -k : k;
      return Directions::index(d[0], d[1], d[2]);
    };
    const auto row = [](double a, int i, double b, int j, double c, int k) {
      return Row{{static_cast<T>(a), static_cast<T>(b), static_cast<T>(c)}, {i, j, k}, 0, 0};
    };
    // x >= y >= z >= 0.
    if constexpr (K == 6) return row(x, index(1, 0, 0), y, index(0, 1, 0), z, index(0, 0, 1));
    if constexpr (K == 14)
      return row(x - y, index(1, 0, 0), (y + z) / 2, index(1, 1, 1), (y - z) / 2, index(1, 1, -1));
    if constexpr (K == 26)
      return row(x - y, index(1, 0, 0), y - z, index(1, 1, 0), z, index(1, 1, 1));
    if (x >= y + z) return row(x - (y + z), index(1, 0, 0), y, index(1, 1, 0), z, index(1, 0, 1));
    return row((x + y - z) / 2, index(1, 1, 0), (x + z - y) / 2, index(1, 0, 1),
               std::max(0.0, (y + z - x) / 2), index(0, 1, 1));
  }
};

template <Scalar S, int K>
struct Kdop {
  static constexpr std::string_view name = K == 6    ? "aabb"
                                           : K == 14 ? "kdop14"
                                           : K == 18 ? "kdop18"
                                                     : "kdop26";
  static constexpr std::string_view description =
      K == 6    ? "axis-aligned box, bounded again when turned (Zachmann 1998)"
      : K == 14 ? "slabs along a cube's axes and corners, realigned when turned (Zachmann 1998)"
      : K == 18 ? "slabs along a cube's axes and edges, realigned when turned (Zachmann 1998)"
                : "slabs along a cube's axes, corners and edges, realigned when turned (Zachmann "
                  "1998)";
  using scalar = S;
  template <class Other>
  using over = Kdop<Other, K>;
  using placement = Realignment<Element<S>, K>;
  using Directions = detail::KdopDirections<K>;

  std::array<S, K> bounds;

  static Kdop enclosing(std::span<const Vec3<double>> points) requires(!Batched<S>) {
    std::array<double, K> most;
    most.fill(-std::numeric_limits<double>::infinity());
    for (const auto& p : points)
      for (int k = 0; k < K / 2; ++k) {
        const double at = Directions::along(k, p);
        // For what was rounded; along the axes nothing is.
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

template <class S, int K>
Kdop<S, K> merge(const Kdop<S, K>& a, const Kdop<S, K>& b) {
  Kdop<S, K> both;
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

/// A rounded sum has the sign of the exact one, so there is no margin. A NaN (from an overflow)
/// compares as not disjoint.
template <class S, int K>
[[gnu::always_inline]] inline Mask<S> disjoint(const Kdop<S, K>& a, const Kdop<S, K>& b) {
  Mask<S> apart(false);
  for (int m = 0; m < K; ++m) apart = apart || a.bounds[m] + b.bounds[m ^ 1] < S(0);
  return apart;
}

/// The distance between the two boxes that the axes alone make, or between the slabs of the
/// direction in which they are farthest apart. Five roundings at most, all relative.
template <class S, int K>
S gap(const Kdop<S, K>& a, const Kdop<S, K>& b) {
  using std::max, std::min, std::sqrt;
  S squared(0), farthest(0);
  for (int k = 0; k < K / 2; ++k) {
    const S above = -(a.bounds[2 * k] + b.bounds[2 * k + 1]),
            below = -(a.bounds[2 * k + 1] + b.bounds[2 * k]);
    // Not both are positive; written so that a NaN counts as nothing.
    const S apart = select(above > S(0), above, S(0)) + select(below > S(0), below, S(0));
    if (k < 3)
      squared = squared + apart * apart;
    else
      farthest =
          max(farthest, apart * S(static_cast<Element<S>>(1 / Kdop<S, K>::Directions::length(k))));
  }
  // A square that overflows belongs to a distance that is larger still.
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

/// Half the diagonal of the box that the axes make.
template <class S, int K>
S size(const Kdop<S, K>& volume) {
  S squared(0);
  for (int k = 0; k < 3; ++k) {
    const S width = volume.bounds[2 * k] + volume.bounds[2 * k + 1];
    squared = squared + width * width;
  }
  using std::sqrt;
  return sqrt(squared) / S(2);
}

/// The largest distance of a slab's side from the origin, and of the box's corners.
template <class S, int K>
S reach(const Kdop<S, K>& volume) {
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
