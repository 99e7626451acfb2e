// SPDX-License-Identifier: BSD-3-Clause
/// The mesh of the examples: a ring about the z axis, in place of one that is read from a file.
#pragma once

#include <cmath>
#include <numbers>

#include "hierarchies/geometry/triangle_mesh.hpp"

/// A tube of radius 0.25 about a circle of radius 1: 2 * around * across triangles.
inline bvlab::TriangleMesh ring(std::uint32_t around = 32, std::uint32_t across = 12) {
  bvlab::TriangleMesh mesh;
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across;
      const double r = 1 + 0.25 * std::cos(b);
      mesh.vertices.push_back({r * std::cos(a), r * std::sin(a), 0.25 * std::sin(b)});
      const std::uint32_t next = (i + 1) % around * across, here = i * across, k = (j + 1) % across;
      mesh.triangles.push_back({here + j, next + j, next + k});
      mesh.triangles.push_back({here + j, next + k, here + k});
    }
  return mesh;
}
