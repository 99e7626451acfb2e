// SPDX-License-Identifier: BSD-3-Clause
/// Bodies whose volume is chosen by name while the program runs. Volumes and strategies meet here,
/// so that neither is compiled for the other: one call through a pointer starts a traversal, and
/// inside it everything is a template as in `Bodies`. A loop is found by the kind of front that it
/// starts from, so that none of them is named here.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <tuple>
#include <type_traits>
#include <typeinfo>
#include <utility>
#include <vector>

#include "experiments/replay/hierarchies_by_mesh.hpp"
#include "traversal/body_pair.hpp"
#include "traversal/fronts.hpp"
#include "traversal/shape.hpp"

namespace bvlab {

/// A function, to be cast to what it is.
using AnyLoop = void (*)();

/// Bodies of a volume that is known inside alone. What is not documented here is as in `Bodies` and
/// `BodyPair`. Nothing is counted inside: each traversal says what it tested, and how many volumes
/// were posed can be told afterwards, so the loops are compiled once for both ways to count.
template <class Query>
class BodyLoops {
 public:
  virtual ~BodyLoops() = default;
  virtual std::size_t size() const = 0;
  virtual Frame frame() const = 0;
  virtual const TriangleMesh& mesh(std::size_t i) const = 0;
  virtual MovingBody& body(std::size_t i) = 0;
  virtual void add(const OneOfHierarchies& of_mesh) = 0;
  virtual void make_room() = 0;
  virtual void set_sharing(Sharing sharing) = 0;
  virtual void move(std::size_t i, const Pose& pose, const Vec3<double>& origin) = 0;
  virtual void move(std::span<const Pose> poses, const Vec3<double>& origin) = 0;
  virtual void cull_roots(std::span<const ObjectPair> pairs, std::span<const std::uint32_t> fresh,
                          Query& query, std::uint8_t* apart) = 0;
  /// Volumes posed into the world, of all bodies, since this was asked last. O(nodes) a body.
  virtual std::size_t newly_posed() = 0;
  /// The loop from that kind of front, a Loop; null where it was not compiled with the bodies.
  virtual AnyLoop loop(const std::type_info& front) const = 0;
};

/// One traversal of a pair, from one kind of front.
template <class Query, class Front>
using Loop = TraversalStatistics (*)(BodyLoops<Query>&, const ObjectPair&, Query&, Front&);

/// The loops that a strategy starts, found once by the kinds of its fronts.
template <class Query, class Fronts>
class LoopsFrom;
template <class Query, class... Fronts>
class LoopsFrom<Query, TypeList<Fronts...>> {
 public:
  /// `find(front)` gives the loop from that kind of front; null where it was not compiled.
  template <class Find>
  explicit LoopsFrom(Find&& find)
      : loops_(reinterpret_cast<Loop<Query, Fronts>>(find(typeid(Fronts)))...) {}

  template <class Front>
  Loop<Query, Front> from() const {
    static_assert((std::is_same_v<Front, Fronts> || ...),
                  "a strategy must list its own kinds of front: using OwnFronts = TypeList<...>");
    return std::get<Loop<Query, Front>>(loops_);
  }

 private:
  std::tuple<Loop<Query, Fronts>...> loops_;
};

/// See BodyPair.
template <class QueryType, class Counter, class Fronts>
class AnyPair {
 public:
  using Query = QueryType;

  AnyPair(const LoopsFrom<Query, Fronts>& loops, BodyLoops<Query>& bodies, MovingBody& a,
          MovingBody& b, const ObjectPair& pair, Query& query, Counter& counter)
      : loops_(loops),
        bodies_(bodies),
        a_(a),
        b_(b),
        pair_(pair),
        query_(query),
        counter_(counter) {}

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
    const auto loop = loops_.template from<std::remove_cvref_t<Front>>();
    const TraversalStatistics statistics = loop(bodies_, pair_, query_, front);
    counter_.tested(statistics.volumes);
    if constexpr (Counter::counts)
      if (bodies_.frame() == Frame::body || a_.is_far() || b_.is_far())
        counter_.posed(statistics.volumes);
    counter_.primitives(statistics.triangles);
    return statistics;
  }

