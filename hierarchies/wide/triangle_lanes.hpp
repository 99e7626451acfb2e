// SPDX-License-Identifier: BSD-3-Clause
/// The corners of a leaf's triangles, one triangle per SIMD lane.
#pragma once

#include <array>
#include <cstddef>

#include "hierarchies/geometry/triangle_columns.hpp"
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

  /// The same with `count` triangles of columns from `first` on; vacant lanes repeat the last.
  void put(const TriangleColumns& columns, std::size_t first, std::size_t count) {
    static_assert(F <= TriangleColumns::readable);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        const double* from = columns.column(i, j) + first;
        for (std::size_t lane = 0; lane < F; ++lane)
          corner[i][j][lane] = static_cast<T>(from[lane]);
        for (std::size_t lane = count; lane < F; ++lane)
          corner[i][j][lane] = corner[i][j][count - 1];
      }
  }
};

}  // namespace bvlab
