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
#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/small_matrices.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "hierarchies/wide/collapse.hpp"

namespace bvlab {

/// A sphere around a mesh, in its frame.
struct MeshSphere {
  Vec3<double> centre = Vec3<double>::Zero();
  double radius = 0;

  MeshSphere() = default;
  explicit MeshSphere(const TriangleMesh& mesh) {
    LargeVector<Vec3<double>> corners;
    corners.reserve(3 * mesh.triangles.size());
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
  /// Centred on the bounding box of the points.
  explicit NodeSphere(std::span<const Vec3<double>> points) {
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

/// The corners of a mesh's triangles in the order of a topology: those below a node are contiguous,
/// and each vertex is repeated for every triangle that it belongs to.
class OrderedTriangles {
 public:
  OrderedTriangles(const TriangleMesh& mesh, const WideTopology& topology, Threads& threads)
      : triangles_(topology.primitives.size()) {
    threads.share(triangles_.size(), [&](std::size_t k, std::size_t) {
      triangles_[k] = mesh.corners(topology.primitives[k]);
    });
  }

  const Triangle& operator[](std::size_t k) const { return triangles_[k]; }
  /// The triangles of primitives `begin` to `end` of the topology.
  std::span<const Triangle> triangles(std::uint32_t begin, std::uint32_t end) const {
    return std::span(triangles_).subspan(begin, end - begin);
  }
  std::span<const Vec3<double>> points(std::uint32_t begin, std::uint32_t end) const {
    static_assert(sizeof(Triangle) == 3 * sizeof(Vec3<double>));
    return {triangles_[begin].data(), 3 * std::size_t{end - begin}};
  }
  template <BoundingVolume V>
  V volume(std::uint32_t begin, std::uint32_t end, Fit fit) const {
    return fitted<V>(points(begin, end), triangles(begin, end), fit);
  }

 private:
  LargeVector<Triangle> triangles_;
};

/// The largest reach of volumes seen by one thread, aligned to cache lines of its own.
struct alignas(128) Reach {
  double farthest = 0;

  template <BoundingVolume V>
  void add(const V& volume) {
    farthest = std::max(farthest, static_cast<double>(reach_of(volume)));
  }
};

/// The largest distance of any vertex and of any fitted volume from the mesh's own origin.
template <Scalar S>
double reach_of_all(const TriangleMesh& mesh, const std::vector<Reach>& of_volumes) {
  double reach = 0;
  for (const auto& each : of_volumes) reach = std::max(reach, each.farthest);
  for (const auto& v : mesh.vertices) reach = std::max(reach, stable_norm(v));
  return reach * (1 + 8 * unit_roundoff<S>);
}

}  // namespace bvlab
