// SPDX-License-Identifier: BSD-3-Clause
/// A tree of bounding volumes with up to F children per node. Siblings are the lanes of one batched
/// volume, so that one volume is tested against all of them without a gather. The children of a
/// leaf are its triangles: they have volumes of their own, and corners in lanes.
///
/// Nothing in it depends on a body's pose: bodies of one mesh share it.
///
/// A tree is made whole, or on demand. On demand a node is made, which is to say its children and
/// their volumes or a leaf's triangles, when a traversal first opens it (`require`), once, by any
/// thread; its children are what RangeSplits splits its triangles into.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "hierarchies/build/range_splits.hpp"
#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/local_mesh.hpp"
#include "hierarchies/geometry/once.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "hierarchies/wide/fitting.hpp"
#include "hierarchies/wide/lanes.hpp"
#include "hierarchies/wide/wide_tree.hpp"

namespace bvlab {

template <BoundingVolume V, int F>
class WideHierarchy : public WideTree<typename V::scalar, F> {
  using Tree = WideTree<typename V::scalar, F>;
  using Tree::whole, Tree::nothing, Tree::node_spheres_, Tree::corners_, Tree::triangles_,
      Tree::leaves_, Tree::reach_, Tree::origin_, Tree::sphere_, Tree::supports_;

 public:
  using scalar = typename V::scalar;
  using Lane = typename Tree::Lane;
  using Tree::size;

  struct alignas(32) Node : Tree::Node {
    V volume;
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
  static WideHierarchy on_demand(const TriangleMesh& mesh, std::uint32_t leaf_size)
    requires FittedToColumns<V>
  {
    return WideHierarchy(LocalMesh(mesh, LocalMesh::Unused::as_they_are),
                         std::min<std::uint32_t>(leaf_size, F));
  }

