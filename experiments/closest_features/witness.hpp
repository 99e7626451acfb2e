// SPDX-License-Identifier: BSD-3-Clause
/// Where two polytopes are nearest: up to three vertices of each, whose hulls hold the nearest
/// points. The distance is computed from them where they stand in the world, to the last digits,
/// whatever frame they were found in.
#pragma once

#include <algorithm>

#include "experiments/closest_features/polytope.hpp"
#include "experiments/replay/triangle_test.hpp"

namespace bvlab::closest_features {

struct Witness {
  struct Corners {
    std::array<std::uint32_t, 3> vertices{};
    std::size_t count = 0;
    void add(std::uint32_t v) {
      if (std::find(vertices.begin(), vertices.begin() + count, v) == vertices.begin() + count)
        vertices[count++] = v;
    }
  };
  std::array<Corners, 2> corners;
  bool apart = true;  ///< false: the polytopes share a point

  double distance(const PosedPair& posed) const {
    return apart ? nearest_points(posed).distance : 0;
  }

  TriangleDistance nearest_points(const PosedPair& posed) const {
    std::array<Triangle, 2> hulls;
    for (std::size_t side = 0; side < 2; ++side)
      for (std::size_t k = 0; k < 3; ++k)
        hulls[side][k] = posed.in_world(
            static_cast<int>(side), corners[side].vertices[std::min(k, corners[side].count - 1)]);
    return bvlab::distance(hulls[0], hulls[1]);
  }
};

/// What finding it took.
struct Effort {
  std::uint64_t vertices = 0;  ///< vertices, or planes of regions, looked at
  std::uint64_t steps = 0;     ///< simplices, or pairs of features, tried
};

}  // namespace bvlab::closest_features
