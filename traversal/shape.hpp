// SPDX-License-Identifier: BSD-3-Clause
/// What the bodies of a scene are made of, and pairs of bodies by their indices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <ranges>
#include <span>
#include <vector>

#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// A mesh and the hierarchy over it.
template <class HierarchyType>
struct ShapeOver {
  const TriangleMesh* mesh;
  const HierarchyType* hierarchy;
};

/// The shapes of bodies of which body i has mesh i modulo the number of meshes. Meshes and
/// hierarchies must outlive them.
template <std::ranges::random_access_range Hierarchies>
auto shapes_over(std::span<const TriangleMesh> meshes, const Hierarchies& hierarchies,
                 std::size_t bodies) {
  std::vector<ShapeOver<std::ranges::range_value_t<Hierarchies>>> shapes;
  shapes.reserve(bodies);
  for (std::size_t i = 0; i < bodies; ++i)
    shapes.push_back({&meshes[i % meshes.size()], &hierarchies[i % meshes.size()]});
  return shapes;
}

/// Two bodies, by their indices; i < j.
struct ObjectPair {
  std::uint32_t i, j;
};

}  // namespace bvlab
