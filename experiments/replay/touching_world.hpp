// SPDX-License-Identifier: BSD-3-Clause
/// A whole scene that says which pairs touch, over pairs of any kind.
#pragma once

#include <memory>
#include <utility>

#include "experiments/replay/box_methods.hpp"
#include "experiments/replay/triangle_test.hpp"
#include "experiments/replay/world_frames.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries/query.hpp"
#include "traversal/world_of.hpp"

namespace bvlab {

namespace detail {

/// The broad phase of whole scenes, compiled once for all strategies.
class NearBoxes {
 public:
  explicit NearBoxes(const MethodSettings& settings)
      : method_(make_method<float>("auto", settings)) {}
  std::span<const Pair> overlapping(Boxes<float> boxes) { return method_->overlapping(boxes); }
  std::span<const Pair> update(Boxes<float> boxes, std::span<const std::uint32_t> moved) {
    return method_->update(boxes, moved);
  }
  PairChanges changes() const { return method_->changes(); }

 private:
  std::unique_ptr<AnyMethod<float>> method_;
};

/// `Hierarchies` holds those of all meshes; `of(mesh)` is what Pairs has for a body of a mesh, for
/// which it builds one that was not there.
template <class Pairs, AnswersYesOrNo Query, class Hierarchies>
class TouchingWorld final : public WorldEngine {
 public:
  /// `pairs` are of bodies over what `hierarchies` holds.
  TouchingWorld(Hierarchies hierarchies, Pairs pairs, const Variant& variant, int threads)
      : hierarchies_(std::move(hierarchies)),
        world_(std::move(pairs), threads),
        how_{triangle_test(variant.precision), 0} {}

  void move(std::uint32_t object, const Pose& pose) override { world_.move(object, pose); }
  void add(const TriangleMesh& mesh) override { world_.add(hierarchies_.of(mesh)); }
  void remove(std::uint32_t object) override { world_.remove(object); }

  void update() override {
    NotCounting counter;
    world_.update(
        counter, [&](const ObjectPair&) { return Query::from_options(how_); },
        [&](std::uint32_t slot, const ObjectPair& pair, const Query& query) {
          touching_.put(slot, pair, query.answer());
        },
        [&](std::uint32_t slot) { touching_.drop(slot); });
  }

  std::span<const ObjectPair> touching() override { return touching_.pairs(); }
  std::size_t near() const override { return world_.near(); }
  std::size_t queried() const override { return world_.queried(); }

 private:
  Hierarchies hierarchies_;
  WorldOf<Pairs, NearBoxes> world_;
  TouchingPairs touching_;
  QueryOptions how_;
};

}  // namespace detail

}  // namespace bvlab
