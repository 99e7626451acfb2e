// SPDX-License-Identifier: BSD-3-Clause
/// What a variant says of hierarchies, made.
#pragma once

#include <span>
#include <vector>

#include "experiments/runner/replay.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/hierarchy.hpp"

namespace bvlab {

/// The variant's names have been checked.
inline Fit fit_of(const Variant& variant) {
  return variant.fit == "tight" ? Fit::tight : Fit::published;
}

/// One for each mesh.
template <BoundingVolume V>
std::vector<Hierarchy<V>> hierarchies_of(std::span<const TriangleMesh> meshes,
                                         const Variant& variant) {
  std::vector<Hierarchy<V>> hierarchies;
  hierarchies.reserve(meshes.size());
  Builds::with(variant.build, [&]<class Build>(std::type_identity<Build>) {
    for (const auto& mesh : meshes)
      hierarchies.emplace_back(mesh, Build::topology(mesh, variant.leaf_size), fit_of(variant));
  });
  return hierarchies;
}

}  // namespace bvlab
