// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/studies/experiment.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <future>
#include <map>
#include <mutex>
#include <optional>
#include <random>
#include <set>

#include "experiments/files/numbers.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/peers/disagreements.hpp"
#include "experiments/peers/peers.hpp"
#include "experiments/recorder/node.hpp"
#include "experiments/recorder/record.hpp"
#include "experiments/replay/coherence.hpp"
#include "experiments/replay/configurations.hpp"
#include "experiments/replay/predict.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/replay/replay.hpp"
#include "experiments/replay/variant_parameters.hpp"
#include "experiments/studies/cells.hpp"
#include "experiments/studies/clocks.hpp"
#include "experiments/studies/percentile.hpp"
#include "experiments/studies/side_by_side.hpp"

namespace bvlab {
namespace {

std::string three_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", value);
  return text;
}

/// p99 and the worst of all frames but the first; empty where frames were not timed.
Row of_frames(const ReplayResult& result) {
  const auto& all = result.frame_seconds;
  if (all.size() < 2) return {"", ""};
  return {nanoseconds(percentile({all.begin() + 1, all.end()}, 0.99)),
          nanoseconds(*std::max_element(all.begin() + 1, all.end()))};
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
         name == "leaf_size" || name == "fit" || name == "fan_out";
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
  for (const StepSums& s : c.steps)
    for (const auto n : {s.runs, s.entries, s.tests, s.again, s.raised})
      row.push_back(std::to_string(n));
  for (const TwoRunSums& s : c.two)
    for (const auto n : {s.runs, s.kept, s.rebuilt}) row.push_back(std::to_string(n));
  return row;
}

bool wants_series(const Definition& definition, const Cell& cell) {
  return definition.has_series && cell["peer"].empty() &&
         std::all_of(definition.series.begin(), definition.series.end(),
                     [&](const Setting& s) { return cell[s.first] == s.second; });
}

/// The columns of each table behind those that say what was run.
const Row measured_columns{
    "repetition", "time_ns", "first_ns", "build_ns", "pairs", "hits",  "differing",
    "n_u",        "n_v",     "n_p",      "front",    "node",  "alone", "wall_per_processor",
    "p99_ns",     "worst_ns"};
/// Of a cell that is counted and not timed in each repetition yet.
const Row counted_columns{"pairs", "hits", "differing", "n_u", "n_v", "n_p", "front"};
const Row frame_columns{"frame", "n_u", "n_v", "n_p", "front", "hits"};
const Row disagreement_columns{"frame",      "object_i", "object_j", "triangle_i",
                               "triangle_j", "theirs",   "ours",     "exact"};
/// Also those of each kind of step, and of two runs without growth.
Row with_steps(Row columns) {
  const auto add = [&](const std::string& of, std::initializer_list<const char*> sums) {
    for (const char* sum : sums) columns.push_back(of + "_" + sum);
  };
  for (const std::string name : step_names)
    add("step_" + name, {"runs", "entries", "tests", "again", "raised"});
  const auto name = [](Step step) { return std::string(step_names[static_cast<int>(step)]); };
  for (const TwoRuns& two : two_runs)
    add("two_" + name(two.first) + "_" + name(two.second), {"runs", "kept", "rebuilt"});
  return columns;
}
const Row coherence_columns = with_steps(
    {"pair_runs", "near_runs", "moved_runs", "still_runs", "tests", "entries", "kept", "grown",
     "again", "still_entries", "motion_leaf", "motion_gap", "best_tests", "best_rebuilds"});
const Row prediction_columns{"strategy", "n_v", "n_p", "time_ns", "taken_ns", "low_ns", "high_ns"};

/// What is computed of a record when it is read: see plots/bvlab_plots/records.py.
const Row computed_columns{"later_ns", "later_pairs", "survival"};

/// A label has a column of its own.
void check_axis_name(const Definition::Axis& axis) {
  if (axis.is_parameter) return;
  for (const Row* columns : {&measured_columns, &frame_columns, &disagreement_columns,
                             &coherence_columns, &prediction_columns, &computed_columns})
    if (std::find(columns->begin(), columns->end(), axis.name) != columns->end())
      throw Unusable("axis '" + axis.name + "': a record has a column of that name");
}

/// Cells that take a repetition each of the same trace, and what is known of them.
struct Work {
  std::size_t trace = 0;                   ///< in the whole definition
  std::vector<const Cell*> cells;          ///< all of the trace
  std::vector<std::vector<bool>> has_row;  ///< of each cell: of each repetition
  std::vector<Row> counts;  ///< of each cell, as counted_columns; empty: to be counted

