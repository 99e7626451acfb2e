// SPDX-License-Identifier: BSD-3-Clause
/// Bodies whose volume is chosen by name while the program runs. Volumes and strategies meet here,
/// so that neither is compiled for the other: one virtual call starts a traversal, and inside it
/// everything is a template as in `Bodies`.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "traversal/body_pair.hpp"
#include "traversal/fronts.hpp"

namespace bvlab {

/// Bodies of a volume that is known inside alone. What is not documented here is as in `Bodies` and
/// `BodyPair`. Nothing is counted inside: each traversal says what it tested, and how many volumes
/// were posed can be told afterwards, so the loops are compiled once for both ways to count.
template <class Query>
class BodyLoops {
 public:
  virtual ~BodyLoops() = default;
  virtual std::size_t size() const = 0;
  virtual const TriangleMesh& mesh(std::size_t i) const = 0;
  virtual MovingBody& body(std::size_t i) = 0;
  virtual void make_room() = 0;
  virtual void move(std::size_t i, const Pose& pose, const Vec3<double>& origin) = 0;
  virtual void move(std::span<const Pose> poses, const Vec3<double>& origin) = 0;
  virtual void cull_roots(std::span<const ObjectPair> pairs, std::span<const std::uint32_t> fresh,
                          Query& query, std::uint8_t* apart) = 0;
  /// Volumes posed, of all bodies, since this was asked last. O(nodes) a body.
  virtual std::size_t newly_posed() = 0;

  /// One traversal of a pair, by what is kept of it.
  virtual TraversalStatistics traverse(const ObjectPair&, Query&, NoFront, Start) = 0;
  virtual TraversalStatistics traverse(const ObjectPair&, Query&, NoFrontBoth, Start) = 0;
  virtual TraversalStatistics traverse(const ObjectPair&, Query&, Front&) = 0;
  virtual TraversalStatistics traverse(const ObjectPair&, Query&, RisingFront&) = 0;
  virtual TraversalStatistics traverse(const ObjectPair&, Query&, const KeptMargins&) = 0;
};

/// See BodyPair.
template <class QueryType, class Counter>
class AnyPair {
 public:
  using Query = QueryType;

  AnyPair(BodyLoops<Query>& bodies, MovingBody& a, MovingBody& b, const ObjectPair& pair,
          Query& query, Counter& counter)
      : bodies_(bodies), a_(a), b_(b), pair_(pair), query_(query), counter_(counter) {}

  MovingBody& a() const { return a_; }
  MovingBody& b() const { return b_; }
  Query& query() const { return query_; }

  template <class Roots = NoFront>
  TraversalStatistics from_roots(Start start = Start::roots) const {
    return counted(bodies_.traverse(pair_, query_, Roots{}, start));
  }
  template <class Front>
  TraversalStatistics from_front(Front&& front) const {
    return counted(bodies_.traverse(pair_, query_, front));
  }

 private:
  TraversalStatistics counted(const TraversalStatistics& statistics) const {
    counter_.tested(statistics.volumes);
    counter_.primitives(statistics.triangles);
    return statistics;
  }

  BodyLoops<Query>& bodies_;
  MovingBody& a_;
  MovingBody& b_;
  const ObjectPair& pair_;
  Query& query_;
  Counter& counter_;
};

/// The bodies, as `AllPairsOf` and `StrategyPairs` take them.
template <class Query, class Counter>
class AnyBodies {
 public:
  static constexpr bool culls_in_batches = true;

  explicit AnyBodies(std::unique_ptr<BodyLoops<Query>> loops) : loops_(std::move(loops)) {
    for (std::size_t i = 0; i < loops_->size(); ++i) bodies_.push_back(&loops_->body(i));
  }

  std::size_t size() const { return bodies_.size(); }
  const TriangleMesh& mesh(std::size_t i) const { return loops_->mesh(i); }
  void make_room() { loops_->make_room(); }
  void move(std::size_t i, const Pose& pose, const Vec3<double>& origin) {
    loops_->move(i, pose, origin);
  }
  void move(std::span<const Pose> poses, const Vec3<double>& origin) {
    loops_->move(poses, origin);
  }
  AnyPair<Query, Counter> pair(const ObjectPair& pair, Query& query, Counter& counter) {
    return {*loops_, *bodies_[pair.i], *bodies_[pair.j], pair, query, counter};
  }
  void cull_roots(std::span<const ObjectPair> pairs, std::span<const std::uint32_t> fresh,
                  Query& query, Counter&, std::uint8_t* apart) {
    loops_->cull_roots(pairs, fresh, query, apart);
  }
  /// Counts what has been posed since this was called last.
  void count_posed(Counter& counter) {
    if constexpr (Counter::counts) counter.posed(loops_->newly_posed());
  }

 private:
  std::unique_ptr<BodyLoops<Query>> loops_;
  std::vector<MovingBody*> bodies_;
};

}  // namespace bvlab
