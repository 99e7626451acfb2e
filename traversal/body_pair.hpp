// SPDX-License-Identifier: BSD-3-Clause
/// Two bodies and a query between them: the argument of a strategy's `run`.
///
/// A strategy uses nothing else, so it is written once for all volumes, queries, counters and
/// widths. The members:
///   a(), b()              the bodies, as far as their motion is concerned (MovingBody)
///   query()               the query, which holds the answer
///   from_front(front)     a traversal from any TrackedFront, which it keeps up to date
///   from_roots<Roots>(s)  the recursive algorithm; Roots is NoFront or NoFrontBoth, s is whether
///                         the roots are known to overlap
///   count_bodies()        counts a test of the two bodies as a whole
/// from_front and from_roots return the statistics of the traversal. `AnyPair` of the bvlab program
/// has the same members without naming a volume.
#pragma once

#include "traversal/no_front.hpp"
#include "traversal/traverse.hpp"

namespace bvlab {

/// B is the scalar or batch in which volumes are tested.
template <class B, BoundingVolume V, class QueryType, class Counter>
class BodyPair {
 public:
  using Query = QueryType;

  BodyPair(Body<V>& a, Body<V>& b, Query& query, Counter& counter, Workspace& workspace)
      : a_(a), b_(b), query_(query), counter_(counter), workspace_(workspace) {}

  MovingBody& a() const { return a_; }
  MovingBody& b() const { return b_; }
  Query& query() const { return query_; }

  void count_bodies() const { counter_.bodies(1); }
  template <class Roots = NoFront>
  TraversalStatistics from_roots(Start start = Start::roots) const {
    return from_front(Roots(start));
  }
  template <class Front>
  TraversalStatistics from_front(Front&& front) const {
    return traverse<B>(a_, b_, query_, counter_, workspace_, front);
  }

 private:
  Body<V>& a_;
  Body<V>& b_;
  Query& query_;
  Counter& counter_;
  Workspace& workspace_;
};

}  // namespace bvlab
