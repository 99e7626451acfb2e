// SPDX-License-Identifier: BSD-3-Clause
/// The steps of a traversal: volumes are posed and tested, pairs are pushed and replaced,
/// primitives are held and passed to the query. traverse.hpp puts them in order.
#pragma once

#include <cstdint>

#include "traversal/body.hpp"
#include "traversal/descent.hpp"
#include "traversal/held_primitives.hpp"
#include "traversal/pair_batch.hpp"
#include "traversal/tracked_front.hpp"

namespace bvlab {

/// The public members are for fronts, which call them in their sweeps.
template <class B, class V, class QueryType, class Counter, class Front>
class TraversalSteps {
 public:
  using Query = QueryType;
  using Node = typename Hierarchy<V>::Node;
  static constexpr std::size_t W = width<B>();

  /// `placement`: of a in the frame of b, if volumes are tested there; null in the world frame.
  TraversalSteps(Body<V>& a, Body<V>& b, const PlacementOf<V>* placement, Query& query,
                 Counter& counter, Workspace& workspace, Front& front)
      : placement_(placement),
        a_(a),
        b_(b),
        query_(query),
        counter_(counter),
        workspace_(workspace),
        front_(front),
        open_(workspace.open),
        held_(a, b, query, counter, workspace, front) {
    open_.clear();
    workspace.pending.clear();
  }

  const Hierarchy<V>& a() const { return a_.hierarchy(); }
  const Hierarchy<V>& b() const { return b_.hierarchy(); }
  Query& query() { return query_; }
  Workspace& workspace() { return workspace_; }

  /// Pushes a pair that is no entry; it is tested later.
  void push(const NodePair& pair) {
    require(pair);
    open_.reserve(1);
    open_.push(pair);
  }

  /// Which of the pairs pair(0), pair(1), ..., at most W, the query culls, as bits.
  template <class Pair>
  std::uint64_t culled(std::size_t count, Pair&& pair) {
    for (std::size_t i = 0; i < count; ++i) {
      batch_.put(i, pair(i));
      require(batch_[i]);
    }
    return test(count);
  }
  /// A lower bound on the distance of the two volumes.
  auto gap(const NodePair& pair) {
    require(pair);
    count_tests(1);
    if constexpr (PlacedRelatively<V>)
      if (placement_) return stored_volumes().gap(pair);
    return posed_volumes().gap(pair);
  }

  /// `hold` buffers the primitive pairs of two leaves, from the entry in `slot` (Outcome::none: no
  /// entry). `flush` tests the buffer and returns whether the query is satisfied.
  void hold(const NodePair& pair, std::size_t slot = Outcome::none) {
    held_.hold(a().node(pair.a), b().node(pair.b), slot);
  }
  [[gnu::always_inline]] bool flush() { return held_.flush(); }
  /// For sweeps that have moved entries to other slots since the query last named a witness.
  void forget_witness() { held_.forget_witness(); }

 protected:
  /// Replaces a pair by pairs of children. The first children are pushed last, so that they are
  /// tested first. Room for four pairs of each lane is reserved; larger nodes reserve their own.
  void descend(const NodePair& pair, const Node& a, const Node& b) {
    const Descent descent = front_.descent(a, b);
    if (descent == Descent::both) {
      a_.require_children(a, counter_), b_.require_children(b, counter_);
      if (a.children + b.children > 4) [[unlikely]]
        return push_all(open_, a, b);
      open_.push({a.first + 1, b.first + 1});
      open_.push({a.first + 1, b.first});
      open_.push({a.first, b.first + 1});
      open_.push({a.first, b.first});
    } else {
      const bool second = descent == Descent::b;
      const Node& opened = second ? b : a;
      (second ? b_ : a_).require_children(opened, counter_);
      const std::uint32_t first = opened.first;
      if (opened.children > 2) [[unlikely]]
        push_from_third(open_, pair, descent, opened);
      open_.push(second ? NodePair{pair.a, first + 1} : NodePair{first + 1, pair.b});
      open_.push(second ? NodePair{pair.a, first} : NodePair{first, pair.b});
    }
  }

  // Static and out of line, so that the loop over binary trees stays in registers.
  static constexpr std::size_t room = 4 * W;  // for pairs pushed without a check
  [[gnu::noinline]] static void push_from_third(OpenPairs& open, NodePair pair, Descent descent,
                                                const Node& opened) {
    open.reserve(opened.children + room);
    for (std::uint32_t k = opened.children; k-- > 2;)
      open.push(descent == Descent::b ? NodePair{pair.a, opened.first + k}
                                      : NodePair{opened.first + k, pair.b});
  }
  [[gnu::noinline]] static void push_all(OpenPairs& open, const Node& a, const Node& b) {
    open.reserve(std::size_t{a.children} * b.children + room);
    for (std::uint32_t i = a.children; i-- > 0;)
      for (std::uint32_t j = b.children; j-- > 0;) open.push({a.first + i, b.first + j});
  }
  template <class Batch>
  [[gnu::noinline]] static std::uint64_t culled_where_stored(Batch& batch,
                                                             const StoredVolumes<V>& volumes,
                                                             std::size_t count, Query& query) {
    return batch.culled(volumes, count, query);
  }

  std::uint64_t test(std::size_t count) {
    count_tests(count);
    if constexpr (PlacedRelatively<V>)
      if (placement_) [[unlikely]]
        return culled_where_stored(batch_, stored_volumes(), count, query_);
    return batch_.culled(posed_volumes(), count, query_);
  }
  void count_tests(std::size_t count) {
    tests_ += count;
    counter_.tested(count);
    if constexpr (Counter::counts)
      if (placement_) counter_.posed(count);
  }
  [[gnu::always_inline]] PosedVolumes<V> posed_volumes() const {
    return {a_.volumes(), b_.volumes()};
  }
  [[gnu::always_inline]] StoredVolumes<V> stored_volumes() const {
    return {a().volumes(), b().volumes(), *placement_};
  }
  void require(const NodePair& pair) {
    a_.require(pair.a, counter_);
    b_.require(pair.b, counter_);
  }

  const PlacementOf<V>* placement_;
  Body<V>& a_;
  Body<V>& b_;
  Query& query_;
  Counter& counter_;
  Workspace& workspace_;
  Front& front_;
  OpenPairs& open_;
  HeldPrimitives<V, Query, Counter, Front> held_;
  PairBatch<B, Front::measures_gaps || wants_bound<Query>()> batch_;
  std::size_t tests_ = 0;
};

}  // namespace bvlab
