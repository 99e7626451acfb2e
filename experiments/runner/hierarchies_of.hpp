// SPDX-License-Identifier: BSD-3-Clause
/// What a variant says of hierarchies, made.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "experiments/runner/replay.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/hierarchy.hpp"

namespace bvlab {

/// What volumes over T are tested in: as many lanes as a register holds, where it holds four or
/// more.
template <class T>
using NativeBatch = Batch<T, std::max(native_width<T>, 4)>;

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
