// SPDX-License-Identifier: BSD-3-Clause
/// A whole scene that says which pairs touch, over pairs of any kind.
#pragma once

#include <utility>

#include "experiments/replay/near_boxes.hpp"
#include "experiments/replay/triangle_test.hpp"
#include "experiments/replay/world_frames.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries/query.hpp"
#include "traversal/world_of.hpp"

namespace bvlab {

namespace detail {

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

  void choose(const PairChoice& choice) override { world_.choose(choice); }
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
