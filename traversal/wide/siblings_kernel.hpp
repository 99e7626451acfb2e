// SPDX-License-Identifier: BSD-3-Clause
/// A step of a traversal of two wide trees: one node is tested against all children of the other,
/// the larger one; inner nodes are opened before leaves. The children of a leaf are its triangles.
/// Those that overlap are tested against all triangles of the other leaf at once.
///
/// The members of a kernel, which defines a step of two trees:
///   Hierarchy<V, F>, Body<V, F>
///   nearest_child_first    whether a step's nearest child is taken next, or the nearest of all
///   PairFrame<V, F>        two bodies; S, a register of lanes; `parts`, the registers of a step;
///                          ContactSieve, the first test of triangles where all hits are sought:
///     begin(a, b), a_to_b()
///     roots()                          the pair to start with
///     retry(touched, nodes, triangles) queues the pair that touched in the last frame, to be
///                                      tested first
///     step(pair, counter, sieve, test) calls test(step) with the volumes to test at once; where
///                                      all hits are sought `sieve` is a ContactSieve, else it is
///                                      not used. Members of a step:
///       lanes()                          the lanes in use, of `parts` registers S
///       overlap(part), separation(part), gaps(part)
///       push(nodes, triangles, lanes, order, next, from)
///       leaf_lanes()                     the lanes that `push` queues as triangles
///       reference_sphere()               a sphere around one of the nodes, in both frames
///     prefetch(pair)                   begins to load what a step will read
///     sift(sieve, triangles, ...)      where all hits are sought (contact_sieve.hpp)
///     triangle(side, number)           the mesh's index of a triangle that a batch numbers
///     reference_sphere(number)         a sphere around that triangle of a
///     triangles(pair)                  triangles tested at once, of pairs that `push` found:
///       lanes(), corners(part) of a and of b, numbers(lane) of both
///       gap(counter), reference_sphere() a lower bound on their distance, and its sphere
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <type_traits>

#include "traversal/primitives/triangle_filter.hpp"
#include "traversal/wide/contact_sieve.hpp"
#include "traversal/wide/relative_frame.hpp"
#include "traversal/wide/work_queue.hpp"

namespace bvlab {

struct SiblingsKernel {
  static constexpr std::string_view name = "siblings";
  static constexpr std::string_view description =
      "one node against all children of the other, the larger one";

  /// The nearest of all open pairs is taken first (see WorkQueue).
  static constexpr bool nearest_child_first = false;

  template <class V, int F>
  using Hierarchy = typename RelativeFrame<V, F>::Tree;
  template <class V, int F>
  using Body = BodyOf<V, Hierarchy<V, F>>;

  template <class V, int F>
  class PairFrame {
    using Body = SiblingsKernel::Body<V, F>;
    using Frame = RelativeFrame<V, F>;
    using Tree = typename Frame::Tree;
    using Node = typename Tree::Node;

   public:
    using S = Batch<typename V::scalar, F>;
    using ContactSieve = SiblingsSieve<Tree>;
    static constexpr std::size_t parts = 1;
    /// Whether volumes can be tested against triangles.
    static constexpr bool tests_triangles =
        requires(const V& volume, const TransformedLeaf<F>& triangles) {
          SiblingTestOf<V>::template triangle_gaps<S>(volume, triangles);
        };

    void begin(Body& a, Body& b) {
      hierarchies_ = {&a.hierarchy(), &b.hierarchy()};
      frame_.begin(a, b);
    }
    const CornerTransform& a_to_b() const { return frame_.a_to_b(); }
    NodePair roots() const { return {0, 0}; }
    /// `touched` is a triangle of a and a leaf of b. It is tested first, then the triangle's leaf.
    void retry(const NodePair& touched, WorkQueue& nodes, WorkQueue& triangles) const {
      nodes.push({hierarchies_[0]->leaf_of(touched.a), touched.b},
                 -std::numeric_limits<float>::max());
      triangles.push(touched, 0);
    }

    struct Step {
      const PairFrame& pair_frame;
      std::size_t side;                   ///< whose nodes are in the lanes
      std::array<std::uint32_t, 2> node;  ///< of that side, one is its parent
      bool leaves;
      const Node& many;
      typename Frame::PosedNode posed;

