// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/studies/experiment.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <optional>
#include <random>
#include <set>

#include "experiments/files/unusable.hpp"
#include "experiments/peers/disagreements.hpp"
#include "experiments/peers/peers.hpp"
#include "experiments/records/node.hpp"
#include "experiments/records/record.hpp"
#include "experiments/replay/coherence.hpp"
#include "experiments/replay/predict.hpp"
#include "experiments/replay/replay.hpp"
#include "experiments/studies/cells.hpp"
#include "experiments/studies/clocks.hpp"
#include "experiments/studies/percentile.hpp"
#include "experiments/studies/side_by_side.hpp"

namespace bvlab {
namespace {

std::string nanoseconds(double seconds) {
  return std::to_string(static_cast<std::int64_t>(seconds * 1e9 + 0.5));
}

std::string three_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", value);
  return text;
}

/// Of all frames but the first; empty where frames were not timed.
std::string p99(const ReplayResult& result) {
  const auto& all = result.frame_seconds;
  if (all.size() < 2) return {};
  return nanoseconds(percentile({all.begin() + 1, all.end()}, 0.99));
}

/// Labels and parameters: what a row begins with.
Row key_row(const Cell& cell) {
  Row row;
  for (const auto* settings : {&cell.labels, &cell.parameters})
    for (const auto& [name, value] : *settings) row.push_back(value);
  return row;
}

/// What says which trace it is, and what of a variant its front depends on.
bool matters_to_front(const std::string& name) {
  return !is_of_variant(name) || name == "volume" || name == "query" || name == "build" ||
         name == "leaf_size" || name == "fit";
}
Row front_key(const Cell& cell) {
  Row row;
  for (const auto& [name, value] : cell.parameters)
    if (matters_to_front(name)) row.push_back(value);
  return row;
}

Row coherence_row(Row row, const CoherenceSums& c, const std::optional<BestRebuilds>& best) {
  for (const auto n : {c.pair_runs, c.near_runs, c.moved_runs, c.still_runs, c.tests, c.entries,
                       c.kept, c.grown, c.again, c.still_entries})
    row.push_back(std::to_string(n));
  row.push_back(std::to_string(c.motion_leaf));
  row.push_back(std::to_string(c.motion_gap));
  row.push_back(best ? std::to_string(best->tests) : "");
  row.push_back(best ? std::to_string(best->rebuilds) : "");
  return row;
}

/// The columns of each table behind those that say what was run.
const Row measured_columns{
    "repetition", "time_ns", "first_ns", "build_ns", "pairs", "hits",  "differing",
    "n_u",        "n_v",     "n_p",      "front",    "node",  "alone", "wall_per_processor",
    "p99_ns"};
const Row frame_columns{"frame", "n_u", "n_v", "n_p", "front", "hits"};
const Row disagreement_columns{"frame",      "object_i", "object_j", "triangle_i",
                               "triangle_j", "theirs",   "ours",     "exact"};
const Row coherence_columns{"pair_runs",  "near_runs",     "moved_runs",  "still_runs",
                            "tests",      "entries",       "kept",        "grown",
                            "again",      "still_entries", "motion_leaf", "motion_gap",
                            "best_tests", "best_rebuilds"};
const Row prediction_columns{"strategy", "n_v", "n_p", "time_ns", "taken_ns"};

/// A label has a column of its own.
void check_axis_name(const Definition::Axis& axis) {
  if (axis.is_parameter) return;
  for (const Row* columns : {&measured_columns, &frame_columns, &disagreement_columns,
                             &coherence_columns, &prediction_columns})
    if (std::find(columns->begin(), columns->end(), axis.name) != columns->end())
      throw Unusable("axis '" + axis.name + "': a record has a column of that name");
}

/// What was found of one trace: the rows of each table.
struct Found {
  std::vector<const Cell*> cells;
  std::vector<ReplayResult> counted;  ///< of each cell
  std::vector<std::size_t> differing;
  std::vector<Row> rows, coherence, predictions, disagreements;
};

class Experiment {
 public:
  Experiment(const Definition& definition, const std::filesystem::path& record,
             const RunOptions& options)
      : definition_(definition),
        options_(options),
        cells_(cells_with_answers(definition)),
        rows_(record / (definition.name + ".csv"), columns(measured_columns)),
        frames_(record / (definition.name + ".frames.csv"), axis_columns(frame_columns)),
        disagreements_(record / (definition.name + ".disagreements.csv"),
                       axis_columns(disagreement_columns)),
        coherence_(record / (definition.name + ".coherence.csv"), front_columns(coherence_columns)),
        predictions_(record / (definition.name + ".predictions.csv"),
                     front_columns(prediction_columns)) {
    check_measured(record);
    check_rows(record);
    const auto traces = traces_of(cells_);
    const auto [number, of] = options.part;
    first_ = (number - 1) * traces.size() / of;
    const std::size_t end = number * traces.size() / of;
    traces_.assign(traces.begin() + static_cast<std::ptrdiff_t>(first_),
                   traces.begin() + static_cast<std::ptrdiff_t>(end));
  }

