// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/studies/experiment.hpp"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cstdio>
#include <map>
#include <random>
#include <set>
#include <thread>

#include "experiments/files/unusable.hpp"
#include "experiments/peers/disagreements.hpp"
#include "experiments/peers/peers.hpp"
#include "experiments/records/record.hpp"
#include "experiments/replay/coherence.hpp"
#include "experiments/replay/configurations.hpp"
#include "experiments/replay/replay.hpp"
#include "experiments/scenes/named_mesh.hpp"
#include "experiments/scenes/scenes.hpp"
#include "experiments/scenes/touches_any.hpp"

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

/// Parameters that say how a trace is answered; all the others say which trace it is.
bool is_of_variant(const std::string& name) {
  static const std::set<std::string> names{"volume", "strategy",  "query",        "build",
                                           "fit",    "leaf_size", "precision",    "relative_error",
                                           "tree",   "peer",      "configuration"};
  return names.contains(name);
}

std::string trace_key(const Cell& cell) {
  std::string key;
  for (const auto& [name, value] : cell.parameters)
    if (!is_of_variant(name)) key += name + "=" + value + ";";
  return key;
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

struct Prepared {
  std::vector<TriangleMesh> meshes;
  Trace trace;
};

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
  if (!cell["peer"].empty() && !peer(cell["peer"]) && !is_absent_peer(cell["peer"]))
    throw Unusable("no peer '" + cell["peer"] + "'; there are " + peer_names());
}

/// Not every peer answers every query, and not every one is compiled: such cells are left out.
bool has_answer(const Cell& cell) {
  if (cell["peer"].empty()) return true;
  const Peer* const other = peer(cell["peer"]);
  return other && other->answers(cell["query"]);
}

/// A peer has a volume, a strategy and so on of its own: what a cell says of ours is cleared. So is
/// a configuration's replaced. Cells that then say the same are one.
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
  return cells;
}

ReplayResult answered(const Prepared& ready, const Cell& cell, const ReplayOptions& options) {
  if (const Peer* const other = peer(cell["peer"]))
    return other->replay(ready.meshes, ready.trace, cell["query"], options);
  return replay(ready.meshes, ready.trace, variant_of(cell), options);
}

/// Calls `work(i)` for i < count on all cores.
template <class Work>
void side_by_side(std::size_t count, Work&& work) {
  std::atomic<std::size_t> next = 0;
  std::mutex guard;
  std::exception_ptr failure;
  const auto take = [&] {
    for (std::size_t i; (i = next++) < count;) try {
        work(i);
      } catch (...) {
        const std::lock_guard lock(guard);
        failure = std::current_exception();
      }
  };
  {
    std::vector<std::jthread> helpers;
    for (unsigned t = 1; t < std::min<std::size_t>(std::thread::hardware_concurrency(), count); ++t)
      helpers.emplace_back(take);
    take();
  }
  if (failure) std::rethrow_exception(failure);
}

std::string nanoseconds(double seconds) {
  return std::to_string(static_cast<std::int64_t>(seconds * 1e9 + 0.5));
}