  bool lacks_rows() const {
    return std::any_of(has_row.begin(), has_row.end(), [](const auto& each) {
      return std::find(each.begin(), each.end(), false) != each.end();
    });
  }
  bool lacks_counts() const {
    return std::any_of(counts.begin(), counts.end(), [](const Row& row) { return row.empty(); });
  }
};

/// What the answers to a query are compared with: the engine's default variant, with the first
/// volume and strategy of a build that lacks those of the default.
Variant reference_for(const std::string& query) {
  Variant variant;
  variant.query = query;
  variant.volume = name_or_first(variant.volume, volumes());
  variant.strategy = name_or_first(variant.strategy, strategies());
  return variant;
}

class Experiment {
 public:
  Experiment(const Definition& definition, const std::filesystem::path& record,
             const RunOptions& options)
      : definition_(definition),
        options_(options),
        record_(record),
        cells_(cells_with_answers(definition)),
        rows_(record / (definition.name + ".csv"), columns(measured_columns)),
        counted_(record / (definition.name + ".counted.csv"), columns(counted_columns)),
        frames_(record / (definition.name + ".frames.csv"), axis_columns(frame_columns)),
        disagreements_(record / (definition.name + ".disagreements.csv"),
                       axis_columns(disagreement_columns)),
        coherence_(record / (definition.name + ".coherence.csv"), front_columns(coherence_columns)),
        predictions_(record / (definition.name + ".predictions.csv"),
                     front_columns(prediction_columns)) {
    check_measured();
    const auto traces = traces_of(cells_);
    for (std::size_t trace = 0; trace < traces.size(); ++trace)
      for (const auto i : traces[trace]) places_[key_row(cells_[i])] = {trace, i};
    const auto [number, of] = options.part;
    for (std::size_t trace = (number - 1) * traces.size() / of; trace < number * traces.size() / of;
         ++trace)
      works_.push_back(work_of(trace, traces[trace]));
    take_rows();
  }

  void run(const Progress& progress) {
    for (const Work& work : works_) {
      for (const auto& each : work.has_row) rows_wanted_ += each.size();
      all_ += to_count(work) + to_time(work);
    }
    progress_ = &progress;
    progress(0, all_);
    if (!is_finished()) mark_unfinished(record_, "rows", rows_.rows().size(), rows_wanted_);
    const std::size_t beside = is_timed() ? 1 : std::min(options_.threads, works_.size());
    const std::size_t threads = options_.threads / std::max<std::size_t>(beside, 1);
    side_by_side(works_.size(), beside, [&](std::size_t i) { finish(works_[i], threads); });
    put_in_order();
    counted_.discard();
    mark_finished(record_);
  }

 private:
  struct Place {
    std::size_t trace, cell;
  };

  bool is_timed() const { return options_.measured == Measured::counts_and_times; }
  std::size_t repetitions() const { return is_timed() ? definition_.repetitions : 1; }

  bool measures_coherence() const {
    return definition_.measures.contains("coherence") || measures_best();
  }
  bool measures_best() const { return definition_.measures.contains("best rebuilds"); }
  bool measures_predictions() const { return definition_.measures.contains("predictions"); }

  /// Times that are absent would pass for finished.
  void check_measured() const {
    for (const auto& row : rows_.rows())
      if (const bool has_time = !row[keys_ + 1].empty(); has_time != is_timed())
        throw Unusable(record_.string(), has_time ? "holds times: not a record of counts only"
                                                  : "holds counts alone: go on with --counts");
  }

  Work work_of(std::size_t trace, const std::vector<std::size_t>& cells) const {
    Work work{trace, {}, {}, {}};
    for (const auto i : cells) work.cells.push_back(&cells_[i]);
    work.has_row.assign(cells.size(), std::vector<bool>(repetitions()));
    work.counts.resize(cells.size());
    return work;
  }

  Row key_of(const Row& row) const {
    return Row(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(keys_));
  }

