// SPDX-License-Identifier: BSD-3-Clause
/// A step of a traversal of two trees with four children per node, in sixteen lanes. Where the two
/// nodes are alike in size, four children are tested against four; else one node against the
/// sixteen grandchildren of the other, which is the larger one or the only inner one (see
/// block_hierarchy.hpp).
///
/// Four against four halves the number of steps between bodies of similar size. It is bad where one
/// is far larger: then all four of its children overlap all four of the other's. See
/// siblings_kernel.hpp for the members of a kernel.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "traversal/wide/block_tests.hpp"
#include "traversal/wide/block_triangles.hpp"
#include "traversal/wide/contact_sieve.hpp"
#include "traversal/wide/relative_frame.hpp"
#include "traversal/wide/sixteen_lanes.hpp"
#include "traversal/wide/work_queue.hpp"

namespace bvlab {

struct MixedKernel {
  static constexpr std::string_view name = "mixed";
  static constexpr std::string_view description =
      "four children against four where nodes are alike in size, else one against sixteen "
      "grandchildren";
  /// Sixteen lanes leave many open pairs: descending to the nearest child of a step, rather than to
  /// the nearest of all open pairs, finds a hit sooner and with fewer stalls.
  static constexpr bool nearest_child_first = true;
  /// Nodes whose sizes differ by no more than this factor are alike.
  static constexpr float alike = 2;

  template <class V, int F>
  using Hierarchy = typename BlockTests<V>::Tree;
  template <class V, int F>
  using Body = BodyOf<V, Hierarchy<V, F>>;

  template <class V, int F>
  class PairFrame {
    using Tests = BlockTests<V>;
    using Tree = typename Tests::Tree;
    static_assert(F == Tree::fan_out, "blocks are four by four");
    using Node = typename Tree::Node;
    using Row = typename Tree::Row;
    using Block = typename Tree::Block;

   public:
    using S = SixteenLanes;
    using ContactSieve = BlocksSieve<Tree>;
    static constexpr std::size_t parts = 16 / S::size();

    void begin(Body<V, F>& a, Body<V, F>& b) {
      trees_ = {&a.hierarchy(), &b.hierarchy()};
      frames_.begin(a, b);
    }
    const CornerTransform& a_to_b() const { return frames_.transform[0]; }
    NodePair roots() const { return {trees_[0]->root(), trees_[1]->root()}; }
    /// `touched` is a pair of leaves.
    void retry(const NodePair& touched, WorkQueue&, WorkQueue& triangles) const {
      triangles.push(touched, 0);
    }

    /// Four children of a against four of b.
    struct FourByFour : Tests::Four {
      using Tests::Four::row_a, Tests::Four::row_b;
      const PairFrame& pair_frame;
      NodePair node;
      std::uint64_t used;

      std::uint64_t lanes() const { return used; }
      std::uint64_t leaf_lanes() const {
        return highest_bits(each_of_four(row_a.name.data()) & four_repeated(row_b.name.data()));
      }
      template <class Order, class From>
      [[gnu::always_inline]] void push(WorkQueue& nodes, WorkQueue& triangles,
                                       std::uint64_t remaining, const Order& order, NextPair next,
                                       From from) const {
        push_nodes(nodes, triangles, remaining, each_of_four(row_a.name.data()),
                   four_repeated(row_b.name.data()), order, next, from);
      }
      ReferenceSphere reference_sphere() const {
        return reference_sphere_of_smaller(pair_frame.trees_[0]->node_sphere(node.a),
                                           pair_frame.trees_[1]->node_sphere(node.b),
                                           pair_frame.frames_.transform);
      }
    };

    /// One volume against the sixteen lanes of a block.
    struct OneBySixteen : Tests::One {
      using Tests::One::block;
      const PairFrame& pair_frame;
      std::size_t side;  ///< whose nodes are in the lanes
      std::uint32_t single, name;
      std::uint64_t used;

      std::uint64_t lanes() const { return used; }
      std::uint64_t leaf_lanes() const {
        return highest_bits(of_sixteen(block.name.data()) & (NodesOfLanes{} + name));
      }
      template <class Order, class From>
      [[gnu::always_inline]] void push(WorkQueue& nodes, WorkQueue& triangles,
                                       std::uint64_t remaining, const Order& order, NextPair next,
                                       From from) const {
        const NodesOfLanes many = of_sixteen(block.name.data()), same = NodesOfLanes{} + name;
        push_nodes(nodes, triangles, remaining, side ? same : many, side ? many : same, order, next,
                   from);
      }
      ReferenceSphere reference_sphere() const {
        return reference_sphere_of(pair_frame.trees_[1 - side]->node_sphere(single), 1 - side,
                                   pair_frame.frames_.transform);
      }
    };