      std::uint64_t lanes() const { return many.lanes; }
      [[gnu::always_inline]] OverlapLanes<S> overlap(std::size_t) const {
        return pair_frame.frame_.overlap(side, node[side], posed);
      }
      [[gnu::always_inline]] GapLanes<S> separation(std::size_t) const {
        return pair_frame.frame_.separation(side, node[side], posed);
      }
      [[gnu::always_inline]] S gaps(std::size_t) const {
        return pair_frame.frame_.gaps(side, node[side], posed);
      }
      std::uint64_t leaf_lanes() const { return leaves ? many.lanes : 0; }
      /// `order` is an array of one register, or NoOrder; `from` as in WorkQueue::push_lanes.
      template <class Order, class From>
      [[gnu::always_inline]] void push(WorkQueue& nodes, WorkQueue& triangles,
                                       std::uint64_t remaining, const Order& order, NextPair,
                                       From from) const {
        WorkQueue& to = leaves ? triangles : nodes;
        const auto push = [&](const auto& of_lanes) __attribute__((always_inline)) {
          to.template push_lanes<F>(static_cast<int>(side), remaining, many.first, node[1 - side],
                                    of_lanes, from);
        };
        if constexpr (std::is_same_v<Order, NoOrder>)
          push(order);
        else
          push(order[0]);
      }
      ReferenceSphere reference_sphere() const {
        return pair_frame.frame_.reference_sphere(1 - side, node[1 - side]);
      }
    };

    /// The step of two leaves where all hits are sought: the triangles of a, in the frame of b,
    /// against the leaf of b.
    struct LeafStep {
      const PairFrame& pair_frame;
      NodePair node;
      const Node &a, &b;
      const TransformedLeaf<F>& triangles_of_a;

      std::uint64_t lanes() const { return a.lanes; }
      [[gnu::always_inline]] OverlapLanes<S> overlap(std::size_t) const {
        const S gap = separation(0).gap;
        return {gap > S(0.0f), gap};
      }
      [[gnu::always_inline]] GapLanes<S> separation(std::size_t) const {
        const S gap = SiblingTestOf<V>::template triangle_gaps<S>(b.volume, triangles_of_a);
        return {gap, gap};
      }
      std::uint64_t leaf_lanes() const { return a.lanes; }
      template <class From>
      [[gnu::always_inline]] void push(WorkQueue&, WorkQueue& triangles, std::uint64_t remaining,
                                       NoOrder order, NextPair, From from) const {
        triangles.template push_lanes<F>(0, remaining, a.first, node.b, order, from);
      }
      ReferenceSphere reference_sphere() const {
        return pair_frame.frame_.reference_sphere(1, node.b);
      }
    };

    /// `sieve` is a ContactSieve, if all hits are sought.
    template <class Counter, class Sieve, class Test>
    [[gnu::always_inline]] void step(const NodePair& pair, Counter& counter,
                                     [[maybe_unused]] Sieve& sieve, Test&& test) const {
      const auto& a = hierarchies_[0]->node(pair.a);
      const auto& b = hierarchies_[1]->node(pair.b);
      const unsigned leaves = a.leaf & b.leaf;
      if constexpr (std::is_same_v<Sieve, ContactSieve> && tests_triangles)
        if (leaves) {
          hierarchies_[0]->require(pair.a);
          counter.posed(1);
          return test(
              LeafStep{*this, pair, a, b, sieve.leaf_of_a(hierarchies_, a_to_b(), a.first)});
        }
      const std::size_t side = larger(a, b);
      const std::array<const Node*, 2> nodes{&a, &b};
      const std::array<std::uint32_t, 2> node{pair.a, pair.b};
      hierarchies_[side]->require(node[side]);
      test(Step{*this, side, node, leaves != 0, *nodes[side],
                frame_.posed_node(1 - side, node[1 - side], counter)});
    }

    /// Begins to load what the step of a pair will read, or the sieve after it.
    [[gnu::always_inline]] void prefetch(const NodePair& pair) const {
      const Node &a = hierarchies_[0]->node(pair.a), &b = hierarchies_[1]->node(pair.b);
      const auto lines = [](const void* from, std::size_t size) __attribute__((always_inline)) {
        for (std::size_t at = 0; at < size; at += 64)
          __builtin_prefetch(static_cast<const char*>(from) + at);
      };
      if (tests_triangles && a.leaf & b.leaf)
        return lines(&hierarchies_[1]->corners(b.first), sizeof(TriangleLanes<float, F>));
      const std::size_t side = larger(a, b);
      lines(frame_.lanes(side, side ? pair.b : pair.a), 12 * 64);
    }

