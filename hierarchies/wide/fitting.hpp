// SPDX-License-Identifier: BSD-3-Clause
/// Volumes and spheres around the triangles below a node of a wide topology.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "hierarchies/bounding_volume.hpp"
#include "hierarchies/fitting.hpp"
#include "hierarchies/geometry/enclosing_sphere.hpp"
#include "hierarchies/geometry/written_out.hpp"
#include "hierarchies/wide/collapse.hpp"

namespace bvlab {

/// A sphere around a mesh, in its frame.
struct MeshSphere {
  Vec3<double> centre = Vec3<double>::Zero();
  double radius = 0;

  MeshSphere() = default;
  explicit MeshSphere(const TriangleMesh& mesh) {
    std::vector<Vec3<double>> corners;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      for (const auto& corner : mesh.corners(i)) corners.push_back(corner);
    centre = enclosing_sphere(corners).centre;
    for (const auto& corner : corners) radius = std::max(radius, stable_norm(corner - centre));
    radius *= 1 + 16 * unit_roundoff<double>;
  }
};

/// A sphere around the triangles of a node.
struct alignas(16) NodeSphere {
  float centre[3];
  float radius;

  NodeSphere() = default;
  /// About the centre of their box.
  explicit NodeSphere(const std::vector<Vec3<double>>& points) {
    Vec3<double> low = points[0], high = points[0];
    for (const auto& point : points)
      for (int i = 0; i < 3; ++i)
        low[i] = std::min(low[i], point[i]), high[i] = std::max(high[i], point[i]);
    Vec3<double> at;
    for (int i = 0; i < 3; ++i) {
      centre[i] = static_cast<float>(0.5 * low[i] + 0.5 * high[i]);
      at[i] = static_cast<double>(centre[i]);
    }
    double farthest = 0;
    for (const auto& point : points) farthest = std::max(farthest, stable_norm(point - at));
    radius = rounded_up<float>(farthest * (1 + 16 * unit_roundoff<double>));
  }
};

/// The volume around primitives `begin` to `end` of the topology.
template <BoundingVolume V>
V volume_around(const TriangleMesh& mesh, const WideTopology& topology, std::uint32_t begin,
                std::uint32_t end, Fit fit, Fitting<V>& own) {
  own.take_corners(mesh, std::span(topology.primitives).subspan(begin, end - begin));
  return own.volume(fit);
}

/// The largest distance of any vertex and of any fitted volume from the mesh's own origin.
template <BoundingVolume V>
double reach_of_all(const TriangleMesh& mesh, const std::vector<Fitting<V>>& fitting) {
  double reach = 0;
  for (const auto& each : fitting) reach = std::max(reach, each.reach);
  for (const auto& v : mesh.vertices) reach = std::max(reach, stable_norm(v));
  return reach * (1 + 8 * unit_roundoff<typename V::scalar>);
}

}  // namespace bvlab
