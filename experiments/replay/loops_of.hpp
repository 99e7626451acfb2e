// SPDX-License-Identifier: BSD-3-Clause
/// The loops of one volume under one query, with whatever is kept of a run: the inner part of every
/// replay, and nearly all that takes time to compile.
#pragma once

#include <memory>

#include "experiments/replay/hierarchies_of.hpp"
#include "experiments/replay/loops_entry.hpp"
#include "experiments/replay/triangle_test.hpp"
#include "traversal/counters.hpp"

namespace bvlab {

namespace detail {

template <BoundingVolume V, class Query>
class LoopsOver final : public BodyLoops<Query> {
 public:
  LoopsOver(const AnyHierarchies& hierarchies, std::size_t objects)
      : bodies_(static_cast<const HierarchiesOf<V>&>(hierarchies).shapes(objects)) {}

  std::size_t size() const override { return bodies_.size(); }
  const TriangleMesh& mesh(std::size_t i) const override { return bodies_.mesh(i); }
  MovingBody& body(std::size_t i) override { return bodies_[i]; }
  void make_room() override { bodies_.make_room(); }
  void move(std::size_t i, const Pose& pose, const Vec3<double>& origin) override {
    bodies_.move(i, pose, origin);
  }
  void move(std::span<const Pose> poses, const Vec3<double>& origin) override {
    bodies_.move(poses, origin);
  }
  void cull_roots(std::span<const ObjectPair> pairs, std::span<const std::uint32_t> fresh,
                  Query& query, std::uint8_t* apart) override {
    bodies_.cull_roots(pairs, fresh, query, counter_, apart);
  }

  std::size_t newly_posed() override {
    std::size_t sum = 0;
    told_.resize(bodies_.size());
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const Posed now{bodies_[i].epoch(), bodies_[i].posed_volumes()};
      sum += now.volumes - (told_[i].epoch == now.epoch ? told_[i].volumes : 0);
      told_[i] = now;
    }
    return sum;
  }

  TraversalStatistics traverse(const ObjectPair& pair, Query& query, NoFront,
                               Start start) override {
    return bodies_.pair(pair, query, counter_).template from_roots<NoFront>(start);
  }
  TraversalStatistics traverse(const ObjectPair& pair, Query& query, NoFrontBoth,
                               Start start) override {
    return bodies_.pair(pair, query, counter_).template from_roots<NoFrontBoth>(start);
  }
  TraversalStatistics traverse(const ObjectPair& pair, Query& query, Front& front) override {
    return bodies_.pair(pair, query, counter_).from_front(front);
  }
  TraversalStatistics traverse(const ObjectPair& pair, Query& query, RisingFront& front) override {
    return bodies_.pair(pair, query, counter_).from_front(front);
  }
  TraversalStatistics traverse(const ObjectPair& pair, Query& query,
                               const KeptMargins& margins) override {
    return bodies_.pair(pair, query, counter_).from_front(margins);
  }

 private:
  struct Posed {
    std::uint32_t epoch = 0;
    std::size_t volumes = 0;
  };

  Bodies<NativeBatch<typename V::scalar>, V> bodies_;
  std::vector<Posed> told_;  // of each body, when it was asked last
  NotCounting counter_;
};

template <BoundingVolume V, class Query>
std::unique_ptr<BodyLoops<Query>> loops_over(const AnyHierarchies& hierarchies,
                                             std::size_t objects) {
  return std::make_unique<LoopsOver<V, Query>>(hierarchies, objects);
}

}  // namespace detail

template <BoundingVolume V, class Query>
constexpr LoopsEntry<Query> loops_for() {
  return {V::name, detail::loops_over<V, Query>};
}

}  // namespace bvlab
