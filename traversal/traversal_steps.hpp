// SPDX-License-Identifier: BSD-3-Clause
/// What a traversal does with single pairs of nodes: volumes are posed and tested, pairs pushed and
/// replaced, primitives held and handed to the query. In which order, traverse.hpp says.
#pragma once

#include <cstdint>

#include "traversal/body.hpp"
#include "traversal/descent.hpp"
#include "traversal/held_primitives.hpp"
#include "traversal/pair_batch.hpp"
#include "traversal/tracked_front.hpp"

namespace bvlab {

/// What is public is for fronts, in their sweeps.
template <class B, class V, class QueryType, class Counter, class Front>
class TraversalSteps {
 public:
  using Query = QueryType;
  using Node = typename Hierarchy<V>::Node;
  static constexpr std::size_t W = width<B>();

  TraversalSteps(Body<V>& a, Body<V>& b, Query& query, Counter& counter, Workspace& workspace,
                 Front& front)
      : a_(a),
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

  /// A pair that is no entry is to be looked at.
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
  /// At most the distance between the two volumes.
  auto gap(const NodePair& pair) {
    require(pair);
    count_tests(1);
    return detail::gap_between(a_.volumes()[pair.a], b_.volumes()[pair.b]);
  }

  /// Holds the primitives of two leaves, from the entry in `slot` if from one; tests what is held,
  /// and says whether the query has had enough.
  void hold(const NodePair& pair, std::size_t slot = Outcome::none) {
    held_.hold(a().node(pair.a), b().node(pair.b), slot);
  }
  [[gnu::always_inline]] bool flush() { return held_.flush(); }
  /// Entries are in other slots than when the query last named a witness.
  void forget_witness() { held_.forget_witness(); }

 protected:
  void descend(const NodePair& pair, const Node& a, const Node& b) {
    const Descent descent = front_.descent(a, b);
    if (descent == Descent::both) {
      require({a.first, b.first});
      open_.push({a.first + 1, b.first + 1});
      open_.push({a.first + 1, b.first});
      open_.push({a.first, b.first + 1});
      open_.push({a.first, b.first});
    } else {
      const bool second = descent == Descent::b;
      const std::uint32_t first = second ? b.first : a.first;
      (second ? b_ : a_).require(first, counter_);
      open_.push(second ? NodePair{pair.a, first + 1} : NodePair{first + 1, pair.b});
      open_.push(second ? NodePair{pair.a, first} : NodePair{first, pair.b});
    }
  }

  std::uint64_t test(std::size_t count) {
    count_tests(count);
    return batch_.culled(a_.volumes(), b_.volumes(), count, query_);
  }
  void count_tests(std::size_t count) {
    tests_ += count;
    counter_.tested(count);
  }
  void require(const NodePair& pair) {
    a_.require(pair.a, counter_);
    b_.require(pair.b, counter_);
  }

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
