// SPDX-License-Identifier: BSD-3-Clause
/// A tree of bounding volumes with up to four children per node, stored in SIMD lanes in two forms:
/// a row, the four children of a node, for tests against four of another node; and a block of four
/// rows, the sixteen grandchildren, for tests against one volume (see mixed_kernel.hpp). A row is
/// also a part of a block, but lies there in seventeen cache lines (of oriented boxes), where a row
/// alone takes five.
///
/// A leaf holds up to four triangles; in a block its row repeats the leaf itself. Vacant lanes and
/// rows repeat another. Nothing here depends on a body's pose: bodies of one mesh share the tree.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/local_mesh.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "hierarchies/wide/fitting.hpp"
#include "hierarchies/wide/tree_in_blocks.hpp"

namespace bvlab {

template <BoundingVolume V>
class BlockHierarchy : public TreeInBlocks {
 public:
  static_assert(std::is_same_v<typename V::scalar, scalar>);
  static constexpr int fields = sizeof(V) / sizeof(scalar);

  struct alignas(32) Node : TreeInBlocks::Node {
    V volume;
  };
  template <std::size_t width>
  struct alignas(64) Lanes : TreeInBlocks::Lanes<width> {
    std::array<std::array<scalar, width>, fields> volume;
  };
  using Row = Lanes<4>;
  using Block = Lanes<16>;

  BlockHierarchy(const TriangleMesh& mesh, const Topology& binary, Fit fit = Fit::published,
                 std::uint32_t leaf_size = fan_out, Threads&& threads = Threads())
      : BlockHierarchy(mesh, binary, fit, leaf_size, threads) {}
  /// The same on several threads. The result does not depend on their number.
  BlockHierarchy(const TriangleMesh& mesh, const Topology& binary, Fit fit, std::uint32_t leaf_size,
                 Threads& threads)
      : BlockHierarchy(
            mesh, collapsed(mesh, binary, fan_out, std::min<std::uint32_t>(leaf_size, fan_out)),
            fit, threads) {}
  /// From a wide topology of at most four children per node and four triangles per leaf.
  BlockHierarchy(const TriangleMesh& mesh, const WideTopology& topology, Fit fit, Threads& threads)
      : BlockHierarchy(LocalMesh(mesh), topology, fit, threads) {}

 private:
  BlockHierarchy(const LocalMesh& local, const WideTopology& topology, Fit fit, Threads& threads) {
    origin_ = local.origin();
    sphere_ = MeshSphere(local.mesh());
    supports_ = SupportMap(local.mesh(), sphere_.centre, threads);
    const TriangleMesh& mesh = local.mesh();
    nodes_.resize(topology.nodes.size()), node_spheres_.resize(topology.nodes.size());
    node_heads_ = Heads<TreeInBlocks::Node>(nodes_.data());
    const OrderedTriangles triangles(mesh, topology.primitives, threads);
    std::vector<Reach> reach(threads.count());
    threads.share(nodes_.size(), [&](std::size_t i, std::size_t worker) {
      const auto& node = topology.nodes[i];
      assert(node.count <= fan_out);
      const auto [volume, sphere] = triangles.template around<V>(node.begin, node.end, fit);
      const auto children = static_cast<std::uint8_t>((1u << node.count) - 1);
      nodes_[i] = {{size_of(volume), 0, 0, children, node.leaf}, volume};
      node_spheres_[i] = sphere;
      reach[worker].add(volume);
    });
    put_in_blocks(topology);
    keep_triangles(mesh, topology);
    reach_ = reach_of_all<scalar>(mesh, reach);
  }

 public:
  const Node& node(std::uint32_t i) const { return nodes_[i]; }
  const Row& row(std::uint32_t first) const { return rows_[first]; }
  const Block& block(std::uint32_t first) const { return blocks_[first]; }
  const Row& root_alone() const { return rows_.back(); }

 private:
  /// Fills a row and a block for each inner node, and the row for the root.
  void put_in_blocks(const WideTopology& topology) {
    for (Node& node : nodes_)
      if (!node.leaf) node.first = inner_++;
    rows_.resize(inner_ + 1), blocks_.resize(inner_);
    row_heads_ = Heads<TreeInBlocks::Row>(rows_.data());
    block_heads_ = Heads<TreeInBlocks::Block>(blocks_.data());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      Node& node = nodes_[i];
      if (node.leaf) continue;
      const auto& [first, count, leaf, begin, end] = topology.nodes[i];
      put_children(rows_[node.first], 0, static_cast<std::uint32_t>(i), topology);
      for (std::uint32_t row = 0; row < 4; ++row) {
        const std::uint32_t child = first + std::min(row, count - 1);
        put_children(blocks_[node.first], 4 * row, child, topology);
        if (row >= count) continue;
        const unsigned held = nodes_[child].leaf ? 1u : nodes_[child].children;
        node.grandchildren = static_cast<std::uint16_t>(node.grandchildren | held << 4 * row);
      }
    }
    put_children(rows_.back(), 0, 0, topology);
  }
  /// Fills four lanes with the children of a node, or with the leaf itself.
  template <class To>
  void put_children(To& to, std::size_t lane, std::uint32_t i, const WideTopology& topology) {
    const auto& [first, count, leaf, begin, end] = topology.nodes[i];
    for (std::uint32_t k = 0; k < 4; ++k, ++lane) {
      const std::uint32_t child = leaf ? i : first + std::min(k, count - 1);
      for (std::size_t field = 0; field < fields; ++field)
        std::memcpy(&to.volume[field][lane],
                    reinterpret_cast<const char*>(&nodes_[child].volume) + sizeof(scalar) * field,
                    sizeof(scalar));
      to.size[lane] = nodes_[child].size;
      to.name[lane] = child | (nodes_[child].leaf ? leaf_flag : 0);
    }
  }

  void keep_triangles(const TriangleMesh& mesh, const WideTopology& topology) {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const auto& node = topology.nodes[i];
      if (!node.leaf) continue;
      nodes_[i].first = static_cast<std::uint32_t>(triangles_.size());
      TriangleLanes<scalar, 4>& lanes = corners_.emplace_back();
      for (std::uint32_t k = 0; k < 4; ++k) {
        triangles_.push_back(topology.primitives[node.first + std::min(k, node.count - 1)]);
        lanes.put(k, mesh.corners(triangles_.back()));
      }
    }
  }

  LargeVector<Node> nodes_;
  LargeVector<Row> rows_;
  LargeVector<Block> blocks_;
};

}  // namespace bvlab
