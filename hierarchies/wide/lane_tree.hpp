// SPDX-License-Identifier: BSD-3-Clause
/// What trees whose siblings are stored in lanes have in common, whatever their volumes: a mesh,
/// its triangles leaf by leaf, and spheres around nodes.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/node_sphere.hpp"
#include "hierarchies/wide/fitting.hpp"
#include "hierarchies/wide/support_map.hpp"

namespace bvlab {

class LaneTree {
 public:
  LaneTree(const LaneTree&) = delete;
  LaneTree& operator=(const LaneTree&) = delete;
  LaneTree(LaneTree&&) = default;
  LaneTree& operator=(LaneTree&&) = default;

  /// The number of nodes; on demand, the most that there may be.
  std::size_t size() const { return node_spheres_.size(); }
  const NodeSphere& node_sphere(std::uint32_t i) const { return node_spheres_[i]; }
  /// The mesh's index of the triangle in lane `k - first` of a leaf.
  std::uint32_t triangle(std::uint32_t k) const { return triangles_[k]; }
  /// The origin of the mesh (LocalMesh), in its frame: all else is relative to it.
  const Vec3<double>& origin() const { return origin_; }
  /// An upper bound on the distance of vertices and volumes from the origin.
  double reach() const { return reach_; }

  const MeshSphere& sphere() const { return sphere_; }
  /// The support map about the sphere's centre; of a tree on demand it is empty.
  const SupportMap& supports() const { return supports_; }

 protected:
  LaneTree() = default;
  /// `paging`: of arrays.
  explicit LaneTree(Paging paging)
      : node_spheres_(LargeAllocator<NodeSphere>(paging)),
        triangles_(LargeAllocator<std::uint32_t>(paging)) {}

  // Of a tree on demand, what is not made is not written.
  mutable LargeVector<NodeSphere> node_spheres_;
  mutable LargeVector<std::uint32_t> triangles_;
  double reach_ = 0;
  Vec3<double> origin_;
  MeshSphere sphere_;
  SupportMap supports_;
};

}  // namespace bvlab