class Experiment {
 public:
  Experiment(const Definition& definition, const std::filesystem::path& record)
      : definition_(definition),
        cells_(cells_with_answers(definition)),
        rows_(record / (definition.name + ".csv"),
              columns({"repetition", "time_ns", "first_ns", "build_ns", "pairs", "hits",
                       "differing", "n_u", "n_v", "n_p", "front"})),
        frames_(record / (definition.name + ".frames.csv"),
                axis_columns({"frame", "n_u", "n_v", "n_p", "front", "hits"})),
        disagreements_(record / (definition.name + ".disagreements.csv"),
                       axis_columns({"frame", "object_i", "object_j", "triangle_i", "triangle_j",
                                     "theirs", "ours", "exact"})),
        coherence_(record / (definition.name + ".coherence.csv"), coherence_columns()) {
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      auto& group = by_trace_[trace_key(cells_[i]) + cells_[i]["query"]];
      if (group.empty()) order_.push_back(&group);
      group.push_back(i);
    }
  }

  void run(const Progress& progress) {
    std::set<Row> done;
    for (const auto& row : rows_.rows())
      done.insert(Row(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(keys_)));
    std::size_t finished = 0;
    progress(0, order_.size());
    for (const auto* group : order_) {
      const bool all_there = std::all_of(group->begin(), group->end(), [&](std::size_t i) {
        return done.contains(key_row(cells_[i]));
      });
      if (!all_there) run_group(*group, done);
      progress(++finished, order_.size());
    }
  }

 private:
  /// Labels, then parameters, then what is measured.
  Row columns(std::initializer_list<const char*> measured) {
    Row row;
    for (const auto& [name, value] : cells_.at(0).labels) row.push_back(name);
    for (const auto& [name, value] : cells_.at(0).parameters) row.push_back(name);
    keys_ = row.size();
    row.insert(row.end(), measured.begin(), measured.end());
    return row;
  }

  /// Only what varies: a series is long.
  Row axis_columns(std::initializer_list<const char*> measured) const {
    Row row;
    for (const auto& axis : definition_.axes) row.push_back(axis.name);
    row.insert(row.end(), measured.begin(), measured.end());
    return row;
  }

  /// What says which trace it is, and what of a variant its front depends on.
  static bool matters_to_front(const std::string& name) {
    return !is_of_variant(name) || name == "volume" || name == "query" || name == "build" ||
           name == "leaf_size" || name == "fit";
  }
  static Row front_key(const Cell& cell) {
    Row row;
    for (const auto& [name, value] : cell.parameters)
      if (matters_to_front(name)) row.push_back(value);
    return row;
  }
  Row coherence_columns() const {
    Row row;
    for (const auto& [name, value] : cells_.at(0).parameters)
      if (matters_to_front(name)) row.push_back(name);
    for (const char* name :
         {"pair_runs", "near_runs", "moved_runs", "still_runs", "tests", "ends", "kept", "grown",
          "again", "still_ends", "motion_leaf", "motion_gap", "best_tests", "best_rebuilds"})
      row.push_back(name);
    return row;
  }

  void measure_coherence(const Prepared& ready, const std::vector<const Cell*>& cells) {
    std::map<Row, const Cell*> fronts;
    for (const Cell* cell : cells)
      if ((*cell)["peer"].empty() && (*cell)["tree"] == "binary" && (*cell)["query"] != "distance")
        fronts.emplace(front_key(*cell), cell);
    const std::vector<std::pair<Row, const Cell*>> all(fronts.begin(), fronts.end());
    std::vector<CoherenceSums> found(all.size());
    std::vector<std::optional<BestRebuilds>> best(all.size());
    side_by_side(all.size(), [&](std::size_t i) {
      const Variant variant = variant_of(*all[i].second);
      found[i] = coherence(ready.meshes, ready.trace, variant);
      if (definition_.measures.contains("best rebuilds"))
        best[i] = best_rebuilds(ready.meshes, ready.trace, variant);
    });
    for (std::size_t i = 0; i < all.size(); ++i) {
      const CoherenceSums& c = found[i];
      Row row = all[i].first;
      coherence_.forget(row);
      for (const auto n : {c.pair_runs, c.near_runs, c.moved_runs, c.still_runs, c.tests, c.ends,
                           c.kept, c.grown, c.again, c.still_ends})
        row.push_back(std::to_string(n));
      row.push_back(std::to_string(c.motion_leaf));
      row.push_back(std::to_string(c.motion_gap));
      row.push_back(best[i] ? std::to_string(best[i]->tests) : "");
      row.push_back(best[i] ? std::to_string(best[i]->rebuilds) : "");
      coherence_.add(std::move(row));
    }
    coherence_.save();
  }

  Row axis_row(const Cell& cell) const {
    Row row;
    for (const auto& axis : definition_.axes) row.push_back(cell[axis.name]);
    return row;
  }

  static Row key_row(const Cell& cell) {
    Row row;
    for (const auto* settings : {&cell.labels, &cell.parameters})
      for (const auto& [name, value] : *settings) row.push_back(value);
    return row;
  }

  bool wants_series(const Cell& cell) const {
    return definition_.has_series && cell["peer"].empty() &&
           std::all_of(definition_.series.begin(), definition_.series.end(),
                       [&](const Setting& s) { return cell[s.first] == s.second; });
  }

  void run_group(const std::vector<std::size_t>& group, const std::set<Row>& done) {
    std::vector<const Cell*> cells;
    for (const auto i : group)
      if (!done.contains(key_row(cells_[i]))) cells.push_back(&cells_[i]);
    const Prepared ready = prepared(*cells[0]);
    std::vector<ReplayResult> counted(cells.size() + 1);
    side_by_side(counted.size(), [&](std::size_t i) {
      ReplayOptions options;
      options.count = Count::on;
      if (i == cells.size()) {
        Variant reference;
        reference.query = (*cells[0])["query"];
        counted[i] = replay(ready.meshes, ready.trace, reference, options);
      } else {
        options.keep_series = wants_series(*cells[i]);
        counted[i] = answered(ready, *cells[i], options);
      }
    });
    const double slack = distance_slack(ready.meshes, ready.trace);
    std::vector<std::size_t> differences;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const bool ours = (*cells[i])["peer"].empty();
      differences.push_back(differing(counted[i], counted.back(), ours ? 0 : slack));
      if (!ours && differences.back() > 0)
        list_disagreements(ready, *cells[i], counted[i], counted.back(), slack);
    }
    if (!definition_.measures.empty()) measure_coherence(ready, cells);
    time(ready, cells, counted, differences);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const Row key = axis_row(*cells[i]);
      // A run that was killed between the two files has left this part here and not there.
      frames_.forget(key);
      for (std::size_t frame = 0;
           frame < std::min(counted[i].series.size(), definition_.series_until); ++frame) {
        const auto& c = counted[i].series[frame];
        Row row;
        for (const auto& label : key) row.push_back(label);
        for (const auto value : {std::uint64_t{frame}, c.n_u, c.n_v, c.n_p, c.front, c.hits})
          row.push_back(std::to_string(value));
        frames_.add(std::move(row));
      }
    }
    if (definition_.has_series) frames_.save();
    if (!disagreements_.rows().empty()) disagreements_.save();
    rows_.save();
  }

  void list_disagreements(const Prepared& ready, const Cell& cell, const ReplayResult& theirs,
                          const ReplayResult& ours, double slack) {
    constexpr std::size_t most = 10;
    const Row key = axis_row(cell);
    disagreements_.forget(key);
    for (auto& each : disagreements(ready.meshes, ready.trace, theirs, ours, slack, most)) {
      Row row = key;
      for (const auto number : {each.frame, each.i, each.j}) row.push_back(std::to_string(number));
      for (auto* text : {&each.triangle_i, &each.triangle_j, &each.theirs, &each.ours, &each.exact})
        row.push_back(std::move(*text));
      disagreements_.add(std::move(row));
    }
  }

  void time(const Prepared& ready, const std::vector<const Cell*>& cells,
            const std::vector<ReplayResult>& counted, const std::vector<std::size_t>& differences) {
    ReplayOptions options;
    options.keep_answers = false;
    std::vector<std::size_t> order(cells.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    for (unsigned repetition = 0; repetition < definition_.repetitions; ++repetition) {
      std::shuffle(order.begin(), order.end(), random_);
      for (const auto i : order) {
        const ReplayResult timed = answered(ready, *cells[i], options);
        const ReplayResult& count = counted[i];
        Row row = key_row(*cells[i]);
        const bool ours = (*cells[i])["peer"].empty();
        // Of peers, those that count.
        const auto counts = [&](std::uint64_t n) {
          return ours || n > 0 ? std::to_string(n) : std::string();
        };
        for (auto& field :
             {std::to_string(repetition), nanoseconds(timed.seconds),
              nanoseconds(timed.first_seconds), nanoseconds(timed.build_seconds),
              std::to_string(ready.trace.pairs() * ready.trace.frames), std::to_string(timed.hits),
              std::to_string(differences[i]), counts(count.n_u), counts(count.n_v),
              counts(count.n_p), ours ? std::to_string(count.front) : std::string()})
          row.push_back(field);
        rows_.add(std::move(row));
      }
    }
  }

  const Definition& definition_;
  std::vector<Cell> cells_;
  std::size_t keys_ = 0;
  Table rows_, frames_, disagreements_, coherence_;
  std::map<std::string, std::vector<std::size_t>> by_trace_;
  std::vector<const std::vector<std::size_t>*> order_;
  std::mt19937_64 random_{20260101};
};

}  // namespace

void check(const Definition& definition) {
  try {
    std::map<std::string, bool> peers_asked;
    bool any_asked = false;
    for (const auto& cell : cells_of(definition)) {
      check(cell);
      any_asked |= has_answer(cell);
      if (!cell["peer"].empty()) peers_asked[cell["peer"]] |= has_answer(cell);
    }
    for (const auto& [name, asked] : peers_asked)
      if (!asked && peer(name))
        throw Unusable("peer " + name + " is asked nothing it answers: it answers " +
                       std::string(peer(name)->queries));
    if (!any_asked)
      throw Unusable("asks nobody but peers that were absent when bvlab was built, as " +
                     peers_asked.begin()->first);
  } catch (const Unusable& fault) {
    throw Unusable(definition.file, fault.what());
  }
}

void run_experiment(const Definition& definition, const std::filesystem::path& record,
                    const Progress& progress) {
  std::set<std::string> absent;
  for (const auto& cell : cells_of(definition))
    if (is_absent_peer(cell["peer"])) absent.insert(cell["peer"]);
  for (const auto& name : absent)
    std::fprintf(stderr, "bvlab: peer %s is left out: absent when bvlab was built\n", name.c_str());
  Experiment(definition, record).run(progress);
}

}  // namespace bvlab
