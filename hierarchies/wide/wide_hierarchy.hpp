// SPDX-License-Identifier: BSD-3-Clause
/// A tree of bounding volumes with up to F children per node. Siblings are the lanes of one batched
/// volume, so that one volume is tested against all of them without a gather. The children of a
/// leaf are its triangles: they have volumes of their own, and corners in lanes.
///
/// Nothing in it depends on a body's pose: bodies of one mesh share it.
///
/// A tree is made whole, or on demand. On demand its topology is that of MortonOrder, O(n), and a
/// node is made, which is to say the volumes of its children or a leaf's triangles, when a
/// traversal first opens it (`require`), once, by any thread.
#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "hierarchies/build/morton_order.hpp"
#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/local_mesh.hpp"
#include "hierarchies/geometry/once.hpp"
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
    std::uint32_t made;   ///< `whole` once its children are, else see once.hpp
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

  /// A tree that is made on demand, of a volume that is a box in the mesh's own frame: its reach is
  /// bounded beforehand. `mesh` must outlive it.
  static WideHierarchy on_demand(const TriangleMesh& mesh, std::uint32_t leaf_size,
                                 Threads& threads)
    requires FittedToColumns<V>
  {
    return WideHierarchy(LocalMesh(mesh), std::min<std::uint32_t>(leaf_size, F), threads);
  }

 private:
  WideHierarchy(const LocalMesh& local, const WideTopology& topology, Fit fit, Threads& threads)
      : origin_(local.origin()),
        sphere_(local.mesh()),
        supports_(local.mesh(), sphere_.centre, threads) {
    const TriangleMesh& mesh = local.mesh();
    make_room(topology);
    const NodeFitting<V> fitting(mesh, topology.primitives, fit, threads);
    std::vector<Reach> reach(threads.count());
    threads.share(leaves_.size(), [&](std::size_t leaf, std::size_t worker) {
      const std::uint32_t i = leaves_[leaf];
      const WideTopology::Node& node = topology.nodes[i];
      reach[worker].add(put_node(i, node, fitting.around(node.begin, node.end), whole));
      nodes_[i].first = static_cast<std::uint32_t>(leaf * F);
      reach[worker].add(
          put_triangles(i, node, &topology.primitives[node.first], fitting, node.first));
    });
    threads.share(nodes_.size(), [&](std::size_t i, std::size_t worker) {
      const WideTopology::Node& node = topology.nodes[i];
      if (!node.leaf)
        reach[worker].add(put_node(i, node, fitting.around(node.begin, node.end), whole));
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

  /// To be called before children(i) or the corners of leaf i are read: makes them unless that has
  /// been done. Any thread may call it. If it throws, for want of memory, they are not made.
  [[gnu::always_inline]] void require(std::uint32_t i) const {
    if (!is_done(nodes_[i].made, whole)) [[unlikely]]
      make(i);
  }
  /// The number of nodes that have been made, while no traversal runs.
  std::size_t made() const {
    if (!unmade_) return size();
    std::size_t count = 0;
    for (std::vector<std::uint32_t> open{0}; !open.empty();) {
      const Node& node = nodes_[open.back()];
      open.pop_back();
      if (!is_done(node.made, whole)) continue;
      ++count;
      for (int lane = 0; !node.leaf && node.lanes >> lane & 1; ++lane)
        open.push_back(node.first + static_cast<std::uint32_t>(lane));
    }
    return count;
  }

 private:
  static constexpr std::uint32_t whole = 1, nothing = 0;
  /// Children of nodes of more triangles are bounded by their boxes alone: 20 ns a triangle, and
  /// 300 with slabs, which for so many save up to a fifth of the tests.
  static constexpr std::uint32_t large = TriangleColumns::large;

  /// What a tree on demand is made of.
  struct Unmade {
    LocalMesh local;
    WideTopology topology;
  };

  /// On demand.
  WideHierarchy(LocalMesh&& local, std::uint32_t leaf_size, Threads& threads)
      : nodes_(LargeAllocator<Node>(Paging::when_written)),
        node_spheres_(LargeAllocator<NodeSphere>(Paging::when_written)),
        siblings_(LargeAllocator<Siblings>(Paging::when_written)),
        corners_(LargeAllocator<TriangleLanes<scalar, F>>(Paging::when_written)),
        triangles_(LargeAllocator<std::uint32_t>(Paging::when_written)),
        origin_(local.origin()),
        sphere_(local.mesh(), local.box()),
        supports_(local.mesh(), sphere_.centre, threads) {
    const Eigen::AlignedBox3d box = local.box();
    // Of a box [a, b] within one from -m to m, |a + b| / 2 + |b - a| / 2 is at most the root of
    // |a|^2 + |b|^2, and so of 2 |m|^2. A slab-box is rounded twice.
    reach_ = std::sqrt(2.0) * stable_norm(box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs())) *
             (1 + 64 * unit_roundoff<scalar>)+std::numeric_limits<scalar>::min();
    WideTopology topology = MortonOrder(local.mesh(), box, threads).wide(F, leaf_size);
    make_room(topology);
    put_node(0, topology.nodes[0], around({box.min(), box.max()}), nothing);
    unmade_ = std::make_shared<const Unmade>(Unmade{std::move(local), std::move(topology)});
    nodes_[0].first = first_of(0);
  }

  [[gnu::noinline]] void make(std::uint32_t i) const {
    if constexpr (FittedToColumns<V>) once(nodes_[i].made, whole, [&] { make_children(i); });
  }
  void make_children(std::uint32_t i) const {
    const auto& [local, topology] = *unmade_;
    const WideTopology::Node& node = topology.nodes[i];
    const auto order = std::span(topology.primitives).subspan(node.begin, node.end - node.begin);
    Threads alone;
    if (node.leaf) {
      put_triangles(i, node, order.data(), NodeFitting<V>(local.mesh(), order, {}, alone), 0);
      return;
    }
    std::optional<NodeFitting<V>> fitting;
    if (order.size() <= large) fitting.emplace(local.mesh(), order, Fit::published, alone);
    for (std::uint32_t child = node.first; child < node.first + node.count; ++child) {
      const WideTopology::Node& of = topology.nodes[child];
      const std::uint32_t begin = of.begin - node.begin, end = of.end - node.begin;
      put_node(child, of,
               fitting ? fitting->around(begin, end)
                       : around(box_of(local.mesh(), order.subspan(begin, end - begin))),
               nothing);
      nodes_[child].first = first_of(child);
    }
    put_children(i, node.count);
  }

  static std::pair<V, NodeSphere> around(const TriangleColumns::Box& box) {
    return {V::columns::around(box), sphere_around(box)};
  }
  static TriangleColumns::Box box_of(const TriangleMesh& mesh,
                                     std::span<const std::uint32_t> triangles) {
    TriangleColumns::Box box;
    for (const std::uint32_t triangle : triangles)
      for (const std::uint32_t v : mesh.triangles[triangle])
        box.low = box.low.cwiseMin(mesh.vertices[v]),
        box.high = box.high.cwiseMax(mesh.vertices[v]);
    return box;
  }

  /// As in Node. All leaves of a tree on demand are at its end.
  std::uint32_t first_of(std::uint32_t i) const {
    const WideTopology::Node& node = unmade_->topology.nodes[i];
    return node.leaf ? (i - leaves_[0]) * F : node.first;
  }

  void make_room(const WideTopology& topology) {
    nodes_.resize(topology.nodes.size());
    node_spheres_.resize(topology.nodes.size());
    siblings_.resize(topology.nodes.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (topology.nodes[i].leaf) leaves_.push_back(static_cast<std::uint32_t>(i));
    corners_.resize(leaves_.size());
    triangles_.resize(leaves_.size() * F);
  }

  /// Returns the volume's reach.
  double put_node(std::size_t i, const WideTopology::Node& node,
                  const std::pair<V, NodeSphere>& around, std::uint32_t made) const {
    assert(node.count <= F);
    const auto& [volume, sphere] = around;
    const auto lanes = static_cast<std::uint16_t>((1u << node.count) - 1);
    nodes_[i] = {volume, size_of(volume), node.first, lanes, node.leaf, made};
    node_spheres_[i] = sphere;
    return static_cast<double>(reach_of(volume));
  }

  /// Fills the lanes of an inner node. All its children must have their volumes already.
  void put_children(std::size_t i, std::uint32_t count) const {
    for (int lane = 0; lane < F; ++lane) {
      // Vacant lanes repeat the last child.
      const Node& child =
          nodes_[nodes_[i].first + std::min(static_cast<std::uint32_t>(lane), count - 1)];
      put_lane(siblings_[i].volumes, lane, child.volume);
      siblings_[i].size[lane] = child.size;
    }
  }

  /// Fills the lanes of leaf i, whose first triangle is number `at` of those that are fitted, and
  /// returns their reach.
  double put_triangles(std::uint32_t i, const WideTopology::Node& node,
                       const std::uint32_t* indices, const NodeFitting<V>& fitting,
                       std::uint32_t at) const {
    const std::uint32_t first = nodes_[i].first;
    for (std::uint32_t lane = 0; lane < F; ++lane)
      triangles_[first + lane] = indices[std::min(lane, node.count - 1)];
    return fitting.put_each(at, node.count, siblings_[i], corners_[first / F]);
  }

  // Of a tree on demand, what is not made is not written.
  mutable LargeVector<Node> nodes_;
  mutable LargeVector<NodeSphere> node_spheres_;
  mutable LargeVector<Siblings> siblings_;
  mutable LargeVector<TriangleLanes<scalar, F>> corners_;
  mutable LargeVector<std::uint32_t> triangles_;
  std::vector<std::uint32_t> leaves_;  // the node of each leaf, in the order of corners_
  double reach_ = 0;
  Vec3<double> origin_;
  MeshSphere sphere_;
  SupportMap supports_;
  std::shared_ptr<const Unmade> unmade_;
};

}  // namespace bvlab
