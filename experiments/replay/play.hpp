// SPDX-License-Identifier: BSD-3-Clause
/// Pairs of one strategy under one query, over bodies of any volume: compiled by itself.
#pragma once

#include <memory>
#include <utility>

#include "experiments/replay/any_bodies.hpp"
#include "experiments/replay/any_pairs.hpp"
#include "experiments/replay/play_entry.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/replay/strategy_text.hpp"
#include "traversal/strategy_pairs.hpp"

namespace bvlab {

namespace detail {

template <class Strategy, class Query>
std::unique_ptr<PairsUnderSome> strategy_pairs(PairsFrom& from, const Variant& variant) {
  using Pairs = StrategyPairs<AnyBodies<Query>, Strategy>;
  const VolumeEntry& volume = volume_entry(variant.volume);
  const auto hierarchies = from.trees<HierarchiesByMesh>(variant, [&] {
    return std::make_shared<HierarchiesByMesh>(volume, volume.hierarchies(from.meshes, variant),
                                               variant);
  });
  AnyBodies<Query> bodies(bodies_entry<Query>(volume.name)
                              .bodies(hierarchies->first(), from.objects, frame_of(variant)));
  return std::make_unique<PairsOver<Pairs, Query, HierarchiesByMesh>>(
      hierarchies, Pairs(std::move(bodies), made_from<Strategy>(variant.strategy)));
}

}  // namespace detail

template <class Strategy, class Query>
constexpr PlayEntry play_of() {
  return {Strategy::name,
          Strategy::description,
          Query::name,
          Query::description,
          [](std::string_view text) { made_from<Strategy>(text); },
          detail::strategy_pairs<Strategy, Query>};
}

}  // namespace bvlab
