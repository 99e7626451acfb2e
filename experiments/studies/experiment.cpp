// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/studies/experiment.hpp"

#include <algorithm>
#include <cstdio>
#include <future>
#include <map>
#include <mutex>
#include <numeric>
#include <random>
#include <set>

#include "experiments/files/unusable.hpp"
#include "experiments/peers/peers.hpp"
#include "experiments/recorder/node.hpp"
#include "experiments/replay/predict.hpp"
#include "experiments/studies/cells.hpp"
#include "experiments/studies/clocks.hpp"
#include "experiments/studies/experiment_tables.hpp"
#include "experiments/studies/side_by_side.hpp"
#include "experiments/studies/statistics.hpp"

namespace bvlab {
namespace {

std::string three_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", value);
  return text;
}

/// Cells that take a repetition each of the same trace, and what is known of them.
struct Work {
  std::size_t trace = 0;                   ///< in the whole definition
  std::vector<const Cell*> cells;          ///< all of the trace
  std::vector<std::vector<bool>> has_row;  ///< of each cell: of each repetition
  std::vector<Row> counts;  ///< of each cell, as in the table of counts; empty: to be counted

  /// How many cells are to be counted: not those whose rows are all there.
  std::size_t to_count() const {
    return static_cast<std::size_t>(std::count(counts.begin(), counts.end(), Row{}));
  }
  std::size_t rows_lacking() const {
    std::size_t lacking = 0;
    for (const auto& each : has_row)
      lacking += static_cast<std::size_t>(std::count(each.begin(), each.end(), false));
    return lacking;
  }
};

class Experiment {
 public:
  Experiment(const Definition& definition, const std::filesystem::path& record,
             const RunOptions& options)
      : definition_(definition),
        options_(options),
        record_(record),
        cells_(cells_with_answers(definition)),
        traces_(traces_of(cells_)),
        rows_(record, definition, cells_.at(0), forms::rows),
        counted_(record, definition, cells_[0], forms::counted),
        frames_(record, definition, cells_[0], forms::frames),
        disagreements_(record, definition, cells_[0], forms::disagreements),
        coherence_(record, definition, cells_[0], forms::coherence),
        predictions_(record, definition, cells_[0], forms::predictions) {
    check_measured();
    const auto [number, of] = options.part;
    for (std::size_t trace = (number - 1) * traces_.size() / of;
         trace < number * traces_.size() / of; ++trace)
      works_.push_back(work_of(trace));
    take_rows();
  }

  void run(const Progress& progress) {
    std::size_t rows_wanted = 0;
    bool is_finished = true;
    for (const Work& work : works_) {
      rows_wanted += work.cells.size() * repetitions();
      all_ += work.to_count() + (is_timed() ? work.rows_lacking() : 0);
      is_finished = is_finished && work.to_count() + work.rows_lacking() == 0;
    }
    progress_ = &progress;
    progress(0, all_);
    if (!is_finished) mark_unfinished(record_, "rows", rows_.rows().size(), rows_wanted);
    const std::size_t beside = is_timed() ? 1 : std::min(options_.threads, works_.size());
    const std::size_t threads = options_.threads / std::max<std::size_t>(beside, 1);
    side_by_side(works_.size(), beside, [&](std::size_t i) { finish(works_[i], threads); });
    for (auto* table : {&rows_, &frames_, &disagreements_, &coherence_, &predictions_})
      put_in_order(*table);
    counted_.discard();
    mark_finished(record_);
  }

 private:
  bool is_timed() const { return options_.measured == Measured::counts_and_times; }
  std::size_t repetitions() const { return is_timed() ? definition_.repetitions : 1; }

  /// Times that are absent would pass for finished.
  void check_measured() const {
    for (const auto& row : rows_.rows())
      if (const bool has_time = !rows_.measured(row, 1)->empty(); has_time != is_timed())
        throw Unusable(record_.string(), has_time ? "holds times: not a record of counts only"
                                                  : "holds counts alone: go on with --counts");
  }

  Work work_of(std::size_t trace) const {
    Work work{trace, {}, {}, {}};
    for (const auto i : traces_[trace]) work.cells.push_back(&cells_[i]);
    work.has_row.assign(work.cells.size(), std::vector<bool>(repetitions()));
    work.counts.resize(work.cells.size());
    return work;
  }

