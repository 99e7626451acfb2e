// SPDX-License-Identifier: BSD-3-Clause
/// What a definition is refused for before anything is run.
#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "experiments/files/joined.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/peers/peers.hpp"
#include "experiments/replay/configurations.hpp"
#include "experiments/replay/variant_parameters.hpp"
#include "experiments/studies/cells.hpp"
#include "experiments/studies/experiment.hpp"
#include "experiments/studies/experiment_tables.hpp"

namespace bvlab {
namespace {

void check_some_cell_has(const std::string& name, const std::string& value,
                         const std::vector<Cell>& cells) {
  std::set<std::string> there;
  for (const Cell& cell : cells) there.insert(cell[name]);
  if (there.contains(value)) return;
  throw Unusable("series: " + name + " has no '" + value + "'; available: " +
                 joined(there, [](const std::string& each) { return "'" + each + "'"; }));
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

/// Throws Unusable for a peer that answers none of its cells, and where no cell has an answer.
void check_peers(const std::vector<Cell>& cells) {
  std::map<std::string, bool> answers;
  bool any_answers = false;
  for (const auto& cell : cells) {
    any_answers |= has_answer(cell);
    if (!cell["peer"].empty()) answers[cell["peer"]] |= has_answer(cell);
  }
  for (const auto& [name, has_any] : answers)
    if (!has_any && peer(name))
      throw Unusable("peer " + name + " answers none of these queries: it answers " +
                     std::string(peer(name)->queries));
  if (!any_answers)
    throw Unusable("all its peers were absent when bvlab was built, for example " +
                   answers.begin()->first);
}

}  // namespace

void check(const Definition& definition) {
  name_file(definition.file, [&] {
    const auto cells = cells_of(definition);
    check_configurations(definition, cells);
    for (const auto& axis : definition.axes) {
      check_axis_name(axis);
      if (definition.has_series && axis.name == forms::frames.measured[0])
        throw Unusable("axis 'frame': a series has a column of that name");
    }
    for (const auto& cell : cells) check(cell);
    check_peers(cells);
    check_series_matches(definition, cells);
  });
}

DefinitionSize size_of(const Definition& definition) {
  const auto cells = cells_with_answers(definition);
  return {traces_of(cells).size(), cells.size()};
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
  for (const Cell& cell : cells) there.insert(key_of(By::cell, definition, cell));
  for (const Cell& cell : before)
    if (!there.contains(key_of(By::cell, held, cell))) {
      const std::string what =
          joined(held.axes, [&](const auto& axis) { return axis.name + " = " + cell[axis.name]; });
      throw Unusable("its cell " + (what.empty() ? "" : what + " ") + "is not in the definition");
    }
  if (held.has_series && (!definition.has_series || held.series != definition.series ||
                          held.series_until != definition.series_until))
    throw Unusable("its series differ");
  for (const auto& measure : held.measures)
    if (!definition.measures.contains(measure))
      throw Unusable("it measures " + measure + ", the definition does not");
}

}  // namespace bvlab
