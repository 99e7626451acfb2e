// SPDX-License-Identifier: BSD-3-Clause
/// The fixed directions of K-DOPs (klosowski1998efficient): a cube's axes, corners and edges, as
/// small integers, so that products with them are exact and their determinants are integers.
#pragma once

#include <cstdint>

#include "hierarchies/geometry/scalar.hpp"

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
  /// The index of the support value in direction (x, y, z); -1 where there is none.
  static constexpr int index(int x, int y, int z) {
    for (int k = 0; k < slabs; ++k) {
      const auto* d = direction(k);
      if (d[0] == x && d[1] == y && d[2] == z) return 2 * k;
      if (d[0] == -x && d[1] == -y && d[2] == -z) return 2 * k + 1;
    }
    return -1;
  }

  /// Component i of the direction of support value m: 2k for slab k, 2k + 1 for its opposite.
  static constexpr int component(int m, int i) {
    return m % 2 ? -direction(m / 2)[i] : direction(m / 2)[i];
  }

  /// The projection of p on a slab's direction. Products with 1, 0, -1 are exact; the at most two
  /// roundings are each relative to the sum of the magnitudes.
  template <class X>
  static X along(int slab, const Vec3<X>& p) {
    const auto* d = direction(slab);
    return (X(d[0]) * p[0] + X(d[1]) * p[1]) + X(d[2]) * p[2];
  }
};

}  // namespace detail

}  // namespace bvlab
