// SPDX-License-Identifier: BSD-3-Clause
/// Volumes and spheres around the triangles below a node of a wide topology.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "hierarchies/bounding_volume.hpp"
#include "hierarchies/fitting.hpp"
#include "hierarchies/geometry/enclosing_sphere.hpp"
#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/small_matrices.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "hierarchies/geometry/triangle_columns.hpp"
#include "hierarchies/node_sphere.hpp"
#include "hierarchies/wide/collapse.hpp"
#include "hierarchies/wide/lanes.hpp"

namespace bvlab {

/// A volume that is fitted to ranges of triangles in columns, as SlabBox.
template <class V>
concept FittedToColumns = BoundingVolume<V> && requires { typename V::columns; };

/// A sphere around a mesh, in its frame.
struct MeshSphere {
  Vec3<double> centre = Vec3<double>::Zero();
  double radius = 0;

  MeshSphere() = default;
  explicit MeshSphere(const TriangleMesh& mesh) {
    // Each vertex once, where its first triangle is.
    LargeVector<Vec3<double>> corners;
    corners.reserve(mesh.vertices.size());
    std::vector<char> taken(mesh.vertices.size(), 0);
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t v : triangle)
        if (!taken[v]) taken[v] = 1, corners.push_back(mesh.vertices[v]);
    centre = enclosing_sphere(corners).centre;
    for (const auto& corner : corners) radius = std::max(radius, stable_norm(corner - centre));
    radius *= 1 + 16 * unit_roundoff<double>;
  }
  /// About the centre of the mesh's box, and so larger, in one pass. Vertices outside the box are
  /// taken to be on it.
  MeshSphere(const TriangleMesh& mesh, const Eigen::AlignedBox3d& box)
      : centre(box.min() / 2 + box.max() / 2) {
    const auto from_centre = [&](const Vec3<double>& v) -> Vec3<double> {
      return v.cwiseMax(box.min()).cwiseMin(box.max()) - centre;
    };
    double squared = 0;
    for (const auto& v : mesh.vertices) squared = std::max(squared, squared_norm(from_centre(v)));
    radius = largest_norm(squared, [&](const auto& take) {
      for (const auto& v : mesh.vertices) take(from_centre(v));
    });
    radius *= 1 + 16 * unit_roundoff<double>;
  }
};

/// Around all that a box holds.
inline NodeSphere sphere_around(const TriangleColumns::Box& box) {
  NodeSphere sphere;
  const Vec3<double> at = sphere.put_centre(box.low, box.high);
  sphere.put_radius(stable_norm((box.low - at).cwiseAbs().cwiseMax((box.high - at).cwiseAbs())));
  return sphere;
}

/// The sphere around a range of triangles, whose box is `box`. A difference, three products and two
/// sums have five roundings at most, the root halves them and has one of its own: fewer than 4u.
inline NodeSphere sphere_around(const TriangleColumns& columns, std::size_t begin, std::size_t end,
                                const TriangleColumns::Box& box) {
  NodeSphere sphere;
  const Vec3<double> at = sphere.put_centre(box.low, box.high);
  sphere.put_radius(largest_norm(columns.farthest_squared(begin, end, at), [&](const auto& take) {
    for (std::size_t k = 3 * begin; k < 3 * end; ++k) take(columns.corner(k / 3, k % 3) - at);
  }));
  return sphere;
}

/// The triangles of a mesh in the order of a topology: those below a node are contiguous.
class OrderedTriangles {
 public:
  OrderedTriangles(const TriangleMesh& mesh, std::span<const std::uint32_t> order, Threads& threads)
      : triangles_(order.size()), before_(order.size()) {
    threads.share(triangles_.size(),
                  [&](std::size_t k, std::size_t) { triangles_[k] = mesh.corners(order[k]); });
    LargeVector<std::uint32_t> last(mesh.vertices.size(), none);
    for (std::size_t k = 0; k < order.size(); ++k)
      for (std::size_t i = 0; i < 3; ++i)
        before_[k][i] =
            std::exchange(last[mesh.triangles[order[k]][i]], static_cast<std::uint32_t>(k + 1));
  }