 private:
  WideHierarchy(const LocalMesh& local, const WideTopology& topology, Fit fit, Threads& threads) {
    origin_ = local.origin();
    sphere_ = MeshSphere(local.mesh());
    supports_ = SupportMap(local.mesh(), sphere_.centre, threads);
    const TriangleMesh& mesh = local.mesh();
    std::vector<std::uint32_t> leaves;
    for (std::uint32_t i = 0; i < topology.nodes.size(); ++i)
      if (topology.nodes[i].leaf) leaves.push_back(i);
    make_room(topology.nodes.size(), leaves.size());
    std::copy(leaves.begin(), leaves.end(), leaves_.begin());
    const NodeFitting<V> fitting(mesh, topology.primitives, fit, threads);
    std::vector<Reach> reach(threads.count());
    threads.share(leaves_.size(), [&](std::size_t leaf, std::size_t worker) {
      const std::uint32_t i = leaves_[leaf];
      const WideTopology::Node& node = topology.nodes[i];
      reach[worker].add(put_node(i, node, fitting.around(node.begin, node.end), whole));
      nodes_[i].first = static_cast<std::uint32_t>(leaf * F);
      reach[worker].add(
          put_triangles(i, node.count, &topology.primitives[node.first], fitting, node.first));
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
  /// Those that exist: of a tree on demand the root and the children of all nodes that were made.
  std::size_t known() const { return unmade_ ? unmade_->nodes.load() : size(); }
  const Node& node(std::uint32_t i) const { return nodes_[i]; }
  const Siblings& children(std::uint32_t i) const { return siblings_[i]; }
  /// The mesh whose support map is not made, about the origin; null where it is.
  const TriangleMesh* mesh_of_supports() const {
    return unmade_ ? &unmade_->local.mesh() : nullptr;
  }

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
  /// Children of nodes of more triangles are bounded by their boxes alone: 20 ns a triangle, and
  /// 300 with slabs, which for so many save up to a fifth of the tests.
  static constexpr std::uint32_t large = TriangleColumns::large;

  /// What a tree on demand is made of. Threads split ranges that do not overlap.
  struct Unmade {
    LocalMesh local;
    std::uint32_t leaf_size;
    std::optional<RangeSplits> splits;  // once the root is opened
    LargeVector<RangeSplits::Range> ranges{
        LargeAllocator<RangeSplits::Range>(Paging::when_written)};  // of the nodes
    std::atomic<std::uint32_t> nodes = 0, leaves = 0;

    Unmade(LocalMesh&& mesh, std::uint32_t leaf) : local(std::move(mesh)), leaf_size(leaf) {}
  };

  /// On demand.
  WideHierarchy(LocalMesh&& local, std::uint32_t leaf_size)
      : Tree(Paging::when_written),
        nodes_(LargeAllocator<Node>(Paging::when_written)),
        siblings_(LargeAllocator<Siblings>(Paging::when_written)) {
    origin_ = local.origin();
    sphere_ = MeshSphere(local.mesh(), local.box());
    const Eigen::AlignedBox3d box = local.box();
    // Of a box [a, b] within one from -m to m, |a + b| / 2 + |b - a| / 2 is at most the root of
    // |a|^2 + |b|^2, and so of 2 |m|^2. A slab-box is rounded twice, after its box.
    reach_ = std::sqrt(2.0) * stable_norm(box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs())) *
             (1 + 64 * unit_roundoff<scalar>)+std::numeric_limits<scalar>::min();
    unmade_ = std::make_unique<Unmade>(std::move(local), leaf_size);
    const auto triangles = static_cast<std::uint32_t>(unmade_->local.mesh().triangles.size());
    make_room_for(triangles);
    put_unmade(0, {0, triangles}, around({box.min(), box.max()}));
    unmade_->nodes = 1;
  }

  [[gnu::noinline]] void make(std::uint32_t i) const {
    if constexpr (FittedToColumns<V>)
      once(nodes_[i].made, whole, [&] {
        if (!unmade_->splits) unmade_->splits.emplace(unmade_->local.mesh());  // i is the root
        nodes_[i].leaf ? make_leaf(i) : make_children(i);
      });
  }
  void make_leaf(std::uint32_t i) const {
    const auto order = triangles_of(unmade_->ranges[i]);
    Threads alone;
    put_triangles(i, static_cast<std::uint32_t>(order.size()), order.data(),
                  NodeFitting<V>(unmade_->local.mesh(), order, {}, alone), 0);
  }
  void make_children(std::uint32_t i) const {
    Unmade& of = *unmade_;
    const RangeSplits::Range range = of.ranges[i];
    RangeSplits::Parts parts;
    const std::uint32_t count = of.splits->split(range, F, of.leaf_size, parts);
    Threads alone;
    std::optional<NodeFitting<V>> fitting;
    if (range.size() <= large)
      fitting.emplace(of.local.mesh(), triangles_of(range), Fit::published, alone);
    const std::uint32_t first = of.nodes.fetch_add(count);
    for (std::uint32_t k = 0; k < count; ++k) {
      const RangeSplits::Range part = parts[k].range;
      put_unmade(first + k, part,
                 fitting ? fitting->around(part.begin - range.begin, part.end - range.begin)
                         : around(box_of(parts[k].box)));
    }
    nodes_[i].first = first;
    nodes_[i].lanes = all_lanes(count);
    put_children(i, count);
  }
  std::vector<std::uint32_t> triangles_of(const RangeSplits::Range& range) const {
    std::vector<std::uint32_t> triangles(range.size());
    for (std::uint32_t k = 0; k < range.size(); ++k)
      triangles[k] = unmade_->splits->triangle(range.begin + k);
    return triangles;
  }
  void put_unmade(std::uint32_t i, const RangeSplits::Range& range,
                  const std::pair<V, NodeSphere>& around) const {
    unmade_->ranges[i] = range;
    const bool leaf = range.size() <= unmade_->leaf_size;
    put_node(i, {0, leaf ? range.size() : 0, leaf, 0, 0}, around, nothing);
    if (!leaf) return;
    const std::uint32_t slot = unmade_->leaves.fetch_add(1);
    leaves_[slot] = i, nodes_[i].first = slot * F;
  }

  static std::pair<V, NodeSphere> around(const TriangleColumns::Box& box) {
    return {V::columns::around(box), sphere_around(box)};
  }
  static TriangleColumns::Box box_of(const RangeSplits::Box& box) {
    return {Vec3<double>(box.low[0], box.low[1], box.low[2]),
            Vec3<double>(box.high[0], box.high[1], box.high[2])};
  }

  static std::uint16_t all_lanes(std::uint32_t count) {
    return static_cast<std::uint16_t>((1u << count) - 1);
  }

  /// Room for a tree on demand. That of a large mesh is not known before it is made: a leaf may
  /// have one triangle. Its pages cost nothing until they are written. The splits of small meshes
  /// take less time than so many pages.
  void make_room_for(std::uint32_t triangles) {
    std::size_t nodes = 1, leaves = 1;
    if (triangles > RangeSplits::sampled) {
      nodes = 2 * std::size_t{triangles} - 1, leaves = triangles;
    } else if (triangles > unmade_->leaf_size) {
      unmade_->splits.emplace(unmade_->local.mesh());
      std::tie(nodes, leaves) = unmade_->splits->sizes(F, unmade_->leaf_size);
    }
    make_room(nodes, leaves);
    unmade_->ranges.resize(nodes);
  }
  void make_room(std::size_t nodes, std::size_t leaves) {
    nodes_.resize(nodes), siblings_.resize(nodes);
    Tree::make_room(Heads<typename Tree::Node>(nodes_.data()), nodes, leaves);
  }

  /// Returns the volume's reach.
  double put_node(std::size_t i, const WideTopology::Node& node,
                  const std::pair<V, NodeSphere>& around, std::uint32_t made) const {
    assert(node.count <= F);
    const auto& [volume, sphere] = around;
    nodes_[i] = {{size_of(volume), node.first, all_lanes(node.count), node.leaf, made}, volume};
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
  double put_triangles(std::uint32_t i, std::uint32_t count, const std::uint32_t* indices,
                       const NodeFitting<V>& fitting, std::uint32_t at) const {
    const std::uint32_t first = nodes_[i].first;
    for (std::uint32_t lane = 0; lane < F; ++lane)
      triangles_[first + lane] = indices[std::min(lane, count - 1)];
    return fitting.put_each(at, count, siblings_[i], corners_[first / F]);
  }

  // Of a tree on demand, what is not made is not written.
  mutable LargeVector<Node> nodes_;
  mutable LargeVector<Siblings> siblings_;
  std::unique_ptr<Unmade> unmade_;
};

}  // namespace bvlab
