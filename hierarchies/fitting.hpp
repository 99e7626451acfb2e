// SPDX-License-Identifier: BSD-3-Clause
/// Fits a volume to some triangles of a mesh, by the construction that `Fit` selects.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "hierarchies/bounding_volume.hpp"
#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// The volume around `points`, which must be the corners of `triangles`.
template <BoundingVolume V>
V fitted(std::span<const Vec3<double>> points, std::span<const Triangle> triangles, Fit fit) {
  if constexpr (FittedTightly<V>)
    if (fit == Fit::tight) return V::tight(points, triangles);
  if constexpr (FittedToTriangles<V>)
    return V::enclosing(points, triangles);
  else
    return V::enclosing(points);
}

/// The buffers of one thread, aligned so that threads share no cache line.
template <BoundingVolume V>
struct alignas(128) Fitting {
  std::vector<std::uint32_t> vertices;
  LargeVector<Vec3<double>> points;
  LargeVector<Triangle> triangles;

  /// Collects the vertices of the given triangles, each once.
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

  /// The volume around the collected vertices.
  V volume(Fit fit) const { return fitted<V>(points, triangles, fit); }
};

}  // namespace bvlab
