// SPDX-License-Identifier: BSD-3-Clause
/// A triangle mesh: triangles over shared vertices; may be open, self-intersecting or degenerate.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "hierarchies/geometry/scalar.hpp"

namespace bvlab {

/// Three corners in one frame, float64.
using Triangle = std::array<Vec3<double>, 3>;

struct TriangleMesh {
  std::vector<Vec3<double>> vertices;                   ///< finite
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into `vertices`

  Triangle corners(std::size_t triangle) const {
    const auto& [i, j, k] = triangles[triangle];
    return {vertices[i], vertices[j], vertices[k]};
  }
};

}  // namespace bvlab
