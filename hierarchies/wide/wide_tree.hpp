// SPDX-License-Identifier: BSD-3-Clause
/// What a wide tree is apart from its volumes: nodes with up to F children each, spheres around
/// them, and the triangles of leaves in lanes. WideHierarchy, which is derived from it, has the
/// volumes. Loops that do not know their type see a tree as this (any_volume.hpp).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/once.hpp"
#include "hierarchies/node_sphere.hpp"
#include "hierarchies/wide/fitting.hpp"
#include "hierarchies/wide/heads.hpp"
#include "hierarchies/wide/support_map.hpp"
#include "hierarchies/wide/triangle_lanes.hpp"

namespace bvlab {

/// The fan-out of trees where none is asked for: as many children as a register has lanes. A wider
/// node would be tested in several steps; none is narrower than two.
template <class T>
inline constexpr int native_fan_out = std::clamp(native_width<T>, 2, 16);

template <int F>
struct SiblingCalls;

template <class T, int F>
class WideTree {
  static_assert(F == 2 || F == 4 || F == 8 || F == 16);

 public:
  using scalar = T;
  using Lane = Batch<T, F>;
  static constexpr int fan_out = F;

  /// The data of a node that are read before it is tested or opened. Its volume follows.
  struct Node {
    T size;
    std::uint32_t first;  ///< of its children, once made; leaf: of its triangles, see triangle()
    std::uint16_t lanes;  ///< which of its lanes hold a child, once made
    std::uint16_t leaf;   ///< 0 or 1
    std::uint32_t made;   ///< `whole` once its children are, else see once.hpp
  };

  WideTree(const WideTree&) = delete;
  WideTree& operator=(const WideTree&) = delete;
  WideTree(WideTree&&) = default;
  WideTree& operator=(WideTree&&) = default;

  /// The number of nodes; on demand, the most that there may be.
  std::size_t size() const { return node_spheres_.size(); }
  const Node& node(std::uint32_t i) const { return heads_[i]; }
  const NodeSphere& node_sphere(std::uint32_t i) const { return node_spheres_[i]; }
  /// The corners of a leaf, by its `first`.
  const TriangleLanes<T, F>& corners(std::uint32_t first) const { return corners_[first / F]; }
  /// The leaf that holds triangle k.
  std::uint32_t leaf_of(std::uint32_t k) const { return leaves_[k / F]; }
  /// The mesh's index of the triangle in lane `k - first` of a leaf.
  std::uint32_t triangle(std::uint32_t k) const { return triangles_[k]; }
  /// The origin of the mesh (LocalMesh), in its frame: all else is relative to it.
  const Vec3<double>& origin() const { return origin_; }
  /// An upper bound on the distance of vertices and volumes from the origin.
  double reach() const { return reach_; }

  /// Trees that are made on demand have another of this name.
  static void require(std::uint32_t) {}

  const MeshSphere& sphere() const { return sphere_; }
  /// The support map about the sphere's centre; of a tree on demand it is empty.
  const SupportMap& supports() const { return supports_; }

  /// The tests of its volumes, for loops that do not know their type; null where nobody has set
  /// them (calls_of in any_volume.hpp).
  const SiblingCalls<F>* calls = nullptr;

 protected:
  static constexpr std::uint32_t whole = 1, nothing = 0;

  WideTree() = default;
  /// `paging`: of arrays.
  explicit WideTree(Paging paging)
      : node_spheres_(LargeAllocator<NodeSphere>(paging)),
        corners_(LargeAllocator<TriangleLanes<T, F>>(paging)),
        triangles_(LargeAllocator<std::uint32_t>(paging)),
        leaves_(LargeAllocator<std::uint32_t>(paging)) {}

  /// `heads`: of the nodes, which the derived class stores.
  void make_room(const Heads<Node>& heads, std::size_t nodes, std::size_t leaves) {
    heads_ = heads, node_spheres_.resize(nodes);
    leaves_.resize(leaves), corners_.resize(leaves), triangles_.resize(leaves * F);
  }

  // Of a tree on demand, what is not made is not written.
  mutable LargeVector<NodeSphere> node_spheres_;
  mutable LargeVector<TriangleLanes<T, F>> corners_;
  mutable LargeVector<std::uint32_t> triangles_;
  mutable LargeVector<std::uint32_t> leaves_;  // the node of each leaf, in the order of corners_
  double reach_ = 0;
  Vec3<double> origin_;
  MeshSphere sphere_;
  SupportMap supports_;

 private:
  Heads<Node> heads_;
};

}  // namespace bvlab