  /// Marks what is there. Rows of peers that this program was built without stay.
  void take_rows() {
    std::map<Row, std::pair<Work*, std::size_t>> held;
    for (Work& work : works_)
      for (std::size_t i = 0; i < work.cells.size(); ++i)
        held[key_row(*work.cells[i])] = {&work, i};
    const auto fail = [&](std::size_t row, const std::string& what) {
      throw Unusable((record_ / (definition_.name + ".csv")).string(),
                     "row " + std::to_string(row + 1) + " " + what);
    };
    const auto& columns = rows_.columns();
    const auto peer = std::find(columns.begin(), columns.end(), "peer") - columns.begin();
    for (std::size_t i = 0; i < rows_.rows().size(); ++i) {
      const Row& row = rows_.rows()[i];
      const auto place = held.find(key_of(row));
      if (place == held.end()) {
        if (row[static_cast<std::size_t>(peer)].empty()) fail(i, "is of no cell of the definition");
        continue;
      }
      auto& [work, cell] = place->second;
      const auto repetition = number_in<std::size_t>(row[keys_]);
      if (!repetition || *repetition >= repetitions())
        fail(i, "is of repetition '" + row[keys_] + "', and the definition has " +
                    std::to_string(repetitions()));
      if (work->has_row[cell][*repetition]) fail(i, "is a second one of its cell and repetition");
      work->has_row[cell][*repetition] = true;
      const auto counts = row.begin() + static_cast<std::ptrdiff_t>(keys_ + 4);
      take_counts(*work, cell, Row(counts, counts + std::ssize(counted_columns)));
    }
    for (const Row& row : counted_.rows())
      if (const auto place = held.find(key_of(row)); place != held.end())
        take_counts(*place->second.first, place->second.second,
                    Row(row.begin() + static_cast<std::ptrdiff_t>(keys_), row.end()));
  }

  void take_counts(Work& work, std::size_t cell, Row counts) const {
    if (wants_series(*work.cells[cell]) && !frames_.has(axis_row(*work.cells[cell]))) return;
    work.counts[cell] = std::move(counts);
  }