  void run(const Progress& progress) {
    for (const auto& row : rows_.rows())
      done_.insert(Row(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(keys_)));
    progress(0, traces_.size());
    const std::size_t beside = is_timed() ? 1 : std::min(options_.threads, traces_.size());
    const std::size_t threads = options_.threads / std::max<std::size_t>(beside, 1);
    std::map<std::size_t, Found> waiting;
    std::size_t saved = 0;
    std::mutex guard;
    side_by_side(traces_.size(), beside, [&](std::size_t i) {
      Found found = find(i, threads);
      const std::lock_guard lock(guard);
      waiting.emplace(i, std::move(found));
      // In their order, so that a broken run that goes on writes what an unbroken one does.
      for (auto each = waiting.begin(); each != waiting.end() && each->first == saved; ++saved) {
        if (!each->second.cells.empty()) save(std::move(each->second));
        each = waiting.erase(each);
        progress(saved + 1, traces_.size());
      }
    });
  }

 private:
  bool is_timed() const { return options_.measured == Measured::counts_and_times; }

  bool measures_coherence() const {
    return definition_.measures.contains("coherence") ||
           definition_.measures.contains("best rebuilds");
  }
  bool measures_predictions() const { return definition_.measures.contains("predictions"); }

  /// Times that are absent would pass for finished.
  void check_measured(const std::filesystem::path& record) const {
    for (const auto& row : rows_.rows())
      if (const bool has_time = !row[keys_ + 1].empty(); has_time != is_timed())
        throw Unusable(record.string(), has_time ? "holds times: not a record of counts alone"
                                                 : "holds counts alone: go on with --counts");
  }

  /// Every cell has all of its rows or none: traces are saved whole. Rows of peers that this
  /// program was built without stay.
  void check_rows(const std::filesystem::path& record) const {
    std::map<Row, std::size_t> held;
    for (const Cell& cell : cells_) held[key_row(cell)];
    const auto fail = [&](std::size_t row, const std::string& what) {
      throw Unusable((record / (definition_.name + ".csv")).string(),
                     "row " + std::to_string(row + 1) + " " + what);
    };
    const auto& rows = rows_.rows();
    const auto key = [&](const Row& row) {
      return Row(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(keys_));
    };
    const auto& columns = rows_.columns();
    const auto peer = static_cast<std::size_t>(std::find(columns.begin(), columns.end(), "peer") -
                                               columns.begin());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto place = held.find(key(rows[i]));
      if (place != held.end())
        ++place->second;
      else if (rows[i][peer].empty())
        fail(i, "is of no cell of the definition");
    }
    const std::size_t wanted = is_timed() ? definition_.repetitions : 1;
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (const auto place = held.find(key(rows[i]));
          place != held.end() && place->second != wanted)
        fail(i, "is of a cell that has " + std::to_string(place->second) + " rows, not " +
                    std::to_string(wanted));
  }

  /// Labels, then parameters, then what is measured.
  Row columns(const Row& measured) {
    Row row;
    for (const auto& [name, value] : cells_.at(0).labels) row.push_back(name);
    for (const auto& [name, value] : cells_.at(0).parameters) row.push_back(name);
    keys_ = row.size();
    row.insert(row.end(), measured.begin(), measured.end());
    return row;
  }

  /// Only what varies: a series is long.
  Row axis_columns(const Row& measured) const {
    Row row;
    for (const auto& axis : definition_.axes) row.push_back(axis.name);
    row.insert(row.end(), measured.begin(), measured.end());
    return row;
  }

  /// What a front depends on, then what is measured of it.
  Row front_columns(const Row& measured) const {
    Row row;
    for (const auto& [name, value] : cells_.at(0).parameters)
      if (matters_to_front(name)) row.push_back(name);
    row.insert(row.end(), measured.begin(), measured.end());
    return row;
  }

  Row axis_row(const Cell& cell) const {
    Row row;
    for (const auto& axis : definition_.axes) row.push_back(cell[axis.name]);
    return row;
  }

  bool wants_series(const Cell& cell) const {
    return definition_.has_series && cell["peer"].empty() &&
           std::all_of(definition_.series.begin(), definition_.series.end(),
                       [&](const Setting& s) { return cell[s.first] == s.second; });
  }

