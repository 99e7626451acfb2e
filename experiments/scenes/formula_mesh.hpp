// SPDX-License-Identifier: BSD-3-Clause
/// Meshes made by formula, for work without files: closed, oriented outward, about one unit in
/// radius round the origin, the same on every machine.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

struct FormulaMesh {
  std::string_view name;
  std::string_view description;
  /// The formula's mesh whose number of triangles is nearest to the wanted one.
  TriangleMesh (*make)(std::size_t polygons);
};

/// THE list of them.
std::span<const FormulaMesh> formula_meshes();

/// "box, torus, ..."
std::string formula_mesh_names();

/// A formula makes at most this many triangles.
inline constexpr std::size_t most_polygons = 50'000'000;

/// The mesh of that name. Throws Unusable where there is none (the message lists the names) or
/// where `polygons` is 0 or more than `most_polygons`.
TriangleMesh formula_mesh(std::string_view name, std::size_t polygons);

}  // namespace bvlab
