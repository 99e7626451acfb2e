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

/// The bodies, with the loops from some kinds of fronts.
template <BoundingVolume V, class Query>
class BodiesOver : public BodyLoops<Query> {
 public:
  BodiesOver(std::span<const Shape<V>> shapes, Frame frame) : bodies_(shapes, frame) {}

  BodyPair<NativeBatch<typename V::scalar>, V, Query, NotCounting> pair(const ObjectPair& pair,
                                                                        Query& query) {
    return bodies_.pair(pair, query, counter_);
  }

  std::size_t size() const override { return bodies_.size(); }
  Frame frame() const override { return bodies_.frame(); }
  const TriangleMesh& mesh(std::size_t i) const override { return bodies_.mesh(i); }
  MovingBody& body(std::size_t i) override { return bodies_[i]; }
  void add(const OneOfHierarchies& of_mesh) override {
    const auto& all = static_cast<const HierarchiesOf<V>&>(*of_mesh.hierarchies);
    bodies_.add(all.shape(of_mesh.mesh));
  }
  void make_room() override { bodies_.make_room(); }
  void set_sharing(Sharing sharing) override { bodies_.set_sharing(sharing); }
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

 private:
  struct Posed {
    std::uint32_t epoch = 0;
    std::size_t volumes = 0;
  };

  Bodies<NativeBatch<typename V::scalar>, V> bodies_;
  std::vector<Posed> told_;  // of each body, when it was asked last
  NotCounting counter_;
};

/// A Loop over bodies of that volume.
template <BoundingVolume V, class Query, class Front>
TraversalStatistics traverse_any(BodyLoops<Query>& bodies, const ObjectPair& pair, Query& query,
                                 Front& front) {
  return static_cast<BodiesOver<V, Query>&>(bodies).pair(pair, query).from_front(front);
}

template <BoundingVolume V, class Query, class... Fronts>
AnyLoop loop_from(const std::type_info& front, TypeList<Fronts...>) {
  AnyLoop found = nullptr;
  ((front == typeid(Fronts)
        ? void(found = reinterpret_cast<AnyLoop>(traverse_any<V, Query, Fronts>))
        : void()),
   ...);
  return found;
}

template <BoundingVolume V, class Query, class Fronts = bvlab::Fronts>
class LoopsOver final : public BodiesOver<V, Query> {
 public:
  using BodiesOver<V, Query>::BodiesOver;
  AnyLoop loop(const std::type_info& front) const override {
    return loop_from<V, Query>(front, Fronts{});
  }
};

template <BoundingVolume V, class Query>
std::unique_ptr<BodyLoops<Query>> loops_over(const AnyHierarchies& hierarchies, std::size_t objects,
                                             Frame frame) {
  return std::make_unique<LoopsOver<V, Query>>(
      static_cast<const HierarchiesOf<V>&>(hierarchies).shapes(objects), frame);
}

}  // namespace detail

template <BoundingVolume V, class Query>
constexpr LoopsEntry<Query> loops_for() {
  return {V::name, detail::loops_over<V, Query>};
}

/// Those from the strategy's own fronts alone.
template <BoundingVolume V, class Query, class Strategy>
constexpr OwnLoopsEntry<Query> own_loops_for() {
  return {V::name, [](const std::type_info& front) {
            return detail::loop_from<V, Query>(front, typename Strategy::OwnFronts{});
          }};
}

}  // namespace bvlab
