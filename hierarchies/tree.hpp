// SPDX-License-Identifier: BSD-3-Clause
/// What a hierarchy (hierarchy.hpp) is apart from its volumes: the nodes of a tree, binary or with
/// up to sixteen children per node, the triangles below them, and spheres around these. Traversals
/// by the gathered kernel see no more of it, so that they are compiled once for all volumes.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <limits>
#include <vector>

#include "hierarchies/build/topology.hpp"
#include "hierarchies/hierarchy_extent.hpp"
#include "hierarchies/node_sphere.hpp"

namespace bvlab {

class Tree {
 public:
  struct Node {
    std::uint32_t first;     ///< inner: the first of adjacent children; leaf: of its primitives
    std::uint32_t count;     ///< number of primitives of a leaf; 0 for an inner node
    std::uint32_t children;  ///< number of children, 2 to 16; 0 for a leaf
    std::uint32_t group;     ///< the index of the children's group, see group()
    float size;              ///< of its volume: the larger of a pair is descended
  };

  std::size_t size() const { return nodes_.size(); }
  bool is_leaf(std::uint32_t node) const { return nodes_[node].count > 0; }
  const Node& node(std::uint32_t node) const { return nodes_[node]; }
  /// The largest number of children of a node, at least 2.
  std::uint32_t fan_out() const { return fan_out_; }
  /// The index of a node's group of siblings, below `sibling_groups()`; the root's is 0.
  std::uint32_t group(std::uint32_t node) const { return SiblingGroups(*this)(node); }
  /// The same as a function object, for use in loops; valid as long as the tree.
  class SiblingGroups {
   public:
    explicit SiblingGroups(const Tree& tree)
        : groups_(tree.groups_.empty() ? nullptr : tree.groups_.data()) {}
    std::uint32_t operator()(std::uint32_t node) const {
      return groups_ ? groups_[node] : (node + 1) / 2;
    }

   private:
    const std::uint32_t* groups_;
  };
  std::size_t sibling_groups() const { return above_.size(); }
  /// What siblings have in common.
  struct Above {
    std::uint32_t parent;
    std::uint32_t first, count;  ///< the siblings
    /// The smallest size among the parent and its ancestors. In a pair of nodes, the one for which
    /// this is smaller has the parent that was descended last; node b where they are equal.
    float least;
  };
  const Above& above(std::uint32_t node) const { return above_[group(node)]; }
  const Above& above_group(std::uint32_t group) const { return above_[group]; }
  /// A sphere around the triangles below each node.
  const NodeSphere* node_spheres() const { return spheres_.data(); }
  /// The mesh's triangle at an index in a leaf's range of primitives.
  std::uint32_t primitive(std::uint32_t index) const { return primitives_[index]; }
  std::size_t primitives() const { return primitives_.size(); }
  const HierarchyExtent& extent() const { return extent_; }

 protected:
  template <class AnyTopology>
  explicit Tree(const AnyTopology& topology)
      : primitives_(topology.primitives), spheres_(topology.nodes.size()) {
    take_nodes(topology);
    number_siblings();
  }

  /// Computes `above_`, parents first.
  void look_up() {
    above_[0] = {0, 0, 1, std::numeric_limits<float>::infinity()};
    for (std::uint32_t i = 0; i < nodes_.size(); ++i)
      if (const Node& node = nodes_[i]; node.count == 0)
        above_[node.group] = {i, node.first, node.children,
                              std::min(above_[group(i)].least, node.size)};
  }

  std::vector<std::uint32_t> primitives_;
  std::vector<Node> nodes_;
  std::vector<NodeSphere> spheres_;
  HierarchyExtent extent_;
  std::vector<std::uint32_t> begin_, end_;  // only while fitting

 private:
  void take_nodes(const Topology& topology) {
    nodes_.reserve(topology.nodes.size());
    for (const auto& [first, count] : topology.nodes)
      nodes_.push_back({first, count, count ? 0u : 2u, 0, 0});
    ranges_of(topology);
  }
  void take_nodes(const WideTopology& topology) {
    for (const auto& node : topology.nodes) {
      assert(node.leaf || (node.count >= 2 && node.count <= 16));
      nodes_.push_back({node.first, node.leaf ? node.count : 0, node.leaf ? 0 : node.count, 0, 0});
      begin_.push_back(node.begin), end_.push_back(node.end);
      if (!node.leaf) fan_out_ = std::max(fan_out_, node.count);
    }
  }

  /// Numbers the groups of siblings. In a binary tree siblings are nodes 2k - 1 and 2k.
  void number_siblings() {
    std::uint32_t groups = 1;
    bool binary = true;
    for (const Node& node : nodes_)
      if (node.children > 0) ++groups, binary = binary && node.children == 2 && node.first % 2 == 1;
    above_.resize(groups);
    if (!binary) groups_.assign(nodes_.size(), 0);
    groups = 0;
    for (Node& node : nodes_)
      if (node.children > 0) {
        node.group = binary ? (node.first + 1) / 2 : ++groups;
        if (!binary) std::fill_n(groups_.begin() + node.first, node.children, node.group);
      }
  }

  /// The range of primitives below each node. Children come after their parent in the topology.
  void ranges_of(const Topology& topology) {
    begin_.resize(nodes_.size()), end_.resize(nodes_.size());
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      const auto& [first, count] = topology.nodes[i];
      begin_[i] = count ? first : std::min(begin_[first], begin_[first + 1]);
      end_[i] = count ? first + count : std::max(end_[first], end_[first + 1]);
    }
  }

  std::vector<Above> above_;           // one for each group of siblings
  std::vector<std::uint32_t> groups_;  // of each node; empty in a binary tree
  std::uint32_t fan_out_ = 2;
};

}  // namespace bvlab
