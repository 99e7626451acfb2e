// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/named_mesh.hpp"

#include <algorithm>
#include <cstdio>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "experiments/scenes/read_mesh.hpp"
#include "experiments/scenes/simplify_mesh.hpp"

namespace bvlab {
namespace {

constexpr const char* stand_in = "bumpy-sphere";

bool is_formula(const std::string& name) {
  return std::any_of(formula_meshes().begin(), formula_meshes().end(),
                     [&](const FormulaMesh& entry) { return entry.name == name; });
}

std::string source_of(const std::string& name) { return name == "bunny" ? "bunny00" : name; }

}  // namespace

std::filesystem::path mesh_directory() { return BVLAB_MESH_DIRECTORY; }

NamedMesh named_mesh(const std::string& name, std::size_t polygons,
                     const std::filesystem::path& directory) {
  if (is_formula(name)) return {name, formula_mesh(name, polygons)};
  if (polygons < 4 || polygons > most_polygons)
    throw Unusable(std::to_string(polygons) + " polygons: must be 4 to " +
                   std::to_string(most_polygons));
  const auto source = directory / (source_of(name) + ".off");
  const auto kept = directory / (name + "-" + std::to_string(polygons) + ".off");
  const bool plain = !name.empty() && name.find('/') == std::string::npos;
  if (plain && std::filesystem::exists(kept)) return {name, read_mesh(kept)};
  if (plain && std::filesystem::exists(source)) {
    NamedMesh result{name, simplified(read_mesh(source), polygons)};
    write_off(kept, result.mesh);
    return result;
  }
  if (name != "bunny")
    throw Unusable("no mesh '" + name + "'; there are bunny, " + formula_mesh_names() +
                   ", and the files of " + directory.string());
  std::fprintf(stderr, "bvlab: no %s: a %s stands in for the bunny\n", source.c_str(), stand_in);
  return {stand_in, formula_mesh(stand_in, polygons)};
}

}  // namespace bvlab