  /// How many cells are to be counted: not those whose rows are all there.
  std::size_t to_count(const Work& work) const {
    return static_cast<std::size_t>(std::count_if(work.counts.begin(), work.counts.end(),
                                                  [](const Row& row) { return row.empty(); }));
  }
  std::size_t to_time(const Work& work) const {
    std::size_t lacking = 0;
    if (is_timed())
      for (const auto& each : work.has_row)
        lacking += static_cast<std::size_t>(std::count(each.begin(), each.end(), false));
    return lacking;
  }
  bool is_finished() const {
    return std::none_of(works_.begin(), works_.end(),
                        [&](const Work& work) { return work.lacks_rows() || work.lacks_counts(); });
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

  bool wants_series(const Cell& cell) const { return bvlab::wants_series(definition_, cell); }

  /// What a trace lacks: counts, what is measured beside, times.
  void finish(Work& work, std::size_t threads) {
    const auto fronts = fronts_lacking(work, coherence_, measures_coherence());
    const auto unpredicted = fronts_lacking(work, predictions_, measures_predictions());
    if (!work.lacks_rows() && !work.lacks_counts() && fronts.empty() && unpredicted.empty()) return;
    const Prepared ready = prepared(*work.cells[0]);
    count(ready, work, threads);
    measure_coherence(ready, fronts, threads);
    make_predictions(ready, unpredicted);
    if (is_timed()) time(ready, work);
  }

  /// One run is over, whose rows `keep` writes down.
  template <class Keep>
  void over(Keep&& keep) {
    const std::lock_guard lock(guard_);
    keep();
    (*progress_)(++done_, all_);
  }

  /// The reference first: whoever is through waits for it, and is compared with it at once.
  void count(const Prepared& ready, Work& work, std::size_t threads) {
    std::vector<std::size_t> cells;
    for (std::size_t i = 0; i < work.cells.size(); ++i)
      if (work.counts[i].empty()) cells.push_back(i);
    if (cells.empty()) return;
    std::promise<ReplayResult> found;
    const std::shared_future<ReplayResult> reference = found.get_future().share();
    const double slack = distance_slack(ready.meshes, ready.trace);
    side_by_side(cells.size() + 1, threads, [&](std::size_t i) {
      ReplayOptions options;
      options.count = Count::on;
      if (i == 0) {
        try {
          found.set_value(
              replay(ready.meshes, ready.trace, reference_for((*work.cells[0])["query"]), options));
        } catch (...) {
          found.set_exception(std::current_exception());
        }
        return;
      }
      const std::size_t cell = cells[i - 1];
      options.keep_series = wants_series(*work.cells[cell]);
      const ReplayResult counted = answered(ready, *work.cells[cell], options);
      keep_counted(ready, work, cell, counted, reference.get(), slack);
    });
  }

  void keep_counted(const Prepared& ready, Work& work, std::size_t i, const ReplayResult& counted,
                    const ReplayResult& reference, double slack) {
    const Cell& cell = *work.cells[i];
    const bool ours = cell["peer"].empty();
    const std::size_t differ = differing(counted, reference, ours ? 0 : slack);
    std::vector<Row> disagreed;
    if (!ours && differ > 0) disagreed = disagreements_of(ready, cell, counted, reference, slack);
    // Of peers, those that count.
    const auto number = [&](std::uint64_t n) {
      return ours || n > 0 ? std::to_string(n) : std::string();
    };
    work.counts[i] = {std::to_string(ready.trace.pairs() * ready.trace.frames),
                      std::to_string(counted.hits),
                      std::to_string(differ),
                      number(counted.n_u),
                      number(counted.n_v),
                      number(counted.n_p),
                      ours ? std::to_string(counted.front) : std::string()};
    over([&] {
      // A run that was killed between two files has left this part in one and not in the other.
      replace(frames_, axis_row(cell), series_of(cell, counted));
      replace(disagreements_, axis_row(cell), std::move(disagreed));
      if (!is_timed()) {
        if (!work.has_row[i][0]) rows_.append({row_of(work, i, 0, nullptr, 1)});
        return;
      }
      Row row = key_row(cell);
      row.insert(row.end(), work.counts[i].begin(), work.counts[i].end());
      counted_.append({std::move(row)});
    });
  }

  static void replace(Table& table, const Row& key, std::vector<Row> rows) {
    if (table.has(key)) {
      table.forget(key);
      for (Row& row : rows) table.add(std::move(row));
      table.save();
    } else if (!rows.empty()) {
      table.append(std::move(rows));
    }
  }

  std::vector<Row> disagreements_of(const Prepared& ready, const Cell& cell,
                                    const ReplayResult& theirs, const ReplayResult& ours,
                                    double slack) const {
    constexpr std::size_t most = 10;
    std::vector<Row> rows;
    for (auto& each : disagreements(ready.meshes, ready.trace, theirs, ours, slack, most)) {
      Row row = axis_row(cell);
      for (const auto number : {each.frame, each.i, each.j}) row.push_back(std::to_string(number));
      for (auto* text : {&each.triangle_i, &each.triangle_j, &each.theirs, &each.ours, &each.exact})
        row.push_back(std::move(*text));
      rows.push_back(std::move(row));
    }
    return rows;
  }

  std::vector<Row> series_of(const Cell& cell, const ReplayResult& counted) const {
    std::vector<Row> rows;
    const std::size_t until = std::min(counted.series.size(), definition_.series_until);
    for (std::size_t frame = 0; frame < until; ++frame) {
      const auto& c = counted.series[frame];
      Row row = axis_row(cell);
      for (const auto value : {std::uint64_t{frame}, c.n_u, c.n_v, c.n_p, c.front, c.hits})
        row.push_back(std::to_string(value));
      rows.push_back(std::move(row));
    }
    return rows;
  }

  using Fronts = std::vector<std::pair<Row, const Cell*>>;

  /// The fronts that cells of a trace have, each with one of its cells, that have no rows yet.
  Fronts fronts_lacking(const Work& work, const Table& table, bool is_wanted) {
    std::map<Row, const Cell*> fronts;
    if (!is_wanted) return {};
    const std::lock_guard lock(guard_);
    for (const Cell* cell : work.cells)
      if ((*cell)["peer"].empty() && (*cell)["kernel"] == "gathered" &&
          (*cell)["query"] != "distance")
        if (const Row key = front_key(*cell); !is_measured(table, key)) fronts.emplace(key, cell);
    return {fronts.begin(), fronts.end()};
  }

  bool is_measured(const Table& table, const Row& key) const {
    const Row& columns = table.columns();
    const auto best = std::find(columns.begin(), columns.end(), "best_rebuilds") - columns.begin();
    return std::any_of(table.rows().begin(), table.rows().end(), [&](const Row& row) {
      return std::equal(key.begin(), key.end(), row.begin()) &&
             (&table != &coherence_ ||
              (!row.back().empty() && (!measures_best() || !row[best].empty())));
    });
  }

  void measure_coherence(const Prepared& ready, const Fronts& fronts, std::size_t threads) {
    side_by_side(fronts.size(), threads, [&](std::size_t i) {
      const Variant variant = variant_of(*fronts[i].second);
      const CoherenceSums sums = coherence(ready.meshes, ready.trace, variant);
      std::optional<BestRebuilds> best;
      if (measures_best()) best = best_rebuilds(ready.meshes, ready.trace, variant);
      const std::lock_guard lock(guard_);
      replace(coherence_, fronts[i].first, {coherence_row(fronts[i].first, sums, best)});
    });
  }

  /// One after the other: they say seconds, which are measured as times are (and empty where those
  /// are).
  void make_predictions(const Prepared& ready, const Fronts& fronts) {
    for (const auto& [key, cell] : fronts) {
      const auto run = undisturbed([&] {
        const double start = wall_seconds();
        auto predicted = predict(ready.meshes, ready.trace, variant_of(*cell));
        return std::pair(std::move(predicted), wall_seconds() - start);
      });
      std::vector<Row> rows;
      for (const Predicted& each : run.result.first) {
        Row& row = rows.emplace_back(key);
        for (const auto& field :
             {std::string(each.strategy), std::to_string(each.n_v), std::to_string(each.n_p),
              is_timed() ? nanoseconds(each.seconds) : std::string(),
              is_timed() ? nanoseconds(run.result.second) : std::string(),
              is_timed() ? nanoseconds(each.low) : std::string(),
              is_timed() ? nanoseconds(each.high) : std::string()})
          row.push_back(field);
      }
      const std::lock_guard lock(guard_);
      replace(predictions_, key, std::move(rows));
    }
  }

  /// The order depends on the trace alone, not on what was run before it.
  void time(const Prepared& ready, const Work& work) {
    ReplayOptions options;
    options.keep_answers = false;
    const bool of_frames = definition_.measures.contains("frames");
    // Beside so few pairs a reading of the clock in each frame is a part of the time: frames are
    // timed in a run of their own.
    const bool apart = of_frames && ready.trace.pairs() < 8;
    options.keep_frame_seconds = of_frames && !apart;
    std::mt19937_64 random(20260101 + work.trace);
    std::vector<std::size_t> order(work.cells.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    for (unsigned repetition = 0; repetition < definition_.repetitions; ++repetition) {
      std::shuffle(order.begin(), order.end(), random);
      for (const auto i : order) {
        if (work.has_row[i][repetition]) continue;
        auto run = undisturbed([&] { return answered(ready, *work.cells[i], options); });
        if (apart) {
          ReplayOptions each = options;
          each.keep_frame_seconds = true;
          run.result.frame_seconds = undisturbed([&] {
                                       return answered(ready, *work.cells[i], each);
                                     }).result.frame_seconds;
        }
        over([&] {
          rows_.append({row_of(work, i, repetition, &run.result, run.wall_per_processor)});
        });
      }
    }
  }

  /// Without times where nothing was timed.
  Row row_of(const Work& work, std::size_t i, unsigned repetition, const ReplayResult* timed,
             double wall_per_processor) {
    const auto time = [&](double ReplayResult::*seconds) {
      return timed ? nanoseconds(timed->*seconds) : std::string();
    };
    Row row = key_row(*work.cells[i]);
    row.push_back(std::to_string(repetition));
    for (const auto seconds :
         {&ReplayResult::seconds, &ReplayResult::first_seconds, &ReplayResult::build_seconds})
      row.push_back(time(seconds));
    Row counts = work.counts[i];
    if (timed) counts[1] = std::to_string(timed->hits);
    row.insert(row.end(), counts.begin(), counts.end());
    const Row frames = timed ? of_frames(*timed) : Row{"", ""};
    for (const auto& field :
         {node_, timed ? neighbours_.alone() : std::string(),
          timed ? three_digits(wall_per_processor) : std::string(), frames[0], frames[1]})
      row.push_back(field);
    return row;
  }

  /// As a run writes them that was never broken off, whatever was finished first: by trace, and by
  /// repetition (of counts alone, by cell). Rows of absent peers go last.
  void put_in_order() {
    rows_.sort([this](const Row& one, const Row& other) { return rank(one) < rank(other); });
    rows_.save();
    order_by_axes(frames_), order_by_axes(disagreements_);
    order_by_fronts(coherence_), order_by_fronts(predictions_);
  }

  using Rank = std::pair<std::size_t, std::size_t>;
  Rank rank(const Row& row) const {
    const auto place = places_.find(key_of(row));
    if (place == places_.end()) return {places_.size(), 0};
    const auto [trace, cell] = place->second;
    return {trace, is_timed() ? std::stoul(row[keys_]) : cell};
  }

  /// A series is in the order of its cells.
  void order_by_axes(Table& table) const {
    std::map<Row, Rank> places;
    for (const auto& [key, place] : places_)
      places[axis_row(cells_[place.cell])] = {place.trace, place.cell};
    order_by(table, places, definition_.axes.size());
  }

  /// Of each trace in the order of their keys.
  void order_by_fronts(Table& table) const {
    std::map<Row, Rank> places;
    for (const auto& [key, place] : places_)
      places.try_emplace(front_key(cells_[place.cell]), place.trace, 0);
    std::size_t nth = 0;
    for (auto& [key, place] : places) place.second = nth++;
    order_by(table, places, places.empty() ? 0 : places.begin()->first.size());
  }

  static void order_by(Table& table, const std::map<Row, Rank>& places, std::size_t keys) {
    if (table.rows().empty()) return;
    const auto at = [&](const Row& row) {
      const auto place =
          places.find(Row(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(keys)));
      return place == places.end() ? Rank{-1, 0} : place->second;
    };
    table.sort([&](const Row& one, const Row& other) { return at(one) < at(other); });
    table.save();
  }

  const Definition& definition_;
  const RunOptions& options_;
  const std::filesystem::path& record_;
  std::vector<Cell> cells_;
  std::size_t keys_ = 0;
  Table rows_, counted_, frames_, disagreements_, coherence_, predictions_;
  std::map<Row, Place> places_;  ///< of every cell of the definition
  std::vector<Work> works_;      ///< of this part
  std::size_t done_ = 0, all_ = 0, rows_wanted_ = 0;
  const Progress* progress_ = nullptr;
  std::mutex guard_;  ///< tables and progress
  const std::string node_ = node_name();
  Neighbours neighbours_;
};

void check_some_cell_has(const std::string& name, const std::string& value,
                         const std::vector<Cell>& cells) {
  std::set<std::string> there;
  for (const Cell& cell : cells) there.insert(cell[name]);
  if (there.contains(value)) return;
  std::string names;
  for (const auto& each : there) names += (names.empty() ? "'" : ", '") + each + "'";
  throw Unusable("series: " + name + " has no '" + value + "'; available: " + names);
}

/// A series that matches nothing would be noticed after the last cell.
void check_series_matches(const Definition& definition, const std::vector<Cell>& cells) {
  if (!definition.has_series) return;
  for (const Cell& cell : cells)
    if (wants_series(definition, cell) || !cell["configuration"].empty()) return;
  for (const auto& [name, value] : definition.series) check_some_cell_has(name, value, cells);
  throw Unusable("series: no cell matches all of it");
}

bool sets(const Settings& settings, std::string_view name) {
  return std::any_of(settings.begin(), settings.end(),
                     [&](const Setting& each) { return each.first == name; });
}
/// Where a cell has a parameter from: the label of an axis' value, or "" for the definition's
/// table.
std::optional<std::string> set_in(const Definition& definition, const Cell& cell,
                                  std::string_view name) {
  for (const auto& axis : definition.axes)
    for (const auto& value : axis.values)
      if (sets(value.settings, name) && cell[axis.name] == value.label)
        return "axis " + value.label;
  if (sets(definition.parameters, name)) return "";
  return {};
}

/// Throws Unusable for a parameter that is set in one place for cells of which each has a
/// configuration, too: it would be ignored. (At most one axis sets a parameter.)
void check_configurations(const Definition& definition, const std::vector<Cell>& cells) {
  const auto is_configured = [](const Cell& cell) { return !cell["configuration"].empty(); };
  if (std::none_of(cells.begin(), cells.end(), is_configured)) return;
  for (const std::string_view name : set_by_configuration()) {
    std::map<std::string, bool> is_ignored;
    for (const Cell& cell : cells)
      if (const auto place = set_in(definition, cell, name)) {
        bool& all = is_ignored.emplace(*place, true).first->second;
        all = all && is_configured(cell);
      }
    for (const auto& [place, all] : is_ignored)
      if (all) refuse_beside_configuration(name);
  }
}

}  // namespace

void check(const Definition& definition) {
  try {
    const auto cells = cells_of(definition);
    check_configurations(definition, cells);
    for (const auto& axis : definition.axes) {
      check_axis_name(axis);
      if (definition.has_series && axis.name == frame_columns[0])
        throw Unusable("axis 'frame': a series has a column of that name");
    }
    std::map<std::string, bool> peers_asked;
    bool any_asked = false;
    for (const auto& cell : cells) {
      check(cell);
      any_asked |= has_answer(cell);
      if (!cell["peer"].empty()) peers_asked[cell["peer"]] |= has_answer(cell);
    }
    for (const auto& [name, asked] : peers_asked)
      if (!asked && peer(name))
        throw Unusable("peer " + name + " answers none of these queries: it answers " +
                       std::string(peer(name)->queries));
    if (!any_asked)
      throw Unusable("all its peers were absent when bvlab was built, for example " +
                     peers_asked.begin()->first);
    check_series_matches(definition, cells);
  } catch (const Unusable& fault) {
    const std::string what = fault.what();
    if (what.starts_with(definition.file)) throw;
    throw Unusable(definition.file, what);
  }
}

void check_extends(const Definition& held, const Definition& definition) {
  if (held.name != definition.name) throw Unusable("it is named " + held.name);
  if (held.repetitions > definition.repetitions)
    throw Unusable("it has " + std::to_string(held.repetitions) + " repetitions, the definition " +
                   std::to_string(definition.repetitions));
  const auto cells = cells_with_answers(definition), before = cells_with_answers(held);
  const auto labels = [](const Cell& cell) {
    Row names;
    for (const auto& [name, value] : cell.labels) names.push_back(name);
    return names;
  };
  if (labels(cells.at(0)) != labels(before.at(0)))
    throw Unusable("its axes of several parameters differ");
  std::set<Row> there;
  for (const Cell& cell : cells) there.insert(key_row(cell));
  for (const Cell& cell : before)
    if (!there.contains(key_row(cell))) {
      std::string what;
      for (const auto& axis : held.axes)
        what += (what.empty() ? "" : ", ") + axis.name + " = " + cell[axis.name];
      throw Unusable("its cell " + (what.empty() ? "" : what + " ") + "is not in the definition");
    }
  if (held.has_series && (!definition.has_series || held.series != definition.series ||
                          held.series_until != definition.series_until))
    throw Unusable("its series differ");
  for (const auto& measure : held.measures)
    if (!definition.measures.contains(measure))
      throw Unusable("it measures " + measure + ", the definition does not");
}

void write_cells(const Definition& definition, const std::filesystem::path& folder) {
  const auto cells = cells_with_answers(definition, AbsentPeers::kept);
  const bool has_coherence =
      definition.measures.contains("coherence") || definition.measures.contains("best rebuilds");
  Row columns, axes;
  for (const auto* settings : {&cells.at(0).labels, &cells.at(0).parameters})
    for (const auto& [name, value] : *settings) columns.push_back(name);
  for (const Row* measured : {&measured_columns, &coherence_columns})
    if (measured == &measured_columns || has_coherence)
      columns.insert(columns.end(), measured->begin(), measured->end());
  for (const auto& axis : definition.axes) axes.push_back(axis.name);
  if (definition.has_series) axes.insert(axes.end(), frame_columns.begin(), frame_columns.end());
  Table rows(folder / (definition.name + ".csv"), columns);
  Table frames(folder / (definition.name + ".frames.csv"), axes);
  for (const Cell& cell : cells) {
    Row row = key_row(cell);
    row.push_back("0");
    row.resize(columns.size());
    rows.add(std::move(row));
    if (!wants_series(definition, cell)) continue;
    Row frame;
    for (const auto& axis : definition.axes) frame.push_back(cell[axis.name]);
    frame.resize(axes.size());
    frames.add(std::move(frame));
  }
  rows.save();
  if (!axes.empty()) frames.save();
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