    template <class Counter, class Sieve, class Test>
    [[gnu::always_inline]] void step(const NodePair& pair, Counter& counter, Sieve&,
                                     Test&& test) const {
      const std::uint32_t i = Tree::number_of(pair.a), j = Tree::number_of(pair.b);
      const Node &a = trees_[0]->node(i), &b = trees_[1]->node(j);
      const bool inner = !((pair.a | pair.b) & Tree::leaf_flag);
      const bool leaves = pair.a & pair.b & Tree::leaf_flag;  // both roots are leaves
      if ((inner && a.size <= alike * b.size && b.size <= alike * a.size) || leaves) {
        frames_.count_posed(counter, 1, static_cast<std::uint64_t>(std::popcount(a.children)));
        test(FourByFour{
            {leaves ? trees_[0]->root_alone() : trees_[0]->row(a.first),
             leaves ? trees_[1]->root_alone() : trees_[1]->row(b.first), frames_.change[1]},
            *this,
            {i, j},
            leaves ? 1 : four_by_four(a.children, b.children)});
        return;
      }
      frames_.count_posed(counter, 0, 1);
      // One call: each holds a copy of the test.
      const std::size_t side = !a.leaf && (b.leaf || a.size > b.size) ? 0 : 1;
      const Node& many = side ? b : a;
      test(OneBySixteen{{side ? a : b, trees_[side]->block(many.first), frames_.change[side]},
                        *this,
                        side,
                        side ? i : j,
                        side ? pair.a : pair.b,
                        many.grandchildren});
    }

    /// Begins to load what the step of a pair of nodes will read.
    [[gnu::always_inline]] void prefetch(const NodePair& pair) const {
      const Node &a = trees_[0]->node(Tree::number_of(pair.a)),
                 &b = trees_[1]->node(Tree::number_of(pair.b));
      const auto lines = [](const auto& from) __attribute__((always_inline)) {
        for (std::size_t at = 0; at < sizeof from; at += 64)
          __builtin_prefetch(reinterpret_cast<const char*>(&from) + at);
      };
      if (!(a.leaf | b.leaf) && a.size <= alike * b.size && b.size <= alike * a.size)
        lines(trees_[0]->row(a.first)), lines(trees_[1]->row(b.first));
      else if (!a.leaf && (b.leaf || a.size > b.size))
        lines(trees_[0]->block(a.first));
      else if (!b.leaf)
        lines(trees_[1]->block(b.first));
    }

    using Triangles = BlockTriangles<Tree>;
    [[gnu::always_inline]] Triangles triangles(const NodePair& pair) const {
      return {trees_, frames_.transform, pair};
    }

    template <class Counter>
    [[gnu::always_inline]] void sift(ContactSieve& sieve, WorkQueue& triangles, ContactBatch& batch,
                                     Counter& counter) const {
      sieve.sift(trees_, a_to_b(), triangles, batch, counter);
    }
    ReferenceSphere reference_sphere(std::uint32_t number) const {
      const auto& own = trees_[0]->corners(number).corner;
      return reference_sphere_of_triangle(
          [&own, lane = number % 4](std::size_t i, std::size_t k) { return own[i][k][lane]; },
          a_to_b());
    }
    std::uint32_t triangle(std::size_t side, std::uint32_t number) const {
      return trees_[side]->triangle(number);
    }

   private:
    /// Pairs of two leaves go to the queue of triangles.
    template <class Order, class From>
    [[gnu::always_inline]] static void push_nodes(WorkQueue& nodes, WorkQueue& triangles,
                                                  std::uint64_t remaining, const NodesOfLanes& a,
                                                  const NodesOfLanes& b, const Order& order,
                                                  [[maybe_unused]] NextPair next, From from) {
      const std::uint64_t leaves = remaining & highest_bits(a & b);
      if (leaves) triangles.push_sixteen(leaves, a, b, order, from);
      if constexpr (!std::is_same_v<Order, NoOrder>)
        if (next == NextPair::nearest_child)
          return nodes.push_sixteen_least_last(remaining & ~leaves, a, b, order, from);
      nodes.push_sixteen(remaining & ~leaves, a, b, order, from);
    }

    std::array<const Tree*, 2> trees_;
    TwoFrames<typename Tests::SiblingTest> frames_;
  };
};

}  // namespace bvlab
