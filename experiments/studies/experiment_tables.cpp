// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/studies/experiment_tables.hpp"

#include <algorithm>

#include "experiments/files/unusable.hpp"
#include "experiments/studies/cells.hpp"
#include "experiments/studies/experiment.hpp"

namespace bvlab {
namespace {

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

bool matters_to_front(const std::string& name) {
  return !is_of_variant(name) || name == "volume" || name == "query" || name == "build" ||
         name == "leaf_size" || name == "fit" || name == "fan_out";
}

Settings key_settings(By by, const Definition& definition, const Cell& cell) {
  Settings key;
  if (by == By::axes)
    for (const auto& axis : definition.axes) key.emplace_back(axis.name, cell[axis.name]);
  if (by == By::cell) key = cell.labels;
  if (by != By::axes)
    for (const Setting& each : cell.parameters)
      if (by == By::cell || matters_to_front(each.first)) key.push_back(each);
  return key;
}

Row columns_of(const TableForm& form, const Definition& definition, const Cell& any) {
  Row row = names_of(form.by, definition, any);
  row.insert(row.end(), form.measured.begin(), form.measured.end());
  return row;
}

/// What is computed of a record when it is read: see plots/bvlab_plots/records.py.
const Row computed_columns{"later_ns", "later_pairs", "survival"};

}  // namespace

const TableForm forms::rows{
    "",
    By::cell,
    {"repetition", "time_ns", "first_ns", "build_ns", "pairs", "hits", "differing", "n_u", "n_v",
     "n_p", "front", "node", "alone", "wall_per_processor", "p99_ns", "worst_ns"}};
const TableForm forms::counted{
    ".counted", By::cell, {"pairs", "hits", "differing", "n_u", "n_v", "n_p", "front"}};
const TableForm forms::frames{".frames", By::axes, {"frame", "n_u", "n_v", "n_p", "front", "hits"}};
const TableForm forms::disagreements{
    ".disagreements",
    By::axes,
    {"frame", "object_i", "object_j", "triangle_i", "triangle_j", "theirs", "ours", "exact"}};
const TableForm forms::coherence{
    ".coherence", By::front,
    with_steps({"pair_runs", "near_runs", "moved_runs", "still_runs", "tests", "entries", "kept",
                "grown", "again", "still_entries", "motion_leaf", "motion_gap", "best_tests",
                "best_rebuilds"})};
const TableForm forms::predictions{
    ".predictions",
    By::front,
    {"strategy", "n_v", "n_p", "time_ns", "taken_ns", "low_ns", "high_ns"}};

Row key_of(By by, const Definition& definition, const Cell& cell) {
  Row row;
  for (auto& [name, value] : key_settings(by, definition, cell)) row.push_back(std::move(value));
  return row;
}

Row names_of(By by, const Definition& definition, const Cell& cell) {
  Row row;
  for (auto& [name, value] : key_settings(by, definition, cell)) row.push_back(std::move(name));
  return row;
}

ExperimentTable::ExperimentTable(const std::filesystem::path& record, const Definition& definition,
                                 const Cell& any, const TableForm& form)
    : Table(record / (definition.name + form.ending + ".csv"), columns_of(form, definition, any)),
      definition_(definition),
      by_(form.by),
      keys_(std::ssize(columns()) - std::ssize(form.measured)) {}

void ExperimentTable::replace(const Row& key, std::vector<Row> rows) {
  if (!has(key)) {
    if (!rows.empty()) append(std::move(rows));
    return;
  }
  forget(key);
  for (Row& row : rows) add(std::move(row));
  save();
}

std::vector<Row> series_rows(const Row& key, const Definition& definition,
                             const ReplayResult& counted) {
  std::vector<Row> rows;
  const std::size_t until = std::min(counted.series.size(), definition.series_until);
  for (std::size_t frame = 0; frame < until; ++frame) {
    const auto& c = counted.series[frame];
    add_to(rows.emplace_back(key), frame, c.n_u, c.n_v, c.n_p, c.front, c.hits);
  }
  return rows;
}

std::vector<Row> disagreement_rows(const Row& key, const std::vector<Disagreement>& all) {
  std::vector<Row> rows;
  for (const auto& each : all)
    add_to(rows.emplace_back(key), each.frame, each.i, each.j, each.triangle_i, each.triangle_j,
           each.theirs, each.ours, each.exact);
  return rows;
}

Row coherence_row(Row row, const CoherenceSums& c, const std::optional<BestRebuilds>& best) {
  add_to(row, c.pair_runs, c.near_runs, c.moved_runs, c.still_runs, c.tests, c.entries, c.kept,
         c.grown, c.again, c.still_entries, std::to_string(c.motion_leaf),
         std::to_string(c.motion_gap), best ? std::to_string(best->tests) : "",
         best ? std::to_string(best->rebuilds) : "");
  for (const StepSums& s : c.steps) add_to(row, s.runs, s.entries, s.tests, s.again, s.raised);
  for (const TwoRunSums& s : c.two) add_to(row, s.runs, s.kept, s.rebuilt);
  return row;
}

bool wants_series(const Definition& definition, const Cell& cell) {
  return definition.has_series && cell["peer"].empty() &&
         std::all_of(definition.series.begin(), definition.series.end(),
                     [&](const Setting& s) { return cell[s.first] == s.second; });
}

bool measures_best_rebuilds(const Definition& definition) {
  return definition.measures.contains("best rebuilds");
}
bool measures_coherence(const Definition& definition) {
  return definition.measures.contains("coherence") || measures_best_rebuilds(definition);
}

void check_axis_name(const Definition::Axis& axis) {
  if (axis.is_parameter) return;
  for (const Row* columns :
       {&forms::rows.measured, &forms::frames.measured, &forms::disagreements.measured,
        &forms::coherence.measured, &forms::predictions.measured, &computed_columns})
    if (std::find(columns->begin(), columns->end(), axis.name) != columns->end())
      throw Unusable("axis '" + axis.name + "': a record has a column of that name");
}

void write_cells(const Definition& definition, const std::filesystem::path& folder) {
  const auto cells = cells_with_answers(definition, AbsentPeers::kept);
  TableForm measured = forms::rows;
  if (measures_coherence(definition))
    measured.measured.insert(measured.measured.end(), forms::coherence.measured.begin(),
                             forms::coherence.measured.end());
  ExperimentTable rows(folder, definition, cells.at(0), measured);
  ExperimentTable frames(
      folder, definition, cells.at(0),
      definition.has_series ? forms::frames : TableForm{".frames", By::axes, {}});
  for (const Cell& cell : cells) {
    Row row = rows.key(cell);
    row.push_back("0");
    row.resize(rows.columns().size());
    rows.add(std::move(row));
    if (!wants_series(definition, cell)) continue;
    Row frame = frames.key(cell);
    frame.resize(frames.columns().size());
    frames.add(std::move(frame));
  }
  rows.save();
  if (!frames.columns().empty()) frames.save();
}

}  // namespace bvlab