    /// A triangle of a against all triangles of a leaf of b.
    class Triangles {
     public:
      [[gnu::always_inline]] Triangles(const PairFrame& pair_frame, const NodePair& pair)
          : pair_frame_(pair_frame),
            pair_(pair),
            lane_(pair.a % F),
            leaf_(pair_frame.hierarchies_[1]->node(pair.b)) {
        pair_frame.hierarchies_[1]->require(pair.b);
      }

      std::uint64_t lanes() const { return leaf_.lanes; }
      NodePair numbers(int lane) const {
        return {pair_.a, leaf_.first + static_cast<std::uint32_t>(lane)};
      }
      [[gnu::always_inline]] std::array<Corners<S>, 2> corners(std::size_t) const {
        const auto& lanes = pair_frame_.hierarchies_[1]->corners(leaf_.first).corner;
        const auto& own = pair_frame_.hierarchies_[0]->corners(pair_.a).corner;
        alignas(16) std::array<std::array<float, 4>, 3> transformed;
        for (std::size_t i = 0; i < 3; ++i)
          pair_frame_.a_to_b()(own[i][0][lane_], own[i][1][lane_], own[i][2][lane_])
              .copy_to(transformed[i].data(), stdx::vector_aligned);
#if defined(__GNUC__)
        asm("" : "+m"(transformed));  // to be broadcast from memory
#endif
        std::array<Corners<S>, 2> of;
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t j = 0; j < 3; ++j) {
            of[0][i][j] = S(transformed[i][j]);
            of[1][i][j] = S(lanes[i][j].data(), stdx::vector_aligned);
          }
        return of;
      }
      /// A lower bound on the distance of any pair; not positive where none is known.
      template <class Counter>
      [[gnu::noinline]] float gap(Counter& counter) const {
        const S gaps = pair_frame_.frame_.separation(1, pair_.b, posed(counter)).gap;
        return stdx::hmin(select(gaps > S(0.0f), gaps, S(0.0f)));
      }
      ReferenceSphere reference_sphere() const { return pair_frame_.reference_sphere(pair_.a); }

     private:
      /// The triangle's volume, to be tested against the leaf's.
      template <class Counter>
      [[gnu::always_inline]] auto posed(Counter& counter) const {
        counter.tested(static_cast<std::uint64_t>(std::popcount(leaf_.lanes)));
        return pair_frame_.frame_.posed_child(0, pair_frame_.hierarchies_[0]->leaf_of(pair_.a),
                                              static_cast<int>(lane_), counter);
      }

      const PairFrame& pair_frame_;
      NodePair pair_;
      std::size_t lane_;
      const Node& leaf_;
    };
    [[gnu::always_inline]] Triangles triangles(const NodePair& pair) const { return {*this, pair}; }

    /// Where all hits are sought: the first test of the triangles in the queue (contact_sieve.hpp).
    template <class Counter>
    [[gnu::always_inline]] void sift(ContactSieve& sieve, WorkQueue& triangles, ContactBatch& batch,
                                     Counter& counter) const {
      sieve.sift(hierarchies_, a_to_b(), triangles, batch, counter);
    }
    ReferenceSphere reference_sphere(std::uint32_t number) const {
      const auto& own = hierarchies_[0]->corners(number).corner;
      return reference_sphere_of_triangle(
          [&own, lane = number % F](std::size_t i, std::size_t k) { return own[i][k][lane]; },
          a_to_b());
    }
    /// The mesh's index of a triangle of `side`, by the number that a batch has.
    std::uint32_t triangle(std::size_t side, std::uint32_t number) const {
      return hierarchies_[side]->triangle(number);
    }

   private:
    /// The side of the node that is opened.
    [[gnu::always_inline]] static std::size_t larger(const Node& a, const Node& b) {
      return (a.leaf & ~b.leaf & 1u) | (((a.leaf | b.leaf) == 0) & (b.size > a.size));
    }

    std::array<const Tree*, 2> hierarchies_;
    Frame frame_;
  };
};

}  // namespace bvlab