  /// Marks what is there. Rows of peers that this program was built without stay.
  void take_rows() {
    std::map<Row, std::pair<Work*, std::size_t>> held;
    for (Work& work : works_)
      for (std::size_t i = 0; i < work.cells.size(); ++i)
        held[rows_.key(*work.cells[i])] = {&work, i};
    const auto fail = [&](std::size_t row, const std::string& what) {
      throw Unusable((record_ / (definition_.name + ".csv")).string(),
                     "row " + std::to_string(row + 1) + " " + what);
    };
    const auto& columns = rows_.columns();
    const auto peer = std::find(columns.begin(), columns.end(), "peer") - columns.begin();
    for (std::size_t i = 0; i < rows_.rows().size(); ++i) {
      const Row& row = rows_.rows()[i];
      const auto place = held.find(rows_.key(row));
      if (place == held.end()) {
        if (row[static_cast<std::size_t>(peer)].empty()) fail(i, "is of no cell of the definition");
        continue;
      }
      auto& [work, cell] = place->second;
      const std::string& written = *rows_.measured(row);
      const auto repetition = number_in<std::size_t>(written);
      if (!repetition || *repetition >= repetitions())
        fail(i, "is of repetition '" + written + "', and the definition has " +
                    std::to_string(repetitions()));
      if (work->has_row[cell][*repetition]) fail(i, "is a second one of its cell and repetition");
      work->has_row[cell][*repetition] = true;
      take_counts(*work, cell, rows_.measured(row, 4));
    }
    for (const Row& row : counted_.rows())
      if (const auto place = held.find(counted_.key(row)); place != held.end())
        take_counts(*place->second.first, place->second.second, counted_.measured(row));
  }

  void take_counts(Work& work, std::size_t cell, Row::const_iterator counts) const {
    if (wants_series(definition_, *work.cells[cell]) &&
        !frames_.has(frames_.key(*work.cells[cell])))
      return;
    work.counts[cell].assign(counts, counts + std::ssize(forms::counted.measured));
  }

