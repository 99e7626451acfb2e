// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/named_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "experiments/files/numbers.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/scenes/cgal_meshes.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "experiments/scenes/read_mesh.hpp"
#include "experiments/scenes/text_scanner.hpp"

namespace bvlab {
namespace {

constexpr const char* stand_in = "bumpy-sphere";

bool is_formula(const std::string& name) {
  return std::any_of(formula_meshes().begin(), formula_meshes().end(),
                     [&](const FormulaMesh& entry) { return entry.name == name; });
}

constexpr std::string_view hull_suffix = "-hull";

template <class T>
T number(std::string_view text, const std::string& whole) {
  if (const auto value = number_in<T>(text)) return *value;
  throw Unusable("mesh '" + whole + "': '" + std::string(text) + "' is not a number of its kind");
}

/// Cut at every `separator`.
std::vector<std::string> parts_of(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

bool is_file(const std::string& text) {
  return text.find('/') != text.npos || text.substr(0, text.find(':')).find('.') != text.npos;
}

/// FILE or FILE:SCALE. A file's name may have colons in it.
NamedMesh from_file(const std::string& text) {
  std::string file = text;
  ReadOptions options;
  std::error_code none;
  const auto colon = text.rfind(':');
  double scale = 1;
  if (colon != text.npos && !std::filesystem::exists(text, none) &&
      TextScanner::parse(std::string_view(text).substr(colon + 1), scale)) {
    file = text.substr(0, colon);
    options.scale = scale;
  }
  NamedMesh result{std::filesystem::path(file).stem().string(), read_mesh(file, options)};
  say_if_nothing_is_culled(result.mesh, text);
  return result;
}

NamedMesh from_text(const std::string& text, std::size_t polygons) {
  const auto parts = parts_of(text, ':');
  if (parts.empty()) throw Unusable("mesh: a name is needed");
  if (is_file(text)) return from_file(text);
  if (parts.size() > 3) throw Unusable("mesh '" + text + "': must be NAME[:POLYGONS[:SCALE]]");
  if (parts.size() > 1) polygons = number<std::size_t>(parts[1], text);
  NamedMesh result = named_mesh(parts[0], polygons);
  if (parts.size() > 2) {
    const double scale = number<double>(parts[2], text);
    if (!(scale > 0) || !std::isfinite(scale))
      throw Unusable("mesh '" + text + "': the scale must be above 0");
    for (auto& vertex : result.mesh.vertices) vertex *= scale;
    say_if_nothing_is_culled(result.mesh, text);
  }
  return result;
}

/// A file's name may have commas in it.
std::vector<std::string> entries_of(const std::string& list) {
  std::error_code none;
  if (is_file(list) && std::filesystem::is_regular_file(list, none)) return {list};
  auto parts = parts_of(list, ',');
  for (auto& part : parts) {
    part.erase(part.find_last_not_of(" \t") + 1);
    part.erase(0, part.find_first_not_of(" \t"));
  }
  return parts;
}

std::string source_of(const std::string& name) { return name == "bunny" ? "bunny00" : name; }

}  // namespace

std::filesystem::path mesh_directory() { return BVLAB_MESH_DIRECTORY; }

NamedMesh named_mesh(const std::string& name, std::size_t polygons,
                     const std::filesystem::path& directory) {
  if (name.ends_with(hull_suffix)) {
    const auto [whole, mesh] =
        named_mesh(name.substr(0, name.size() - hull_suffix.size()), polygons, directory);
    return {whole + std::string(hull_suffix), convex_hull(mesh)};
  }
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
    throw Unusable("no mesh '" + name + "'; available: bunny, " + formula_mesh_names() +
                   ", and the files of " + directory.string());
  std::fprintf(stderr, "bvlab: no %s: a %s stands in for the bunny\n", source.c_str(), stand_in);
  return {stand_in, formula_mesh(stand_in, polygons)};
}

bool names_files(const std::string& list) {
  const auto parts = entries_of(list);
  return std::any_of(parts.begin(), parts.end(), is_file);
}

std::vector<NamedMesh> named_meshes(const std::string& list, std::size_t polygons) {
  std::vector<NamedMesh> meshes;
  for (const auto& text : entries_of(list)) meshes.push_back(from_text(text, polygons));
  if (meshes.empty()) throw Unusable("mesh: a name is needed");
  return meshes;
}

}  // namespace bvlab
