// SPDX-License-Identifier: BSD-3-Clause
/// Whole scenes: see world_of.hpp for what they cost and offer.
#pragma once

#include <span>
#include <type_traits>
#include <utility>

#include "broadphase/methods/auto.hpp"
#include "traversal/recommended.hpp"
#include "traversal/strategy_pairs.hpp"
#include "traversal/world_of.hpp"

namespace bvlab {

/// `World(shapes)`, of `Recommended::Shape`, is what is best where nothing is known; meshes and
/// hierarchies must outlive it. Any others by what their pairs are:
/// `World<StrategyPairs<Bodies<B, V>, Strategy>>({shapes, strategy})`.
template <class Pairs = Recommended::Pairs, class Method = Auto<float, Closed>>
class World : public WorldOf<Pairs, Method> {
 public:
  /// What is not there yet may be moved into the scene later, and taken out again.
  explicit World(std::type_identity_t<Pairs> pairs, int threads = 1)
      : WorldOf<Pairs, Method>(std::move(pairs), threads) {}
  explicit World(std::span<const Recommended::Shape> shapes,
                 int threads = 1) requires std::is_same_v<Pairs, Recommended::Pairs>
      : World(Pairs(shapes), threads) {}
};

World(std::span<const Recommended::Shape>)->World<>;
World(std::span<const Recommended::Shape>, int)->World<>;

}  // namespace bvlab
