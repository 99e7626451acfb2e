// SPDX-License-Identifier: BSD-3-Clause
/// The corners of a leaf's triangles, one triangle per SIMD lane.
#pragma once

#include <array>
#include <cstddef>

#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// Rounded to T, as corner[corner][coordinate][lane]. Vacant lanes repeat one of the triangles.
template <class T, int F>
struct alignas(sizeof(T) * F) TriangleLanes {
  std::array<std::array<std::array<T, F>, 3>, 3> corner;

  void put(std::size_t lane, const Triangle& triangle) {
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        corner[i][j][lane] = static_cast<T>(triangle[i][static_cast<int>(j)]);
  }
};

}  // namespace bvlab
