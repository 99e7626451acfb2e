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
#include "hierarchies/wide/heads.hpp"
#include "hierarchies/wide/lane_tree.hpp"
#include "hierarchies/wide/triangle_lanes.hpp"

namespace bvlab {

/// The fan-out of trees where none is asked for: as many children as a register has lanes. A wider
/// node would be tested in several steps; none is narrower than two.
template <class T>
inline constexpr int native_fan_out = std::clamp(native_width<T>, 2, 16);

template <int F>
struct SiblingCalls;

template <class T, int F>
class WideTree : public LaneTree {
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

  const Node& node(std::uint32_t i) const { return heads_[i]; }
  /// The corners of a leaf, by its `first`.
  const TriangleLanes<T, F>& corners(std::uint32_t first) const { return corners_[first / F]; }
  /// The leaf that holds triangle k.
  std::uint32_t leaf_of(std::uint32_t k) const { return leaves_[k / F]; }
  /// Trees that are made on demand have another of this name.
  static void require(std::uint32_t) {}

  /// The tests of its volumes, for loops that do not know their type; null where nobody has set
  /// them (calls_of.hpp).
  const SiblingCalls<F>* calls = nullptr;

 protected:
  static constexpr std::uint32_t whole = 1, nothing = 0;

  WideTree() = default;
  /// `paging`: of arrays.
  explicit WideTree(Paging paging)
      : LaneTree(paging),
        corners_(LargeAllocator<TriangleLanes<T, F>>(paging)),
        leaves_(LargeAllocator<std::uint32_t>(paging)) {}

  /// `heads`: of the nodes, which the derived class stores.
  void make_room(const Heads<Node>& heads, std::size_t nodes, std::size_t leaves) {
    heads_ = heads, node_spheres_.resize(nodes);
    leaves_.resize(leaves), corners_.resize(leaves), triangles_.resize(leaves * F);
  }

  // Of a tree on demand, what is not made is not written.
  mutable LargeVector<TriangleLanes<T, F>> corners_;
  mutable LargeVector<std::uint32_t> leaves_;  // the node of each leaf, in the order of corners_

 private:
  Heads<Node> heads_;
};

}  // namespace bvlab
