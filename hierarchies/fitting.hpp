// SPDX-License-Identifier: BSD-3-Clause
/// Fits a volume to some triangles of a mesh.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "hierarchies/bounding_volume.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// Buffers of one thread, in cache lines of its own.
template <BoundingVolume V>
struct alignas(128) Fitting {
  std::vector<std::uint32_t> vertices;
  std::vector<Vec3<double>> points;
  std::vector<Triangle> triangles;
  double reach = 0;  ///< of the volumes fitted so far, where the caller keeps it

  /// Takes each vertex of the triangles once.
  void take_vertices(const TriangleMesh& mesh, std::span<const std::uint32_t> primitives) {
    vertices.clear(), points.clear(), triangles.clear();
    for (const auto primitive : primitives)
      for (const auto vertex : mesh.triangles[primitive]) vertices.push_back(vertex);
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    for (const auto vertex : vertices) points.push_back(mesh.vertices[vertex]);
    if constexpr (FittedToTriangles<V> || FittedTightly<V>)
      for (const auto primitive : primitives) triangles.push_back(mesh.corners(primitive));
  }
  /// Takes the three corners of each triangle: a vertex counts as often as it is a corner.
  void take_corners(const TriangleMesh& mesh, std::span<const std::uint32_t> primitives) {
    points.clear(), triangles.clear();
    for (const auto primitive : primitives) {
      triangles.push_back(mesh.corners(primitive));
      for (const auto& corner : triangles.back()) points.push_back(corner);
    }
  }

  /// The volume around what was taken.
  V volume(Fit fit) const {
    if constexpr (FittedTightly<V>)
      if (fit == Fit::tight) return V::tight(points, triangles);
    if constexpr (FittedToTriangles<V>)
      return V::enclosing(points, triangles);
    else
      return V::enclosing(points);
  }
};

}  // namespace bvlab
