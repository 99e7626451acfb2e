// SPDX-License-Identifier: BSD-3-Clause
/// Bounds a rotated K-DOP again in its own directions, after zachmann1998rapid: the default policy
/// of Kdop.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

#include "hierarchies/geometry/placement.hpp"
#include "hierarchies/volumes/kdop_directions.hpp"

namespace bvlab {

/// The offsets that a pose adds to bounds along each direction d and its opposite: d.(t - o), and
/// twice the `slack` of Placement, which covers rounding; the derivation is in Realignment.
template <class T, int K>
struct KdopOffsets {
  std::array<T, K / 2> along, opposite;

  KdopOffsets(const Pose& pose, const Vec3<double>& origin, double reach, double error_bound = 0) {
    using Directions = detail::KdopDirections<K>;
    const Vec3<double> offset = pose.translation - origin;
    double slack = Placement<T>(pose, origin, reach).slack + error_bound;
    // Sums of numbers this large could overflow.
    if (!(16 * (reach + offset.norm()) < std::numeric_limits<T>::max()))
      slack = std::numeric_limits<double>::infinity();
    for (int k = 0; k < K / 2; ++k) {
      const double at = Directions::along(k, offset);
      const double room = Directions::length(k) *
                          (2 * slack + 8 * unit_roundoff<double> * offset.template lpNorm<1>());
      along[k] = rounded_up<T>(at + room);
      opposite[k] = rounded_up<T>(room - at);
    }
  }
};

/// A pose prepared for K-DOPs.
///
/// Let n = R'd for a direction d. For weights w >= 0 with sum w_m n_m = n, every x of the volume
/// has n.x <= sum w_m bounds[m] (the weak half of linear duality), so that the rotated volume is
/// bounded along d by three old support values. The three directions span the cone around n:
/// the symmetries of the cube cut the directions into congruent cones, and sorting the moduli of
/// n's coordinates selects one.
///
/// `offset` is d.(t - o) plus all rounding errors. With |v| and bounds[m] / |n_m| at most
/// reach, and sum w_m |n_m| <= sqrt(3) |d| in each piece,
///   8u (reach + |t|) |d|         for the vertex in the world, see Placement
///   (sqrt(3) e + 16u) reach |d|  for n and its weights, rounded to T
///   4.1e (sqrt(3) reach + |t - o| + this) |d|  for the three products and three sums
/// is less than 2 |d| slack, with `slack` that of Placement.
template <class T, int K>
struct Realignment {
  struct Row {
    std::array<T, 3> weight;
    std::array<std::int32_t, 3> from;  ///< support values; for the opposite direction: ^ 1
    T offset, opposite_offset;
  };
  std::array<Row, K / 2> rows;

  Realignment() {
    for (int k = 0; k < K / 2; ++k) rows[k] = {{1, 0, 0}, {2 * k, 2 * k, 2 * k}, 0, 0};
  }

  /// `error_bound`: an error of the pose itself, added to `slack`.
  Realignment(const Pose& pose, const Vec3<double>& origin, double reach, double error_bound = 0) {
    const KdopOffsets<T, K> offsets(pose, origin, reach, error_bound);
    for (int k = 0; k < K / 2; ++k) {
      const auto* d = Directions::direction(k);
      rows[k] = combination(pose.rotation.transpose() * Vec3<double>(d[0], d[1], d[2]));
      rows[k].offset = offsets.along[k];
      rows[k].opposite_offset = offsets.opposite[k];
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

/// The policy that bounds a rotated K-DOP again by one dual basis per direction, see Realignment.
/// Posing (C_u) takes 3K multiplications and as many additions.
struct Realigned {
  template <class T, int K>
  using placement = Realignment<T, K>;
  template <int K>
  static constexpr std::string_view name = K == 6    ? "aabb"
                                           : K == 14 ? "kdop14"
                                           : K == 18 ? "kdop18"
                                                     : "kdop26";
  template <int K>
  static constexpr std::string_view description =
      K == 6    ? "axis-aligned box, bounded again when rotated (Zachmann 1998)"
      : K == 14 ? "slabs along a cube's axes and corners, realigned when rotated (Zachmann 1998)"
      : K == 18 ? "slabs along a cube's axes and edges, realigned when rotated (Zachmann 1998)"
                : "slabs along a cube's axes, corners and edges, realigned when rotated (Zachmann "
                  "1998)";
};

}  // namespace bvlab