  const Triangle& operator[](std::size_t k) const { return triangles_[k]; }
  /// The vertices of primitives `begin` to `end` of the topology, each once.
  std::vector<Vec3<double>> points(std::uint32_t begin, std::uint32_t end) const {
    std::vector<Vec3<double>> points;
    points.reserve(3 * std::size_t{end - begin});
    for (std::uint32_t k = begin; k < end; ++k)
      for (std::size_t i = 0; i < 3; ++i)
        if (before_[k][i] <= begin) points.push_back(triangles_[k][i]);
    return points;
  }
  /// The volume and the sphere around them.
  template <BoundingVolume V>
  std::pair<V, NodeSphere> around(std::uint32_t begin, std::uint32_t end, Fit fit) const {
    const auto points = this->points(begin, end);
    return {fitted<V>(points, std::span(triangles_).subspan(begin, end - begin), fit),
            NodeSphere(points)};
  }

 private:
  static constexpr std::uint32_t none = 0;

  LargeVector<Triangle> triangles_;
  // Of each corner, 1 + the last triangle before it that has the same vertex; or `none`.
  LargeVector<std::array<std::uint32_t, 3>> before_;
};

/// The volumes of nodes and of single triangles of a wide topology.
template <BoundingVolume V>
class NodeFitting {
 public:
  /// `order`: the topology's primitives, or a part of them.
  NodeFitting(const TriangleMesh& mesh, std::span<const std::uint32_t> order, Fit fit,
              Threads& threads)
      : triangles_(mesh, order, threads), fit_(fit) {}

  /// The volume and the sphere around primitives `begin` to `end` of the order.
  std::pair<V, NodeSphere> around(std::uint32_t begin, std::uint32_t end) const {
    return triangles_.template around<V>(begin, end, fit_);
  }
  /// Writes the volumes of `count` primitives from `first` on, and their sizes, to lanes of
  /// siblings. Vacant lanes repeat the last. Returns how far they reach.
  template <class Siblings, class Corners>
  double put_each(std::uint32_t first, std::uint32_t count, Siblings& to, Corners& corners) const {
    constexpr auto lanes = static_cast<std::uint32_t>(sizeof(to.size) / sizeof(typename V::scalar));
    double reach = 0;
    V volume;
    for (std::uint32_t lane = 0; lane < lanes; ++lane) {
      const std::uint32_t k = first + std::min(lane, count - 1);
      if (lane < count) {
        volume = fitted<V>(triangles_[k], std::span(&triangles_[k], 1), fit_);
        reach = std::max(reach, static_cast<double>(reach_of(volume)));
      }
      put_lane(to.volumes, static_cast<int>(lane), volume);
      to.size[lane] = size_of(volume);
      corners.put(lane, triangles_[k]);
    }
    return reach;
  }

 private:
  OrderedTriangles triangles_;
  Fit fit_;
};

/// The same for a volume that is fitted to columns.
template <FittedToColumns V>
class NodeFitting<V> {
 public:
  NodeFitting(const TriangleMesh& mesh, std::span<const std::uint32_t> order, Fit, Threads& threads)
      : columns_(mesh, order, threads), volumes_(columns_, threads) {}

  std::pair<V, NodeSphere> around(std::uint32_t begin, std::uint32_t end) const {
    const TriangleColumns::Box box = columns_.box(begin, end);
    return {volumes_.volume(begin, end, box), sphere_around(columns_, begin, end, box)};
  }
  template <class Siblings, class Corners>
  double put_each(std::uint32_t first, std::uint32_t count, Siblings& to, Corners& corners) const {
    volumes_.put_each(first, count, to.volumes);
    to.size = size(to.volumes);
    corners.put(columns_, first, count);
    return stdx::hmax(reach(to.volumes));
  }

 private:
  TriangleColumns columns_;
  typename V::columns volumes_;
};

/// The largest reach of volumes seen by one thread, aligned to cache lines of its own.
struct alignas(128) Reach {
  double farthest = 0;

  void add(double reach) { farthest = std::max(farthest, reach); }

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
