// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/studies/cells.hpp"

#include <algorithm>
#include <charconv>
#include <map>
#include <set>

#include "experiments/files/unusable.hpp"
#include "experiments/peers/peers.hpp"
#include "experiments/replay/configurations.hpp"
#include "experiments/replay/touches_any.hpp"
#include "experiments/scenes/named_mesh.hpp"
#include "experiments/scenes/scenes.hpp"

namespace bvlab {
namespace {

template <class T>
T number(const std::string& name, const std::string& text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size())
    throw Unusable(name + " = " + text + ": not a number of its kind");
  return value;
}

struct SettingOption {
  const Cell& cell;
  void operator()(std::string_view name, std::string& value, std::string_view) const {
    value = cell[name];
  }
  void operator()(std::string_view name, Length& value, std::string_view) const {
    try {
      value = length_from(cell[name]);
    } catch (const Unusable& fault) {
      throw Unusable(std::string(name), fault.what());
    }
  }
  template <class T>
  void operator()(std::string_view name, T& value, std::string_view) const {
    value = number<T>(std::string(name), cell[name]);
  }
};

std::string trace_key(const Cell& cell) {
  std::string key;
  for (const auto& [name, value] : cell.parameters)
    if (!is_of_variant(name)) key += name + "=" + value + ";";
  return key;
}

/// What a configuration says stands in the cell's row.
void spell_out(Cell& cell) {
  const Variant variant = variant_of(cell);
  for (const auto& [key, said] : Settings{{"volume", variant.volume},
                                          {"strategy", variant.strategy},
                                          {"build", variant.build},
                                          {"leaf_size", std::to_string(variant.leaf_size)},
                                          {"fit", variant.fit},
                                          {"tree", variant.tree}})
    for (auto& [name, value] : cell.parameters)
      if (name == key) value = said;
}

std::vector<TriangleMesh> meshes_of(const Cell& cell) {
  std::vector<TriangleMesh> meshes;
  for (auto& [name, mesh] :
       named_meshes(cell["mesh"], number<std::size_t>("polygons", cell["polygons"])))
    meshes.push_back(std::move(mesh));
  return meshes;
}

/// Calls `use` with the cell's scene, its options set.
template <class Use>
void with_scene(const Cell& cell, Use&& use) {
  const bool known = Scenes::with(cell["scene"], [&]<class S>(std::type_identity<S>) {
    S scene;
    scene.visit_options(SettingOption{cell});
    use(scene);
  });
  if (!known) throw Unusable("no scene '" + cell["scene"] + "'; there are " + Scenes::names());
}

/// Of a mesh from a file a record says what it has, and not what a mesh by name would have had: the
/// most triangles of those in the list.
void set_polygons_of_files(std::vector<Cell>& cells) {
  std::map<std::string, std::string> known;
  for (auto& cell : cells) {
    const std::string& mesh = cell["mesh"];
    if (!names_files(mesh)) continue;
    auto& polygons = known[mesh];
    if (polygons.empty()) {
      std::size_t most = 0;
      for (const auto& each : meshes_of(cell)) most = std::max(most, each.triangles.size());
      polygons = std::to_string(most);
    }
    for (auto& [name, value] : cell.parameters)
      if (name == "polygons") value = polygons;
  }
}

}  // namespace

bool is_of_variant(const std::string& name) {
  static const std::set<std::string> names{"volume", "strategy",  "query",        "build",
                                           "fit",    "leaf_size", "precision",    "relative_error",
                                           "tree",   "peer",      "configuration"};
  return names.contains(name);
}

Variant variant_of(const Cell& cell) {
  const Variant variant{cell["volume"],
                        cell["strategy"],
                        cell["query"],
                        cell["build"],
                        number<std::uint32_t>("leaf_size", cell["leaf_size"]),
                        cell["fit"],
                        cell["precision"],
                        number<double>("relative_error", cell["relative_error"]),
                        cell["tree"]};
  return cell["configuration"].empty() ? variant : configured(variant, cell["configuration"]);
}

Prepared prepared(const Cell& cell) {
  Prepared ready;
  ready.meshes = meshes_of(cell);
  std::vector<Extent> extents;
  for (const auto& mesh : ready.meshes) extents.push_back(extent_of(mesh));
  with_scene(cell, [&](const auto& scene) {
    auto array = scene.generate(extents, touches_any(ready.meshes, scene.objects));
    ready.trace = {array.shape[0], array.shape[1], std::move(array.data)};
  });
  return ready;
}

void check(const Cell& cell) {
  check(variant_of(cell));
  number<std::size_t>("polygons", cell["polygons"]);
  with_scene(cell, [](const auto& scene) {
    if constexpr (requires { scene.check(); }) scene.check();
  });
  // Of other scenes, too: what is no number is a slip of the pen.
  Scenes::for_each([&]<class S>(std::type_identity<S>) { S{}.visit_options(SettingOption{cell}); });
  if (!cell["peer"].empty() && !peer(cell["peer"]) && !is_absent_peer(cell["peer"]))
    throw Unusable("no peer '" + cell["peer"] + "'; there are " + peer_names());
}

bool has_answer(const Cell& cell) {
  if (cell["peer"].empty()) return true;
  const Peer* const other = peer(cell["peer"]);
  return other && other->answers(cell["query"]);
}

std::vector<Cell> cells_with_answers(const Definition& definition) {
  std::vector<Cell> cells;
  std::set<Settings> replaced;
  for (Cell& cell : cells_of(definition)) {
    if (!has_answer(cell)) continue;
    const bool of_peer = !cell["peer"].empty();
    if (of_peer) {
      for (auto& [name, value] : cell.parameters)
        if (is_of_variant(name) && name != "peer" && name != "query") value.clear();
    } else if (!cell["configuration"].empty()) {
      spell_out(cell);
    }
    if (of_peer || !cell["configuration"].empty()) {
      Settings all = cell.labels;
      all.insert(all.end(), cell.parameters.begin(), cell.parameters.end());
      if (!replaced.insert(std::move(all)).second) continue;
    }
    cells.push_back(std::move(cell));
  }
  set_polygons_of_files(cells);
  return cells;
}

ReplayResult answered(const Prepared& ready, const Cell& cell, const ReplayOptions& options) {
  if (const Peer* const other = peer(cell["peer"]))
    return other->replay(ready.meshes, ready.trace, cell["query"], options);
  return replay(ready.meshes, ready.trace, variant_of(cell), options);
}

std::vector<std::vector<std::size_t>> traces_of(const std::vector<Cell>& cells) {
  std::map<std::string, std::size_t> place;
  std::vector<std::vector<std::size_t>> traces;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto key = trace_key(cells[i]) + cells[i]["query"];
    const auto [found, is_new] = place.emplace(key, traces.size());
    if (is_new) traces.emplace_back();
    traces[found->second].push_back(i);
  }
  return traces;
}

}  // namespace bvlab