 private:
  const LoopsFrom<Query, Fronts>& loops_;
  BodyLoops<Query>& bodies_;
  MovingBody& a_;
  MovingBody& b_;
  const ObjectPair& pair_;
  Query& query_;
  Counter& counter_;
};

/// The bodies, as `AllPairsOf` and `StrategyPairs` take them, for strategies with such fronts.
template <class Query, class Counter, class Fronts = bvlab::Fronts>
class AnyBodies {
 public:
  static constexpr bool culls_in_batches = true;

  explicit AnyBodies(std::unique_ptr<BodyLoops<Query>> bodies)
      : AnyBodies(std::move(bodies), [](const std::type_info&) { return nullptr; }) {}
  /// `find(front)` gives loops that were not compiled with the bodies; null where there is none.
  template <class Find>
  AnyBodies(std::unique_ptr<BodyLoops<Query>> bodies, Find&& find)
      : loops_(std::move(bodies)), from_([&](const std::type_info& front) {
          const AnyLoop loop = loops_->loop(front);
          return loop ? loop : find(front);
        }) {
    for (std::size_t i = 0; i < loops_->size(); ++i) bodies_.push_back(&loops_->body(i));
  }

  std::size_t size() const { return bodies_.size(); }
  const TriangleMesh& mesh(std::size_t i) const { return loops_->mesh(i); }
  const Vec3<double>& mesh_origin(std::size_t i) const { return bodies_[i]->extent().origin; }
  void add(const OneOfHierarchies& of_mesh) {
    loops_->add(of_mesh);
    // Bodies may have gone elsewhere.
    if (!bodies_.empty() && bodies_[0] != &loops_->body(0)) bodies_.clear();
    for (std::size_t i = bodies_.size(); i < loops_->size(); ++i)
      bodies_.push_back(&loops_->body(i));
  }
  void make_room() { loops_->make_room(); }
  void set_sharing(Sharing sharing) { loops_->set_sharing(sharing); }
  void move(std::size_t i, const Pose& pose, const Vec3<double>& origin) {
    loops_->move(i, pose, origin);
  }
  void move(std::span<const Pose> poses, const Vec3<double>& origin) {
    loops_->move(poses, origin);
  }
  AnyPair<Query, Counter, Fronts> pair(const ObjectPair& pair, Query& query, Counter& counter) {
    return {from_, *loops_, *bodies_[pair.i], *bodies_[pair.j], pair, query, counter};
  }
  void cull_roots(std::span<const ObjectPair> pairs, std::span<const std::uint32_t> fresh,
                  Query& query, Counter& counter, std::uint8_t* apart) {
    if constexpr (Counter::counts) {
      const auto is_far = [&](std::size_t i) { return bodies_[i]->is_far(); };
      if (loops_->frame() == Frame::body)
        counter.posed(fresh.size());
      else if (std::any_of(bodies_.begin(), bodies_.end(), [](auto* b) { return b->is_far(); }))
        counter.posed(static_cast<std::uint64_t>(std::count_if(
            fresh.begin(), fresh.end(),
            [&](std::uint32_t p) { return is_far(pairs[p].i) || is_far(pairs[p].j); })));
    }
    loops_->cull_roots(pairs, fresh, query, apart);
  }
  /// Counts what has been posed since this was called last.
  void count_posed(Counter& counter) {
    if constexpr (Counter::counts) counter.posed(loops_->newly_posed());
  }

 private:
  std::unique_ptr<BodyLoops<Query>> loops_;
  LoopsFrom<Query, Fronts> from_;
  std::vector<MovingBody*> bodies_;
};

}  // namespace bvlab
