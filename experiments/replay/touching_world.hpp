// SPDX-License-Identifier: BSD-3-Clause
/// A whole scene that says which pairs touch, over pairs of any kind.
#pragma once

#include <memory>
#include <utility>

#include "experiments/replay/any_pairs.hpp"
#include "experiments/replay/near_boxes.hpp"
#include "experiments/replay/world_frames.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries/query.hpp"
#include "traversal/world_of.hpp"

namespace bvlab {

namespace detail {

template <AnswersYesOrNo Query>
class TouchingWorld final : public WorldEngine {
 public:
  TouchingWorld(std::unique_ptr<AnyPairs<Query>> pairs, const QueryOptions& how, int threads)
      : world_(PairsAsked<Query>(std::move(pairs)), threads),
        asking_{.how = how, .touching = &touching_} {}
  TouchingWorld(const TouchingWorld&) = delete;
  TouchingWorld& operator=(const TouchingWorld&) = delete;

  void choose(const PairChoice& choice) override { world_.choose(choice); }
  void move(std::uint32_t object, const Pose& pose) override { world_.move(object, pose); }
  void add(const TriangleMesh& mesh) override { world_.add(mesh); }
  void remove(std::uint32_t object) override { world_.remove(object); }

  void update() override {
    NotCounting counter;
    world_.update(counter, asking_, asking_, [&](std::uint32_t slot) { touching_.drop(slot); });
  }

  std::span<const ObjectPair> touching() override { return touching_.pairs(); }
  std::size_t near() const override { return world_.near(); }
  std::size_t queried() const override { return world_.queried(); }

 private:
  WorldOf<PairsAsked<Query>, NearBoxes> world_;
  TouchingPairs touching_;
  Asking<Query> asking_;
};

}  // namespace detail

}  // namespace bvlab
