// SPDX-License-Identifier: BSD-3-Clause
/// Runs the first phase of the triangle test of contact queries (contact_batch.hpp) on the pairs of
/// leaves that the steps of a kernel have found near.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "hierarchies/wide/lanes.hpp"
#include "hierarchies/wide/triangle_lanes.hpp"
#include "traversal/wide/contact_batch.hpp"
#include "traversal/wide/sixteen_lanes.hpp"
#include "traversal/wide/work_queue.hpp"

namespace bvlab {

/// A direct-mapped cache of leaves of body a, transformed into the frame of b. A leaf has the
/// number of its first triangle.
template <class Tree, std::size_t slots>
class TransformedLeaves {
  static constexpr int F = Tree::fan_out;

 public:
  void begin() { held_.fill(none); }
  bool has(std::uint32_t leaf) const { return held_[slot_of(leaf)] == leaf; }
  [[gnu::always_inline]] const TransformedLeaf<F>& of(const Tree& tree, std::uint32_t leaf,
                                                      const CornerTransform& transform) {
    const std::size_t slot = slot_of(leaf);
    if (std::exchange(held_[slot], leaf) != leaf)
      leaves_[slot].transform_all(tree.corners(leaf), transform);
    return leaves_[slot];
  }

 private:
  static std::size_t slot_of(std::uint32_t leaf) { return leaf / F % slots; }
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  std::array<std::uint32_t, slots> held_;
  std::array<TransformedLeaf<F>, slots> leaves_;
};

/// Triangles of a against all triangles of a leaf of b. Tree is a WideTree.
template <class Tree>
class SiblingsSieve {
  static constexpr int F = Tree::fan_out;
  using S = typename Tree::Lane;
  using Trees = std::array<const Tree*, 2>;

 public:
  void begin() { leaves_.begin(); }

  /// The triangles of the leaf of a whose first one has the number `first`.
  [[gnu::always_inline]] const TransformedLeaf<F>& leaf_of_a(const Trees& trees,
                                                             const CornerTransform& a_to_b,
                                                             std::uint32_t first) {
    return leaves_.of(*trees[0], first, a_to_b);
  }

  /// Tests and takes the last pairs of the queue that have one leaf of b, until the batch is full.
  template <class Counter>
  [[gnu::noinline]] void sift(const Trees& trees, const CornerTransform& a_to_b,
                              WorkQueue& triangles, ContactBatch& batch, Counter& counter) {
    const std::uint32_t b = triangles.last().b;
    trees[1]->require(b);
    const auto& leaf = trees[1]->node(b);
    const auto& others = trees[1]->corners(leaf.first);
    const Corners<S> corner = corners_in_lanes<S>(others);
    const TriangleBoxes<S> boxes(corner);
    do {
      const std::uint32_t a = triangles.take_last().a, lane = a % F;
      counter.primitives(static_cast<std::uint64_t>(std::popcount(leaf.lanes)));
      const auto& own = leaf_of_a(trees, a_to_b, a - lane);
      const std::uint64_t near = leaf.lanes & own.near(lane, corner, boxes);
      if (near) batch.add(near, own.corners(), lane, a - lane, others, leaf.first);
    } while (!batch.full() && !triangles.empty() && triangles.last().b == b);
  }

 private:
  TransformedLeaves<Tree, 1> leaves_;
};

/// Up to four triangles of a leaf of a against up to four of a leaf of b. Tree is a TreeInBlocks.
template <class Tree>
class BlocksSieve {
  using S = SixteenLanes;
  using Trees = std::array<const Tree*, 2>;

 public:
  void begin() { leaves_.begin(); }

  template <class Counter>
  [[gnu::noinline]] void sift(const Trees& trees, const CornerTransform& a_to_b,
                              WorkQueue& triangles, ContactBatch& batch, Counter& counter) {
    // Whether a pair has near triangles is hardly predictable: those that have are added together.
    std::array<Near, 4> found;
    std::size_t count = 0;
    const auto add = [&]() __attribute__((always_inline)) {
      for (const Near& each : std::span(found).first(std::exchange(count, 0)))
        batch.add(each.lanes, each.a->corners(), each.first_a, *each.b, each.first_b);
    };
    do {
      const NodePair pair = triangles.take_last();
      const auto &a = trees[0]->node(Tree::number_of(pair.a)),
                 &b = trees[1]->node(Tree::number_of(pair.b));
      const std::uint64_t lanes = four_by_four(a.children, b.children);
      counter.primitives(static_cast<std::uint64_t>(std::popcount(lanes)));
      if (!leaves_.has(a.first)) add();  // whatever has the corners of the leaf that is replaced
      const TransformedLeaf<4>& own = leaves_.of(*trees[0], a.first, a_to_b);
      const auto& others = trees[1]->corners(b.first);
      const std::uint64_t near = lanes & near_of(own, others);
      found[count] = {near, &own, &others, a.first, b.first};
      count += near != 0;
      if (count == found.size()) add();
    } while (!batch.full() && !triangles.empty());
    add();
  }

 private:
  using Four = CornerTransform::Four;
  /// Lanes of two leaves whose triangles are near.
  struct Near {
    std::uint64_t lanes;
    const TransformedLeaf<4>* a;
    const TriangleLanes<float, 4>* b;
    std::uint32_t first_a, first_b;
  };

  /// As TransformedLeaf::near, for all four of a: lane 4 i + j is of triangle i of a and j of b.
  [[gnu::always_inline]] static std::uint64_t near_of(const TransformedLeaf<4>& leaf_of_a,
                                                      const TriangleLanes<float, 4>& others) {
    const TriangleBoxes<Four> boxes(corners_in_lanes<Four>(others));
    alignas(16) std::array<std::array<float, 4>, 3> low, high;
    for (std::size_t k = 0; k < 3; ++k) {
      boxes.low[k].copy_to(low[k].data(), stdx::vector_aligned);
      boxes.high[k].copy_to(high[k].data(), stdx::vector_aligned);
    }
    std::uint64_t apart = 0;
    for (std::size_t part = 0; part < 16 / S::size(); ++part) {
      Mask<S> found = beyond_plane(leaf_of_a, others, part);
      for (std::size_t k = 0; k < 3; ++k)
        found =
            found |
            (four_repeated(low[k].data(), part) > each_of_four(leaf_of_a.high()[k].data(), part)) |
            (four_repeated(high[k].data(), part) < each_of_four(leaf_of_a.low()[k].data(), part));
      apart |= bits(found) << (part * S::size());
    }
    return ~apart;
  }
  [[gnu::always_inline]] static Mask<S> beyond_plane(const TransformedLeaf<4>& leaf_of_a,
                                                     const TriangleLanes<float, 4>& others,
                                                     std::size_t part) {
    std::array<S, 3> normal, along;
    for (std::size_t k = 0; k < 3; ++k)
      normal[k] = each_of_four(leaf_of_a.normal()[k].data(), part);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto of_b = [&](std::size_t k) __attribute__((always_inline)) {
        return four_repeated(others.corner[i][k].data(), part);
      };
      along[i] = fused<S>(normal[2], of_b(2), fused<S>(normal[1], of_b(1), normal[0] * of_b(0)));
    }
    return (filter::min(filter::min(along[0], along[1]), along[2]) >
            each_of_four(leaf_of_a.most().data(), part)) |
           (filter::max(filter::max(along[0], along[1]), along[2]) <
            each_of_four(leaf_of_a.least().data(), part));
  }

  TransformedLeaves<Tree, 32> leaves_;
};

}  // namespace bvlab
