// SPDX-License-Identifier: BSD-3-Clause
/// A scene of many moving bodies: a broad phase and a configuration for pairs. See world_of.hpp.
#pragma once

#include <span>
#include <type_traits>
#include <utility>

#include "broadphase/methods/auto.hpp"
#include "traversal/recommended.hpp"
#include "traversal/strategy_pairs.hpp"
#include "traversal/world_of.hpp"

namespace bvlab {

/// `World(shapes)`, with shapes of type `Recommended::Shape`, is the recommended configuration;
/// meshes and hierarchies must outlive it. recommended_for.hpp has others, and a choice among them.
/// Any other configuration is named by the type of its pairs: `World<StrategyPairs<Bodies<B, V>,
/// Strategy>>({shapes, strategy})`.
template <class Pairs = Recommended::Pairs, class Method = Auto<float, Closed>>
class World : public WorldOf<Pairs, Method> {
 public:
  /// The scene is empty at first. Bodies enter it when they are moved, and can be taken out again.
  explicit World(std::type_identity_t<Pairs> pairs, int threads = 1)
      : WorldOf<Pairs, Method>(std::move(pairs), threads) {}
  explicit World(std::span<const Recommended::Shape> shapes, int threads = 1)
    requires std::is_same_v<Pairs, Recommended::Pairs>
      : World(Pairs(shapes), threads) {}
};

World(std::span<const Recommended::Shape>) -> World<>;
World(std::span<const Recommended::Shape>, int) -> World<>;

}  // namespace bvlab
