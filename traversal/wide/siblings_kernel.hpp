// SPDX-License-Identifier: BSD-3-Clause
/// A step of a traversal of two wide trees: one node is tested against all children of the other,
/// the larger one; inner nodes are opened before leaves. The children of a leaf are its triangles.
/// Those that overlap are tested against all triangles of the other leaf at once.
///
/// The members of a kernel, which defines a step of two trees:
///   Hierarchy<V, F>, Body<V, F>
///   nearest_child_first    whether a step's nearest child is taken next, or the nearest of all
///   PairFrame<V, F>        two bodies:
///     begin(a, b), a_to_b()
///     roots()                          the pair to start with
///     retry(touched, nodes, triangles) queues the pair that touched in the last frame first
///     step(pair, counter, test)        calls test(step) with the volumes to test at once:
///       lanes()                          the lanes in use, of `parts` registers S
///       overlap(part), separation(part), gaps(part)
///       push(nodes, triangles, lanes, order, next)
///       reference_sphere()               a sphere around one of the nodes, in both frames
///     triangles(pair)                  triangles tested at once, of pairs that `push` found:
///       lanes(), corners(part) of a and of b, of_a(lane), of_b(lane)
///       gap(counter), reference_sphere() a lower bound on their distance, and its sphere
///       gaps(counter)                    the same for each lane, if triangles have volumes
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string_view>

#include "traversal/primitives/triangle_filter.hpp"
#include "traversal/wide/relative_frame.hpp"
#include "traversal/wide/work_queue.hpp"

namespace bvlab {

struct SiblingsKernel {
  static constexpr std::string_view name = "siblings";
  static constexpr std::string_view description =
      "one node against all children of the other, the larger one";

  /// The nearest of all open pairs is taken first (see WorkQueue).
  static constexpr bool nearest_child_first = false;

  template <BoundingVolume V, int F>
  using Hierarchy = WideHierarchy<V, F>;
  template <BoundingVolume V, int F>
  using Body = WideBody<WideHierarchy<V, F>>;

  template <BoundingVolume V, int F>
  class PairFrame {
    using Body = SiblingsKernel::Body<V, F>;
    using Frame = RelativeFrame<V, F>;
    using Node = typename WideHierarchy<V, F>::Node;

   public:
    using S = Batch<typename V::scalar, F>;
    static constexpr std::size_t parts = 1;

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

    template <class Counter>
    struct Step {
      const PairFrame& pair_frame;
      Counter& counter;
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
      [[gnu::always_inline]] void push(WorkQueue& nodes, WorkQueue& triangles,
                                       std::uint64_t remaining, const std::array<S, 1>& order,
                                       NextPair) const {
        WorkQueue& to = leaves ? triangles : nodes;
        to.template push_lanes<F>(static_cast<int>(side), remaining, many.first, node[1 - side],
                                  order[0]);
      }
      ReferenceSphere reference_sphere() const {
        return pair_frame.frame_.reference_sphere(1 - side, node[1 - side]);
      }
    };

    template <class Counter, class Test>
    [[gnu::always_inline]] void step(const NodePair& pair, Counter& counter, Test&& test) const {
      const auto& a = hierarchies_[0]->node(pair.a);
      const auto& b = hierarchies_[1]->node(pair.b);
      const unsigned leaves = a.leaf & b.leaf;
      const std::size_t side =
          (a.leaf & ~b.leaf & 1u) | (((a.leaf | b.leaf) == 0) & (b.size > a.size));
      const std::array<const Node*, 2> nodes{&a, &b};
      const std::array<std::uint32_t, 2> node{pair.a, pair.b};
      test(Step<Counter>{*this, counter, side, node, leaves != 0, *nodes[side],
                         frame_.posed_node(1 - side, node[1 - side], counter)});
    }

    /// A triangle of a against all triangles of a leaf of b.
    class Triangles {
     public:
      [[gnu::always_inline]] Triangles(const PairFrame& pair_frame, const NodePair& pair)
          : pair_frame_(pair_frame),
            pair_(pair),
            lane_(pair.a % F),
            leaf_(pair_frame.hierarchies_[1]->node(pair.b)) {}

      std::uint64_t lanes() const { return leaf_.lanes; }
      std::uint32_t of_a(int) const { return pair_frame_.hierarchies_[0]->triangle(pair_.a); }
      std::uint32_t of_b(int lane) const {
        return pair_frame_.hierarchies_[1]->triangle(leaf_.first +
                                                     static_cast<std::uint32_t>(lane));
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
      /// A lower bound on the distance of the triangle's volume to each of the leaf's.
      template <class Counter>
      [[gnu::noinline]] S gaps(Counter& counter) const {
        const auto& frame = pair_frame_.frame_;
        const auto posed = frame.posed_child(0, pair_frame_.hierarchies_[0]->leaf_of(pair_.a),
                                             static_cast<int>(lane_), counter);
        counter.tested(static_cast<std::uint64_t>(std::popcount(leaf_.lanes)));
        return frame.gaps(1, pair_.b, posed);
      }
      /// A lower bound on the distance of any pair; not positive where none is known.
      template <class Counter>
      [[gnu::noinline]] float gap(Counter& counter) const {
        const auto& frame = pair_frame_.frame_;
        const auto posed = frame.posed_child(0, pair_frame_.hierarchies_[0]->leaf_of(pair_.a),
                                             static_cast<int>(lane_), counter);
        counter.tested(static_cast<std::uint64_t>(std::popcount(leaf_.lanes)));
        const S gaps = frame.separation(1, pair_.b, posed).gap;
        return stdx::hmin(select(gaps > S(0.0f), gaps, S(0.0f)));
      }
      /// A sphere around the triangle of a about its first corner.
      ReferenceSphere reference_sphere() const {
        const auto& own = pair_frame_.hierarchies_[0]->corners(pair_.a).corner;
        ReferenceSphere reference;
        for (std::size_t k = 0; k < 3; ++k) reference.centre_in_a[k] = own[0][k][lane_];
        pair_frame_
            .a_to_b()(reference.centre_in_a[0], reference.centre_in_a[1], reference.centre_in_a[2])
            .copy_to(reference.centre_in_b.data(), stdx::vector_aligned);
        float squared = 0;
        for (std::size_t i = 1; i < 3; ++i) {
          float length = 0;
          for (std::size_t k = 0; k < 3; ++k) {
            const float side = own[i][k][lane_] - own[0][k][lane_];
            length += side * side;
          }
          squared = std::max(squared, length);
        }
        reference.radius = std::sqrt(squared) * (1 + 16 * unit_roundoff<float>);
        reference.error_bound = pair_frame_.a_to_b().error_bound();
        return reference;
      }

     private:
      const PairFrame& pair_frame_;
      NodePair pair_;
      std::size_t lane_;
      const Node& leaf_;
    };
    [[gnu::always_inline]] Triangles triangles(const NodePair& pair) const { return {*this, pair}; }

   private:
    std::array<const WideHierarchy<V, F>*, 2> hierarchies_;
    Frame frame_;
  };
};

}  // namespace bvlab
