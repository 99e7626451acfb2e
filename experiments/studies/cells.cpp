// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/studies/cells.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <type_traits>

#include "experiments/files/numbers.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/peers/peers.hpp"
#include "experiments/replay/configurations.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/replay/touches_any.hpp"
#include "experiments/replay/variant_parameters.hpp"
#include "experiments/scenes/named_mesh.hpp"
#include "experiments/scenes/pair_files.hpp"
#include "experiments/scenes/public/public_scenes.hpp"
#include "experiments/scenes/scenes.hpp"

namespace bvlab {
namespace {

template <class T>
T number(const std::string& name, const std::string& text) {
  if (const auto value = number_in<T>(text)) return *value;
  throw Unusable(name + " = " + text + ": not a number of its kind");
}

struct SettingOption {
  const Cell& cell;
  void operator()(std::string_view name, std::string& value, std::string_view) const {
    if (!cell[name].empty()) value = cell[name];
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
    if (!is_of_variant(name)) key.append(name).append("=").append(value).append(";");
  return key;
}

/// As many as the kernel over siblings has lanes.
std::uint32_t native_fan_out(const Cell& cell) {
  Variant native;
  set_kernel(native, cell["kernel"] == "gathered" ? "siblings" : cell["kernel"]);
  return native.fan_out;
}

/// A cell's row holds what its configuration says.
void spell_out(Cell& cell, const Variant& variant) {
  visit_parameters(variant,
                   [&](std::string_view key, const auto& said, std::string_view, SetBy by) {
                     if (by == SetBy::configuration)
                       for (auto& [name, value] : cell.parameters)
                         if (name == key) value = text_of(said);
                   });
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
  if (is_public_scene(cell["scene"])) return require_public_scene(cell["scene"]);
  if (!known) throw Unusable("no scene '" + cell["scene"] + "'; available: " + Scenes::names());
}

/// A public scene's meshes and motion, by name.
PublicMotion public_motion_of(const Cell& cell) {
  const auto touches = [](std::span<const TriangleMesh> meshes) {
    return touches_any(meshes, meshes.size());
  };
  return public_motion(cell["scene"], "", {number<std::size_t>("frames", cell["frames"]), touches});
}

bool has_own_meshes(const std::string& scene) {
  bool own = is_public_scene(scene);
  Scenes::with(scene, [&]<class S>(std::type_identity<S>) { own = HasOwnMeshes<S>; });
  return own;
}

std::string most_triangles(std::span<const TriangleMesh> meshes) {
  std::size_t most = 0;
  for (const auto& each : meshes) most = std::max(most, each.triangles.size());
  return std::to_string(most);
}

/// Replaces parameters of each cell by those that `found(cell)` says, once for cells of the same
/// `key(cell)`. An empty key leaves a cell as it is.
template <class Key, class Found>
void fill(std::vector<Cell>& cells, const Key& key, const Found& found) {
  std::map<std::string, Settings> known;
  for (auto& cell : cells) {
    const std::string of = key(cell);
    if (of.empty()) continue;
    auto& held = known[of];
    if (held.empty()) held = found(cell);
    for (auto& [name, value] : cell.parameters)
      for (const auto& [known_name, text] : held)
        if (name == known_name) value = text;
  }
}

/// Some scenes bring their meshes: a record says how many, and the most triangles of one.
void set_meshes_of_scenes(std::vector<Cell>& cells) {
  const auto key = [](const Cell& cell) {
    return has_own_meshes(cell["scene"]) ? trace_key(cell) : "";
  };
  fill(cells, key, [](const Cell& cell) -> Settings {
    const auto meshes = prepared(cell).meshes;
    return {{"mesh", cell["scene"]},
            {"objects", std::to_string(meshes.size())},
            {"polygons", most_triangles(meshes)}};
  });
}

/// Of a recorded motion that is taken whole, a record says how long it is and how many bodies it
/// has.
void set_lengths_of_recordings(std::vector<Cell>& cells) {
  const auto key = [](const Cell& cell) {
    const bool is_whole =
        cell["scene"] == Recorded::name && (cell["objects"] == "0" || cell["frames"] == "0");
    return is_whole ? cell["objects"] + "/" + cell["frames"] + "/" + cell["trace"] : "";
  };
  fill(cells, key, [](const Cell& cell) -> Settings {
    const Trace trace = read_trace(cell["trace"]);
    const auto length = [&](const char* name, std::size_t held) {
      return Setting{name, cell[name] == "0" ? std::to_string(held) : cell[name]};
    };
    return {length("objects", trace.objects), length("frames", trace.frames)};
  });
}

/// As the cell's parameters say before they are spelled out: a configuration's replace them.
Variant configured_variant_of(const Cell& cell) {
  const Variant variant = variant_of(cell);
  return cell["configuration"].empty() ? variant : configured(variant, cell["configuration"]);
}

/// Of a mesh from a file a record says what it has, and not what a mesh by name would have had: the
/// most triangles of those in the list.
void set_polygons_of_files(std::vector<Cell>& cells) {
  const auto key = [](const Cell& cell) {
    return names_files(cell["mesh"]) && !has_own_meshes(cell["scene"]) ? cell["mesh"] : "";
  };
  fill(cells, key, [](const Cell& cell) -> Settings {
    return {{"polygons", most_triangles(meshes_of(cell))}};
  });
}

}  // namespace

bool is_of_variant(const std::string& name) {
  bool is_one = name == "peer" || name == "configuration";
  visit_parameters(Variant{},
                   [&](std::string_view key, auto&&...) { is_one = is_one || name == key; });
  return is_one;
}

Variant variant_of(const Cell& cell) {
  Variant variant;
  const bool is_native = cell["fan_out"] == "native";
  visit_parameters(variant, [&]<class T>(std::string_view name, T& value, std::string_view, SetBy) {
    if constexpr (std::is_same_v<T, std::string>)
      value = cell[name];
    else if (name != "fan_out" || !is_native)
      value = number<T>(std::string(name), cell[name]);
  });
  if (is_native) variant.fan_out = native_fan_out(cell);
  return variant;
}

Variant reference_for(const std::string& query) {
  Variant variant;
  variant.query = query;
  variant.volume = name_or_first(variant.volume, volumes());
  variant.strategy = name_or_first(variant.strategy, strategies());
  return variant;
}

namespace {

/// The meshes and the motion, of all pairs.
Prepared prepared_motion(const Cell& cell) {
  Prepared ready;
  if (is_public_scene(cell["scene"])) {
    auto motion = public_motion_of(cell);
    for (auto& each : motion.meshes) ready.meshes.push_back(std::move(each.mesh));
    const auto& shape = motion.trace.shape;
    ready.trace = {shape[0], shape[1], std::move(motion.trace.data)};
    return ready;
  }
  with_scene(cell, [&]<class S>(const S& scene) {
    if constexpr (HasOwnMeshes<S>)
      for (auto& each : scene.own_meshes()) ready.meshes.push_back(std::move(each.mesh));
    else
      ready.meshes = meshes_of(cell);
    std::vector<Extent> extents;
    extents.reserve(ready.meshes.size());
    for (const auto& mesh : ready.meshes) extents.push_back(extent_of(mesh));
    auto array = scene.generate(
        extents, HasOwnMeshes<S> ? TouchesAny() : touches_any(ready.meshes, scene.objects));
    ready.trace = {array.shape[0], array.shape[1], std::move(array.data)};
  });
  return ready;
}

PairArrays pair_arrays_of(const Cell& cell) {
  return read_pair_arrays({cell["asked_pairs"], cell["without_pairs"], cell["groups"]});
}

}  // namespace

Prepared prepared(const Cell& cell) {
  Prepared ready = prepared_motion(cell);
  ready.trace.chosen = chosen_from(pair_arrays_of(cell), ready.trace.objects);
  return ready;
}

void check(const Cell& cell) {
  Variant variant = configured_variant_of(cell);
  // A peer has none of our volumes, so the default one need not be compiled.
  if (!cell["peer"].empty() && variant.volume == Variant{}.volume)
    variant.volume = name_or_first(variant.volume, volumes());
  check(variant);
  number<std::size_t>("polygons", cell["polygons"]);
  with_scene(cell, [](const auto& scene) {
    if constexpr (requires { scene.check(); }) scene.check();
  });
  pair_arrays_of(cell);
  // Of other scenes, too: what is no number is a slip of the pen.
  Scenes::for_each([&]<class S>(std::type_identity<S>) { S{}.visit_options(SettingOption{cell}); });
  if (!cell["peer"].empty() && !peer(cell["peer"]) && !is_absent_peer(cell["peer"]))
    throw Unusable("no peer '" + cell["peer"] + "'; available: " + peer_names());
}

bool has_answer(const Cell& cell) {
  if (cell["peer"].empty()) return true;
  const Peer* const other = peer(cell["peer"]);
  return other && other->answers(cell["query"]);
}

std::vector<Cell> cells_with_answers(const Definition& definition, AbsentPeers absent) {
  std::vector<Cell> cells;
  std::set<Settings> replaced;
  for (Cell& cell : cells_of(definition)) {
    const bool is_kept = absent == AbsentPeers::kept && is_absent_peer(cell["peer"]);
    if (!has_answer(cell) && !is_kept) continue;
    const bool of_peer = !cell["peer"].empty();
    if (of_peer) {
      for (auto& [name, value] : cell.parameters)
        if (is_of_variant(name) && name != "peer" && name != "query") value.clear();
    } else if (!cell["configuration"].empty() || cell["fan_out"] == "native") {
      spell_out(cell, configured_variant_of(cell));
    }
    if (of_peer || !cell["configuration"].empty()) {
      Settings all = cell.labels;
      all.insert(all.end(), cell.parameters.begin(), cell.parameters.end());
      if (!replaced.insert(std::move(all)).second) continue;
    }
    cells.push_back(std::move(cell));
  }
  set_lengths_of_recordings(cells);
  set_meshes_of_scenes(cells);
  set_polygons_of_files(cells);
  return cells;
}

ReplayResult answered(const Prepared& ready, const Cell& cell, const ReplayOptions& options) {
  if (const Peer* const other = peer(cell["peer"]))
    return other->replay(ready.meshes, ready.trace, cell["query"], options);
  Variant variant = variant_of(cell);
  variant.chooses_in_turn = cell["configuration"] == "recommended";
  ReplayResult result = replay(ready.meshes, ready.trace, variant, options);
  result.build_seconds += result.choosing_seconds;
  return result;
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
