// SPDX-License-Identifier: BSD-3-Clause
/// A tree of bounding volumes with up to F children per node. Siblings are the lanes of one batched
/// volume, so that one volume is tested against all of them without a gather. The children of a
/// leaf are its triangles: they have volumes of their own, and corners in lanes.
///
/// Nothing in it depends on a body's pose: bodies of one mesh share it.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <vector>

#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/local_mesh.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "hierarchies/wide/fitting.hpp"
#include "hierarchies/wide/lanes.hpp"
#include "hierarchies/wide/support_map.hpp"
#include "hierarchies/wide/triangle_lanes.hpp"

namespace bvlab {

/// The fan-out of trees where none is asked for: as many children as a register has lanes. A wider
/// node would be tested in several steps; none is narrower than two.
template <class T>
inline constexpr int native_fan_out = std::clamp(native_width<T>, 2, 16);

template <BoundingVolume V, int F>
class WideHierarchy {
  static_assert(F == 2 || F == 4 || F == 8 || F == 16);

 public:
  using scalar = typename V::scalar;
  using Lane = Batch<scalar, F>;
  static constexpr int fan_out = F;

  /// The data of a node that are read before it is tested or opened.
  struct alignas(32) Node {
    V volume;
    scalar size;
    std::uint32_t first;  ///< of its children; leaf: of its triangles, see triangle()
    std::uint16_t lanes;  ///< which of its lanes hold a child
    std::uint16_t leaf;   ///< 0 or 1
  };

  /// The children of a node, one per lane.
  struct Siblings {
    Over<V, Lane> volumes;
    Lane size;
  };

  WideHierarchy(const TriangleMesh& mesh, const Topology& binary, Fit fit = Fit::published,
                std::uint32_t leaf_size = F, Threads&& threads = Threads())
      : WideHierarchy(mesh, binary, fit, leaf_size, threads) {}
  /// The same on several threads. The result does not depend on their number.
  WideHierarchy(const TriangleMesh& mesh, const Topology& binary, Fit fit, std::uint32_t leaf_size,
                Threads& threads)
      : WideHierarchy(mesh, collapsed(mesh, binary, F, std::min<std::uint32_t>(leaf_size, F)), fit,
                      threads) {}

  /// From a wide topology, whose leaves hold at most F triangles each.
  WideHierarchy(const TriangleMesh& mesh, const WideTopology& topology, Fit fit,
                Threads&& threads = Threads())
      : WideHierarchy(mesh, topology, fit, threads) {}
  WideHierarchy(const TriangleMesh& mesh, const WideTopology& topology, Fit fit, Threads& threads)
      : WideHierarchy(LocalMesh(mesh), topology, fit, threads) {}

 private:
  WideHierarchy(const LocalMesh& local, const WideTopology& topology, Fit fit, Threads& threads)
      : origin_(local.origin()),
        sphere_(local.mesh()),
        supports_(local.mesh(), sphere_.centre, threads) {
    const TriangleMesh& mesh = local.mesh();
    nodes_.resize(topology.nodes.size());
    node_spheres_.resize(topology.nodes.size());
    siblings_.resize(topology.nodes.size());
    const NodeFitting<V> fitting(mesh, topology, fit, threads);
    std::vector<Reach> reach(threads.count());
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (topology.nodes[i].leaf) leaves_.push_back(static_cast<std::uint32_t>(i));
    corners_.resize(leaves_.size());
    triangles_.resize(leaves_.size() * F);
    threads.share(leaves_.size(), [&](std::size_t leaf, std::size_t worker) {
      put_node(leaves_[leaf], topology, fitting, reach[worker]);
      put_triangles(leaf, topology, fitting, reach[worker]);
    });
    threads.share(nodes_.size(), [&](std::size_t i, std::size_t worker) {
      if (!topology.nodes[i].leaf) put_node(i, topology, fitting, reach[worker]);
    });
    threads.share_out(nodes_.size(), 8, [&](std::size_t begin, std::size_t end, std::size_t) {
      for (std::size_t i = begin; i < end; ++i)
        if (!topology.nodes[i].leaf) put_children(i, topology.nodes[i].count);
    });
    reach_ = reach_of_all<scalar>(mesh, reach);
  }

 public:
  std::size_t size() const { return nodes_.size(); }
  const Node& node(std::uint32_t i) const { return nodes_[i]; }
  const NodeSphere& node_sphere(std::uint32_t i) const { return node_spheres_[i]; }
  const Siblings& children(std::uint32_t i) const { return siblings_[i]; }
  /// The corners of a leaf, by its `first`.
  const TriangleLanes<scalar, F>& corners(std::uint32_t first) const { return corners_[first / F]; }
  /// The leaf that holds triangle k.
  std::uint32_t leaf_of(std::uint32_t k) const { return leaves_[k / F]; }
  /// The mesh's index of the triangle in lane `k - first` of a leaf.
  std::uint32_t triangle(std::uint32_t k) const { return triangles_[k]; }
  /// The origin of the mesh (LocalMesh), in its frame: all else is relative to it.
  const Vec3<double>& origin() const { return origin_; }
  /// An upper bound on the distance of vertices and volumes from the origin.
  double reach() const { return reach_; }

  const MeshSphere& sphere() const { return sphere_; }
  /// The support map about the sphere's centre.
  const SupportMap& supports() const { return supports_; }

 private:
  void put_node(std::size_t i, const WideTopology& topology, const NodeFitting<V>& fitting,
                Reach& reach) {
    const auto& node = topology.nodes[i];
    assert(node.count <= F);
    const auto [volume, sphere] = fitting.around(node.begin, node.end);
    reach.add(volume);
    const auto lanes = static_cast<std::uint16_t>((1u << node.count) - 1);
    nodes_[i] = {volume, size_of(volume), node.first, lanes, node.leaf};
    node_spheres_[i] = sphere;
  }

  /// Fills the lanes of an inner node. All nodes must have their volumes already.
  void put_children(std::size_t i, std::uint32_t count) {
    for (int lane = 0; lane < F; ++lane) {
      // Vacant lanes repeat the last child.
      const Node& child =
          nodes_[nodes_[i].first + std::min(static_cast<std::uint32_t>(lane), count - 1)];
      put_lane(siblings_[i].volumes, lane, child.volume);
      siblings_[i].size[lane] = child.size;
    }
  }

  /// Fills the lanes of a leaf.
  void put_triangles(std::size_t leaf, const WideTopology& topology, const NodeFitting<V>& fitting,
                     Reach& reach) {
    const std::uint32_t i = leaves_[leaf];
    const WideTopology::Node& node = topology.nodes[i];
    nodes_[i].first = static_cast<std::uint32_t>(leaf * F);
    for (std::uint32_t lane = 0; lane < F; ++lane)
      triangles_[leaf * F + lane] =
          topology.primitives[node.first + std::min(lane, node.count - 1)];
    reach.add(fitting.put_each(node.first, node.count, siblings_[i], corners_[leaf]));
  }

  LargeVector<Node> nodes_;
  LargeVector<NodeSphere> node_spheres_;
  LargeVector<Siblings> siblings_;
  LargeVector<TriangleLanes<scalar, F>> corners_;
  LargeVector<std::uint32_t> triangles_;
  std::vector<std::uint32_t> leaves_;  // the node of each leaf, in the order of corners_
  double reach_ = 0;
  Vec3<double> origin_;
  MeshSphere sphere_;
  SupportMap supports_;
};

}  // namespace bvlab
