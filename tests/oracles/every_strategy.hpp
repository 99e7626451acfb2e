// SPDX-License-Identifier: BSD-3-Clause
/// Every strategy on a scene, over binary trees of oriented boxes.
#pragma once

#include "tests/oracles/wide_scenes.hpp"
#include "traversal/strategies.hpp"

namespace bvlab {

/// Calls visit(engine, name) for each strategy, with an AllPairs of the scene's bodies.
template <class Visit>
void for_each_strategy(const Scene& scene, Visit&& visit) {
  using V = Obb<float>;
  std::vector<Hierarchy<V>> hierarchies;
  for (const auto& mesh : scene.meshes)
    hierarchies.emplace_back(mesh, builds::TopDownPrincipal::topology(mesh, 1));
  const auto shapes = shapes_over(scene.meshes, hierarchies, scene.frames[0].size());
  const auto pairs = all_object_pairs(static_cast<std::uint32_t>(shapes.size()));
  Strategies::for_each([&]<class Strategy>(std::type_identity<Strategy>) {
    AllPairs<Batch<float, 8>, V, Strategy> engine(shapes, pairs, Strategy{});
    visit(engine, Strategy::name);
  });
}

}  // namespace bvlab