  /// Of the cells of a trace that have no rows yet; nothing where all have.
  Found find(std::size_t trace, std::size_t threads) {
    Found found;
    for (const auto i : traces_[trace])
      if (!done_.contains(key_row(cells_[i]))) found.cells.push_back(&cells_[i]);
    if (found.cells.empty()) return found;
    const Prepared ready = prepared(*found.cells[0]);
    count(ready, found, threads);
    if (measures_coherence()) measure_coherence(ready, found, threads);
    if (measures_predictions()) make_predictions(ready, found);
    if (is_timed())
      time(ready, found, first_ + trace);
    else
      for (std::size_t i = 0; i < found.cells.size(); ++i)
        found.rows.push_back(row_of(ready, found, i, 0, nullptr));
    return found;
  }

  void count(const Prepared& ready, Found& found, std::size_t threads) const {
    const auto& cells = found.cells;
    auto& counted = found.counted;
    counted.resize(cells.size());
    ReplayResult reference;
    side_by_side(cells.size() + 1, threads, [&](std::size_t i) {
      ReplayOptions options;
      options.count = Count::on;
      if (i == cells.size()) {
        Variant variant;
        variant.query = (*cells[0])["query"];
        reference = replay(ready.meshes, ready.trace, variant, options);
      } else {
        options.keep_series = wants_series(*cells[i]);
        counted[i] = answered(ready, *cells[i], options);
      }
    });
    const double slack = distance_slack(ready.meshes, ready.trace);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const bool ours = (*cells[i])["peer"].empty();
      found.differing.push_back(differing(counted[i], reference, ours ? 0 : slack));
      if (!ours && found.differing.back() > 0)
        list_disagreements(ready, *cells[i], counted[i], reference, slack, found.disagreements);
      counted[i].touching = {}, counted[i].distances = {}, counted[i].contacts = {};
    }
  }

  void list_disagreements(const Prepared& ready, const Cell& cell, const ReplayResult& theirs,
                          const ReplayResult& ours, double slack, std::vector<Row>& into) const {
    constexpr std::size_t most = 10;
    for (auto& each : disagreements(ready.meshes, ready.trace, theirs, ours, slack, most)) {
      Row row = axis_row(cell);
      for (const auto number : {each.frame, each.i, each.j}) row.push_back(std::to_string(number));
      for (auto* text : {&each.triangle_i, &each.triangle_j, &each.theirs, &each.ours, &each.exact})
        row.push_back(std::move(*text));
      into.push_back(std::move(row));
    }
  }

  /// The fronts that cells of a trace have, each with one of its cells.
  std::vector<std::pair<Row, const Cell*>> fronts_of(const Found& found) const {
    std::map<Row, const Cell*> fronts;
    for (const Cell* cell : found.cells)
      if ((*cell)["peer"].empty() && (*cell)["tree"] == "binary" && (*cell)["query"] != "distance")
        fronts.emplace(front_key(*cell), cell);
    return {fronts.begin(), fronts.end()};
  }

  void measure_coherence(const Prepared& ready, Found& found, std::size_t threads) const {
    const auto all = fronts_of(found);
    found.coherence.resize(all.size());
    side_by_side(all.size(), threads, [&](std::size_t i) {
      const Variant variant = variant_of(*all[i].second);
      const CoherenceSums sums = coherence(ready.meshes, ready.trace, variant);
      std::optional<BestRebuilds> best;
      if (definition_.measures.contains("best rebuilds"))
        best = best_rebuilds(ready.meshes, ready.trace, variant);
      found.coherence[i] = coherence_row(all[i].first, sums, best);
    });
  }

  /// One after the other: they say seconds, which are measured as times are (and empty where those
  /// are).
  void make_predictions(const Prepared& ready, Found& found) const {
    for (const auto& [key, cell] : fronts_of(found)) {
      const auto run = undisturbed([&] {
        const double start = wall_seconds();
        auto predicted = predict(ready.meshes, ready.trace, variant_of(*cell));
        return std::pair(std::move(predicted), wall_seconds() - start);
      });
      for (const Predicted& each : run.result.first) {
        Row row = key;
        for (const auto& field :
             {std::string(each.strategy), std::to_string(each.n_v), std::to_string(each.n_p),
              is_timed() ? nanoseconds(each.seconds) : std::string(),
              is_timed() ? nanoseconds(run.result.second) : std::string()})
          row.push_back(field);
        found.predictions.push_back(std::move(row));
      }
    }
  }

  /// The order depends on the trace alone, not on what was run before it.
  void time(const Prepared& ready, Found& found, std::size_t trace) {
    ReplayOptions options;
    options.keep_answers = false;
    options.keep_frame_seconds = definition_.measures.contains("frames");
    std::mt19937_64 random(20260101 + trace);
    std::vector<std::size_t> order(found.cells.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    for (unsigned repetition = 0; repetition < definition_.repetitions; ++repetition) {
      std::shuffle(order.begin(), order.end(), random);
      for (const auto i : order) {
        const auto run = undisturbed([&] { return answered(ready, *found.cells[i], options); });
        Row row = row_of(ready, found, i, repetition, &run.result);
        row[row.size() - 2] = three_digits(run.wall_per_processor);
        row.back() = p99(run.result);
        found.rows.push_back(std::move(row));
      }
    }
    const std::string alone = neighbours_.alone();
    for (Row& row : found.rows) row[row.size() - 3] = alone;
  }

  /// Without times where nothing was timed.
  Row row_of(const Prepared& ready, const Found& found, std::size_t i, unsigned repetition,
             const ReplayResult* timed) const {
    const ReplayResult& count = found.counted[i];
    Row row = key_row(*found.cells[i]);
    const bool ours = (*found.cells[i])["peer"].empty();
    // Of peers, those that count.
    const auto counts = [&](std::uint64_t n) {
      return ours || n > 0 ? std::to_string(n) : std::string();
    };
    const auto time = [&](double ReplayResult::*seconds) {
      return timed ? nanoseconds(timed->*seconds) : std::string();
    };
    for (auto& field : {std::to_string(repetition), time(&ReplayResult::seconds),
                        time(&ReplayResult::first_seconds), time(&ReplayResult::build_seconds),
                        std::to_string(ready.trace.pairs() * ready.trace.frames),
                        std::to_string(timed ? timed->hits : count.hits),
                        std::to_string(found.differing[i]), counts(count.n_u), counts(count.n_v),
                        counts(count.n_p), ours ? std::to_string(count.front) : std::string(),
                        node_, std::string(), std::string(), std::string()})
      row.push_back(field);
    return row;
  }

  void save(Found found) {
    add_series(found);
    for (const Cell* cell : found.cells) disagreements_.forget(axis_row(*cell));
    for (auto& row : found.disagreements) disagreements_.add(std::move(row));
    for (const Row& row : found.predictions) predictions_.forget(front_of(row));
    for (auto& row : found.predictions) predictions_.add(std::move(row));
    for (auto& row : found.coherence) {
      coherence_.forget(front_of(row));
      coherence_.add(std::move(row));
    }
    for (auto& row : found.rows) rows_.add(std::move(row));
    if (measures_coherence()) coherence_.save();
    if (measures_predictions()) predictions_.save();
    if (definition_.has_series) frames_.save();
    if (!disagreements_.rows().empty()) disagreements_.save();
    rows_.save();
  }

  /// Of a row of coherence or predictions, what was measured left out.
  Row front_of(const Row& row) const {
    const auto keys = static_cast<std::ptrdiff_t>(front_key(cells_.at(0)).size());
    return Row(row.begin(), row.begin() + keys);
  }

  void add_series(const Found& found) {
    for (std::size_t i = 0; i < found.cells.size(); ++i) {
      const Row key = axis_row(*found.cells[i]);
      // A run that was killed between the two files has left this part here and not there.
      frames_.forget(key);
      const auto& series = found.counted[i].series;
      for (std::size_t frame = 0; frame < std::min(series.size(), definition_.series_until);
           ++frame) {
        const auto& c = series[frame];
        Row row = key;
        for (const auto value : {std::uint64_t{frame}, c.n_u, c.n_v, c.n_p, c.front, c.hits})
          row.push_back(std::to_string(value));
        frames_.add(std::move(row));
      }
    }
  }

  const Definition& definition_;
  const RunOptions& options_;
  std::vector<Cell> cells_;
  std::size_t keys_ = 0, first_ = 0;
  Table rows_, frames_, disagreements_, coherence_, predictions_;
  std::vector<std::vector<std::size_t>> traces_;  ///< of this part
  std::set<Row> done_;
  const std::string node_ = node_name();
  Neighbours neighbours_;
};

}  // namespace

void check(const Definition& definition) {
  try {
    for (const auto& axis : definition.axes) check_axis_name(axis);
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

DefinitionSize size_of(const Definition& definition) {
  const auto cells = cells_with_answers(definition);
  return {traces_of(cells).size(), cells.size()};
}

void run_experiment(const Definition& definition, const std::filesystem::path& record,
                    const RunOptions& options, const Progress& progress) {
  std::set<std::string> absent;
  for (const auto& cell : cells_of(definition))
    if (is_absent_peer(cell["peer"])) absent.insert(cell["peer"]);
  for (const auto& name : absent)
    std::fprintf(stderr, "bvlab: peer %s is left out: absent when bvlab was built\n", name.c_str());
  Experiment(definition, record, options).run(progress);
}

}  // namespace bvlab
