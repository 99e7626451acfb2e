// SPDX-License-Identifier: BSD-3-Clause
/// Runs the first phase of the triangle test of contact queries (contact_batch.hpp) on the pairs of
/// leaves that the steps of a kernel have found near.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "hierarchies/wide/lanes.hpp"
#include "hierarchies/wide/triangle_lanes.hpp"
#include "traversal/wide/contact_batch.hpp"
#include "traversal/wide/sixteen_lanes.hpp"
#include "traversal/wide/work_queue.hpp"

namespace bvlab {

/// Triangles of a against all triangles of a leaf of b. Tree is a WideTree.
template <class Tree>
class SiblingsSieve {
  static constexpr int F = Tree::fan_out;
  using S = typename Tree::Lane;
  using Trees = std::array<const Tree*, 2>;

 public:
  void begin() { leaf_of_a_.forget(); }

  /// The triangles of the leaf of a whose first one has the number `first`.
  [[gnu::always_inline]] const TransformedLeaf<F>& leaf_of_a(const Trees& trees,
                                                             const CornerTransform& a_to_b,
                                                             std::uint32_t first) {
    leaf_of_a_.require(first, trees[0]->corners(first), a_to_b);
    return leaf_of_a_;
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
  TransformedLeaf<F> leaf_of_a_;
};

/// Up to four triangles of a leaf of a against up to four of a leaf of b. Tree is a TreeInBlocks.
template <class Tree>
class BlocksSieve {
  using S = SixteenLanes;
  using Trees = std::array<const Tree*, 2>;

 public:
  void begin() { leaf_of_a_.forget(); }

  template <class Counter>
  [[gnu::noinline]] void sift(const Trees& trees, const CornerTransform& a_to_b,
                              WorkQueue& triangles, ContactBatch& batch, Counter& counter) {
    do {
      const NodePair pair = triangles.take_last();
      const auto &a = trees[0]->node(Tree::number_of(pair.a)),
                 &b = trees[1]->node(Tree::number_of(pair.b));
      const std::uint64_t lanes = four_by_four(a.children, b.children);
      counter.primitives(static_cast<std::uint64_t>(std::popcount(lanes)));
      leaf_of_a_.require(a.first, trees[0]->corners(a.first), a_to_b);
      const auto& others = trees[1]->corners(b.first);
      const std::uint64_t near = lanes & this->near(others);
      if (near) batch.add(near, leaf_of_a_.corners(), a.first, others, b.first);
    } while (!batch.full() && !triangles.empty());
  }

 private:
  using Four = CornerTransform::Four;

  /// As TransformedLeaf::near, for all four of a: lane 4 i + j is of triangle i of a and j of b.
  [[gnu::always_inline]] std::uint64_t near(const TriangleLanes<float, 4>& others) const {
    const TriangleBoxes<Four> boxes(corners_in_lanes<Four>(others));
    alignas(16) std::array<std::array<float, 4>, 3> low, high;
    for (std::size_t k = 0; k < 3; ++k) {
      boxes.low[k].copy_to(low[k].data(), stdx::vector_aligned);
      boxes.high[k].copy_to(high[k].data(), stdx::vector_aligned);
    }
    std::uint64_t apart = 0;
    for (std::size_t part = 0; part < 16 / S::size(); ++part) {
      Mask<S> found = beyond_plane(others, part);
      for (std::size_t k = 0; k < 3; ++k)
        found =
            found |
            (four_repeated(low[k].data(), part) > each_of_four(leaf_of_a_.high()[k].data(), part)) |
            (four_repeated(high[k].data(), part) < each_of_four(leaf_of_a_.low()[k].data(), part));
      apart |= bits(found) << (part * S::size());
    }
    return ~apart;
  }
  [[gnu::always_inline]] Mask<S> beyond_plane(const TriangleLanes<float, 4>& others,
                                              std::size_t part) const {
    std::array<S, 3> normal, along;
    for (std::size_t k = 0; k < 3; ++k)
      normal[k] = each_of_four(leaf_of_a_.normal()[k].data(), part);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto of_b = [&](std::size_t k) __attribute__((always_inline)) {
        return four_repeated(others.corner[i][k].data(), part);
      };
      along[i] = fused<S>(normal[2], of_b(2), fused<S>(normal[1], of_b(1), normal[0] * of_b(0)));
    }
    return (filter::min(filter::min(along[0], along[1]), along[2]) >
            each_of_four(leaf_of_a_.most().data(), part)) |
           (filter::max(filter::max(along[0], along[1]), along[2]) <
            each_of_four(leaf_of_a_.least().data(), part));
  }

  TransformedLeaf<4> leaf_of_a_;
};

}  // namespace bvlab
