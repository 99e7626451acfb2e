// SPDX-License-Identifier: BSD-3-Clause
/// Triangles as a pose gives them, for comparisons one by one: references, not the engine.
#pragma once

#include <vector>

#include "hierarchies/geometry/pose.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// The triangles of a mesh with corners R v + t, in its order.
inline std::vector<Triangle> posed_triangles(const TriangleMesh& mesh, const Pose& pose) {
  std::vector<Triangle> triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    triangles.push_back(pose(mesh.corners(t)));
  return triangles;
}

/// Whether the closed boxes of two triangles along the axes meet.
inline bool boxes_meet(const Triangle& a, const Triangle& b) {
  const auto low = [](const Triangle& t) {
    return t[0].cwiseMin(t[1]).cwiseMin(t[2]).array().eval();
  };
  const auto high = [](const Triangle& t) {
    return t[0].cwiseMax(t[1]).cwiseMax(t[2]).array().eval();
  };
  return (low(a) <= high(b)).all() && (low(b) <= high(a)).all();
}

}  // namespace bvlab
