// SPDX-License-Identifier: BSD-3-Clause
/// Whole scenes over bodies of one volume: see world_of.hpp for what they cost and offer.
#pragma once

#include "broadphase/methods/auto.hpp"
#include "traversal/world_of.hpp"

namespace bvlab {

/// One body for each shape; meshes and hierarchies must outlive this. B is the scalar or batch in
/// which volumes are tested.
template <class B, BoundingVolume V, class Strategy, class Method = Auto<float, Closed>>
class World : public WorldOf<Bodies<B, V>, Strategy, Method> {
 public:
  World(std::span<const Shape<V>> shapes, const Strategy& strategy)
      : WorldOf<Bodies<B, V>, Strategy, Method>(shapes, strategy) {}
};

}  // namespace bvlab