  /// What a trace lacks: counts, what is measured beside, times.
  void finish(Work& work, std::size_t threads) {
    const auto fronts = fronts_lacking(work, coherence_, measures_coherence(definition_));
    const auto unpredicted =
        fronts_lacking(work, predictions_, definition_.measures.contains("predictions"));
    if (work.rows_lacking() + work.to_count() + fronts.size() + unpredicted.size() == 0) return;
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
      options.keep_series = wants_series(definition_, *work.cells[cell]);
      const ReplayResult counted = answered(ready, *work.cells[cell], options);
      keep_counted(ready, work, cell, counted, reference.get(), slack);
    });
  }

  void keep_counted(const Prepared& ready, Work& work, std::size_t i, const ReplayResult& counted,
                    const ReplayResult& reference, double slack) {
    const Cell& cell = *work.cells[i];
    const bool ours = cell["peer"].empty();
    const std::size_t differ = differing(counted, reference, ours ? 0 : slack);
    constexpr std::size_t most = 10;
    std::vector<Disagreement> disagreed;
    if (!ours && differ > 0)
      disagreed = disagreements(ready.meshes, ready.trace, counted, reference, slack, most);
    // Of peers, those that count.
    const auto number = [&](std::uint64_t n) { return ours || n > 0 ? text_of(n) : ""; };
    add_to(work.counts[i], ready.trace.pairs() * ready.trace.frames, counted.hits, differ,
           number(counted.n_u), number(counted.n_v), number(counted.n_p),
           ours ? std::to_string(counted.front) : "");
    over([&] {
      const Row key = frames_.key(cell);
      frames_.replace(key, series_rows(key, definition_, counted));
      disagreements_.replace(key, disagreement_rows(key, disagreed));
      if (!is_timed()) {
        if (!work.has_row[i][0]) rows_.append({row_of(work, i, 0, nullptr, 1)});
        return;
      }
      Row row = counted_.key(cell);
      row.insert(row.end(), work.counts[i].begin(), work.counts[i].end());
      counted_.append({std::move(row)});
    });
  }

  using Fronts = std::vector<std::pair<Row, const Cell*>>;

  /// The fronts that cells of a trace have, each with one of its cells, that have no rows yet.
  Fronts fronts_lacking(const Work& work, const ExperimentTable& table, bool is_wanted) {
    std::map<Row, const Cell*> fronts;
    if (!is_wanted) return {};
    const std::lock_guard lock(guard_);
    for (const Cell* cell : work.cells)
      if ((*cell)["peer"].empty() && (*cell)["kernel"] == "gathered" &&
          (*cell)["query"] != "distance")
        if (const Row key = table.key(*cell); !is_measured(table, key)) fronts.emplace(key, cell);
    return {fronts.begin(), fronts.end()};
  }

  bool is_measured(const ExperimentTable& table, const Row& key) const {
    const Row& columns = table.columns();
    const auto best = std::find(columns.begin(), columns.end(), "best_rebuilds") - columns.begin();
    return std::any_of(table.rows().begin(), table.rows().end(), [&](const Row& row) {
      return std::equal(key.begin(), key.end(), row.begin()) &&
             (&table != &coherence_ ||
              (!row.back().empty() && (!measures_best_rebuilds(definition_) ||
                                       !row[static_cast<std::size_t>(best)].empty())));
    });
  }

  void measure_coherence(const Prepared& ready, const Fronts& fronts, std::size_t threads) {
    side_by_side(fronts.size(), threads, [&](std::size_t i) {
      const auto& [key, cell] = fronts[i];
      const Variant variant = variant_of(*cell);
      const CoherenceSums sums = coherence(ready.meshes, ready.trace, variant);
      std::optional<BestRebuilds> best;
      if (measures_best_rebuilds(definition_))
        best = best_rebuilds(ready.meshes, ready.trace, variant);
      const std::lock_guard lock(guard_);
      coherence_.replace(key, {coherence_row(key, sums, best)});
    });
  }

  /// One after the other: they say seconds, which are measured as times are (and empty where those
  /// are).
  void make_predictions(const Prepared& ready, const Fronts& fronts) {
    const auto seconds = [&](double s) { return is_timed() ? nanoseconds(s) : std::string(); };
    for (const auto& [key, cell] : fronts) {
      const auto run = undisturbed([&] {
        const double start = wall_seconds();
        auto predicted = predict(ready.meshes, ready.trace, variant_of(*cell));
        return std::pair(std::move(predicted), wall_seconds() - start);
      });
      std::vector<Row> rows;
      for (const Predicted& each : run.result.first)
        add_to(rows.emplace_back(key), std::string(each.strategy), std::to_string(each.n_v),
               std::to_string(each.n_p), seconds(each.seconds), seconds(run.result.second),
               seconds(each.low), seconds(each.high));
      const std::lock_guard lock(guard_);
      predictions_.replace(key, std::move(rows));
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
    std::iota(order.begin(), order.end(), std::size_t{0});
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
    Row row = rows_.key(*work.cells[i]);
    add_to(row, repetition, time(&ReplayResult::seconds), time(&ReplayResult::first_seconds),
           time(&ReplayResult::build_seconds));
    Row counts = work.counts[i];
    if (timed) counts[1] = text_of(timed->hits);
    row.insert(row.end(), counts.begin(), counts.end());
    add_to(row, node_, timed ? neighbours_.alone() : "",
           timed ? three_digits(wall_per_processor) : "");
    // Of all frames but the first; empty where frames were not timed.
    const bool has_frames = timed && timed->frame_seconds.size() > 1;
    for (const double share : {0.99, 1.0})
      row.push_back(
          has_frames ? nanoseconds(percentile(
                           {timed->frame_seconds.begin() + 1, timed->frame_seconds.end()}, share))
                     : "");
    return row;
  }

  /// As a run writes them that was never broken off, whatever was finished first: by trace, and by
  /// repetition (of counts alone, and of a series, by cell; of fronts, in the order of their keys).
  /// Rows of absent peers go last.
  void put_in_order(ExperimentTable& table) const {
    if (table.rows().empty()) return;
    using Rank = std::pair<std::size_t, std::size_t>;
    std::map<Row, Rank> ranks;
    for (std::size_t trace = 0; trace < traces_.size(); ++trace)
      for (const auto i : traces_[trace]) ranks[table.key(cells_[i])] = {trace, i};
    if (table.by() == By::front)
      for (std::size_t nth = 0; auto& [key, rank] : ranks) rank.second = nth++;
    table.sort([&](const Row& one, const Row& other) {
      const auto rank_of = [&](const Row& row) {
        const auto found = ranks.find(table.key(row));
        if (found == ranks.end()) return Rank{-1, 0};
        const bool by_repetition = &table == &rows_ && is_timed();
        return Rank{found->second.first,
                    by_repetition ? std::stoul(*table.measured(row)) : found->second.second};
      };
      return rank_of(one) < rank_of(other);
    });
    table.save();
  }

  const Definition& definition_;
  const RunOptions& options_;
  const std::filesystem::path& record_;
  std::vector<Cell> cells_;
  std::vector<std::vector<std::size_t>> traces_;  ///< the cells of each
  ExperimentTable rows_, counted_, frames_, disagreements_, coherence_, predictions_;
  std::vector<Work> works_;  ///< of this part
  std::size_t done_ = 0, all_ = 0;
  const Progress* progress_ = nullptr;
  std::mutex guard_;  ///< tables and progress
  const std::string node_ = node_name();
  Neighbours neighbours_;
};

}  // namespace

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
