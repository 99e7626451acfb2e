// SPDX-License-Identifier: BSD-3-Clause
/// Pairs of one strategy under one query, over bodies of any volume: compiled by itself.
#pragma once

#include <memory>
#include <utility>

#include "experiments/replay/any_bodies.hpp"
#include "experiments/replay/any_pairs.hpp"
#include "experiments/replay/play_entry.hpp"
#include "experiments/replay/play_pairs.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/replay/strategy_text.hpp"
#include "traversal/strategy_pairs.hpp"

namespace bvlab {

namespace detail {

/// `hierarchies` are of the volume.
template <class Strategy, class Query>
std::unique_ptr<AnyPairs<Query>> strategy_pairs(const VolumeEntry& volume,
                                                std::shared_ptr<const AnyHierarchies> hierarchies,
                                                std::size_t objects, const Variant& variant) {
  using Pairs = StrategyPairs<AnyBodies<Query>, Strategy>;
  AnyBodies<Query> bodies(
      bodies_entry<Query>(volume.name).bodies(*hierarchies, objects, frame_of(variant)));
  return std::make_unique<PairsOver<Pairs, Query, HierarchiesByMesh>>(
      std::make_shared<HierarchiesByMesh>(volume, std::move(hierarchies), variant),
      Pairs(std::move(bodies), made_from<Strategy>(variant.strategy)));
}

template <class Strategy, class Query>
void play(const VolumeEntry& volume, std::shared_ptr<const AnyHierarchies> hierarchies,
          std::span<const TriangleMesh> meshes, const Trace& trace, const Variant& variant,
          const ReplayOptions& options, ReplayResult& result) {
  play_pairs(
      strategy_pairs<Strategy, Query>(volume, std::move(hierarchies), trace.objects, variant),
      meshes, trace, variant, options, result);
}

template <class Strategy, class Query>
std::unique_ptr<WorldEngine> world(const VolumeEntry& volume,
                                   std::shared_ptr<const AnyHierarchies> hierarchies,
                                   std::size_t objects, const Variant& variant, int threads) {
  return world_of_pairs(
      strategy_pairs<Strategy, Query>(volume, std::move(hierarchies), objects, variant), variant,
      threads);
}

}  // namespace detail

template <class Strategy, class Query>
constexpr PlayEntry play_of() {
  return {Strategy::name,
          Strategy::description,
          Query::name,
          Query::description,
          [](std::string_view text) { made_from<Strategy>(text); },
          detail::play<Strategy, Query>,
          detail::world<Strategy, Query>};
}

}  // namespace bvlab
