// SPDX-License-Identifier: BSD-3-Clause
/// Two bodies and a query between them: the argument of a strategy's `run`.
///
/// A strategy uses nothing else, so it is written and compiled once for all volumes. The members:
///   a(), b()              the bodies, as far as their motion is concerned (MovingBody)
///   query()               the query, which holds the answer
///   from_front(front)     a traversal from any TrackedFront, which it keeps up to date
///   from_roots<Roots>(s)  the recursive algorithm; Roots is NoFront or NoFrontBoth, s is whether
///                         the roots are known to overlap
///   count_bodies()        counts a test of the two bodies as a whole
/// from_front and from_roots return the statistics of the traversal.
#pragma once

#include <utility>

#include "traversal/no_front.hpp"
#include "traversal/traverse.hpp"

namespace bvlab {

/// W pairs of volumes are tested at once.
template <std::size_t W, class QueryType, class Counter>
class PairOfBodies {
 public:
  using Query = QueryType;

  PairOfBodies(TreeBody& a, TreeBody& b, TestsBetween<Query> tests_between, Query& query,
               Counter& counter, Workspace& workspace)
      : a_(a),
        b_(b),
        tests_between_(tests_between),
        query_(query),
        counter_(counter),
        workspace_(workspace) {}

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
    const TraversalStatistics statistics =
        traverse<W>(a_, b_, tests_between_(a_, b_, workspace_), query_, workspace_, front);
    statistics.count(counter_);
    return statistics;
  }

 private:
  TreeBody& a_;
  TreeBody& b_;
  TestsBetween<Query> tests_between_;
  Query& query_;
  Counter& counter_;
  Workspace& workspace_;
};

/// The same of bodies whose volume is known. B is the scalar or batch in which volumes are tested.
template <class B, BoundingVolume V, class Query, class Counter>
class BodyPair : public PairOfBodies<width<B>(), Query, Counter> {
 public:
  BodyPair(Body<V>& a, Body<V>& b, Query& query, Counter& counter, Workspace& workspace)
      : PairOfBodies<width<B>(), Query, Counter>(a, b, tests_between<width<B>(), V, Query>, query,
                                                 counter, workspace) {}
};

}  // namespace bvlab
