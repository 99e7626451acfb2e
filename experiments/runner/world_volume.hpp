// SPDX-License-Identifier: BSD-3-Clause
/// Whole scenes for one volume, compiled by itself: every strategy under it.
#pragma once

#include "experiments/runner/hierarchies_of.hpp"
#include "experiments/runner/strategy_text.hpp"
#include "experiments/runner/triangle_test.hpp"
#include "experiments/runner/worlds.hpp"
#include "hierarchies/volumes.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries/touching.hpp"
#include "traversal/strategies.hpp"
#include "traversal/world.hpp"

namespace bvlab {

namespace detail {

template <BoundingVolume V>
struct Hierarchies {
  std::vector<Hierarchy<V>> all;
  std::vector<Shape<V>> shapes;

  Hierarchies(std::span<const TriangleMesh> meshes, std::size_t objects, const Variant& variant)
      : all(hierarchies_of<V>(meshes, variant)) {
    for (std::size_t i = 0; i < objects; ++i)
      shapes.push_back({&meshes[i % meshes.size()], &all[i % all.size()]});
  }
};

template <BoundingVolume V, class Strategy>
class TouchingWorld final : public WorldEngine {
  using Lanes = NativeBatch<typename V::scalar>;

 public:
  TouchingWorld(Hierarchies<V> hierarchies, const Strategy& strategy, TriangleTest test)
      : hierarchies_(std::move(hierarchies)), world_(hierarchies_.shapes, strategy), test_(test) {}

  void move(std::uint32_t object, const Pose& pose) override { world_.move(object, pose); }

  void update() override {
    NotCounting counter;
    world_.update(
        counter, [&](const ObjectPair&) { return Touching(test_); },
        [&](std::uint32_t slot, const ObjectPair& pair, const Touching& query) {
          touching_.put(slot, pair, query.touching());
        },
        [&](std::uint32_t slot) { touching_.drop(slot); });
  }

  std::span<const ObjectPair> touching() override { return touching_.pairs(); }
  std::size_t near() const override { return world_.near(); }
  std::size_t asked() const override { return world_.asked(); }

 private:
  Hierarchies<V> hierarchies_;
  World<Lanes, V, Strategy> world_;
  TouchingPairs touching_;
  TriangleTest test_;
};

}  // namespace detail

template <BoundingVolume V>
std::unique_ptr<WorldEngine> make_world_of(std::span<const TriangleMesh> meshes,
                                           std::size_t objects, const Variant& variant) {
  const TriangleTest test = triangle_test(variant.precision);
  std::unique_ptr<WorldEngine> world;
  Strategies::with(name_of(variant.strategy), [&]<class Strategy>(std::type_identity<Strategy>) {
    world = std::make_unique<detail::TouchingWorld<V, Strategy>>(
        detail::Hierarchies<V>(meshes, objects, variant), made_from<Strategy>(variant.strategy),
        test);
  });
  return world;
}

}  // namespace bvlab
