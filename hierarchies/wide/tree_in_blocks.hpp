// SPDX-License-Identifier: BSD-3-Clause
/// What a block hierarchy is apart from its volumes: nodes with up to four children, the names of
/// children and grandchildren in lanes, spheres around nodes, and the triangles of leaves in lanes.
/// BlockHierarchy, which is derived from it, has the volumes. Loops that do not know their type see
/// a tree as this (any_volume.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/wide/heads.hpp"
#include "hierarchies/wide/lane_tree.hpp"
#include "hierarchies/wide/triangle_lanes.hpp"

namespace bvlab {

struct BlockCalls;

class TreeInBlocks : public LaneTree {
 public:
  using scalar = float;  // a lane holds a number and a node alike
  static constexpr int fan_out = 4;

  /// The word that names a node in a lane: its index, and a flag for leaves.
  static constexpr std::uint32_t leaf_flag = 0x80000000u;
  static constexpr std::uint32_t number_of(std::uint32_t name) { return name & ~leaf_flag; }

  /// Its volume follows.
  struct Node {
    float size;
    std::uint32_t first;          ///< the index of its row and block; leaf: of its first triangle
    std::uint16_t grandchildren;  ///< which lanes of its block are in use
    std::uint8_t children;        ///< which lanes of its row hold a child; leaf: of its triangles
    std::uint8_t leaf;            ///< 0 or 1
  };
  /// The sizes and names of nodes in lanes. Their volumes follow.
  template <std::size_t width>
  struct Lanes {
    std::array<float, width> size;
    std::array<std::uint32_t, width> name;
  };
  using Row = Lanes<4>;
  using Block = Lanes<16>;

  const Node& node(std::uint32_t i) const { return node_heads_[i]; }
  /// The number of rows, that for the root included.
  std::size_t rows() const { return inner_ + 1; }
  /// The row of an inner node, by its `first`.
  const Row& row(std::uint32_t first) const { return row_heads_[first]; }
  const Block& block(std::uint32_t first) const { return block_heads_[first]; }
  /// The row for a root that is a leaf.
  const Row& root_alone() const { return row_heads_[inner_]; }
  /// The corners of a leaf, by its `first`.
  const TriangleLanes<float, 4>& corners(std::uint32_t first) const {
    return corners_[first / fan_out];
  }
  std::uint32_t root() const { return node(0).leaf ? leaf_flag : 0; }

  /// The tests of its volumes, for loops that do not know their type; null where nobody has set
  /// them (calls_of.hpp).
  const BlockCalls* calls = nullptr;

 protected:
  TreeInBlocks() = default;

  // Of what the derived class stores.
  Heads<Node> node_heads_;
  Heads<Row> row_heads_;
  Heads<Block> block_heads_;
  std::uint32_t inner_ = 0;  // nodes that are no leaves
  LargeVector<TriangleLanes<float, 4>> corners_;
};

}  // namespace bvlab
