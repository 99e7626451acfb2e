// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/studies/study.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "experiments/definitions/definition.hpp"
#include "experiments/definitions/figure_tables.hpp"
#include "experiments/files/unusable.hpp"

namespace bvlab {
namespace {

/// THE list of kinds.
const StudyKind* const kinds[] = {&studies::boxes,     &studies::box_precision, &studies::budget,
                                  &studies::distance,  &studies::memory,
                                  &studies::posing,    &studies::stability,     &studies::tightness,
                                  &studies::triangles, &studies::worlds};

const StudyKind& kind_of(const StudyDefinition& definition) {
  std::string names;
  for (const auto* kind : kinds) {
    if (kind->name == definition.kind) return *kind;
    names += (names.empty() ? "" : ", ") + std::string(kind->name);
  }
  throw Unusable(definition.file, "unknown kind '" + definition.kind + "'; there are " + names);
}

[[noreturn]] void fail(const std::string& file, const toml::node& node, const std::string& what) {
  throw Unusable(file, "line " + std::to_string(node.source().begin.line) + ": " + what);
}

std::string scalar(const std::string& file, const toml::node& node) {
  if (const auto value = node.value_exact<std::string>()) return *value;
  if (const auto value = node.value_exact<std::int64_t>()) return std::to_string(*value);
  if (const auto value = node.value_exact<double>()) return text_of(*value);
  fail(file, node, "must be a number, a string or a list of them");
}

/// Keys that were asked for, so that the others can be refused.
std::set<std::string>& asked() {
  thread_local std::set<std::string> keys;
  return keys;
}

}  // namespace

std::string text_of(double value) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  return {text, end};
}

std::vector<std::string> StudyDefinition::strings(const std::string& key,
                                                  std::vector<std::string> fallback) const {
  asked().insert(key);
  const auto found = parameters.find(key);
  return found == parameters.end() ? fallback : found->second;
}

std::vector<double> StudyDefinition::numbers(const std::string& key,
                                             std::vector<double> fallback) const {
  asked().insert(key);
  const auto found = parameters.find(key);
  if (found == parameters.end()) return fallback;
  std::vector<double> values;
  for (const auto& text : found->second) {
    double& value = values.emplace_back();
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
      throw Unusable(file, key + " = " + text + ": not a number");
  }
  return values;
}

double StudyDefinition::number(const std::string& key, double fallback) const {
  const auto values = numbers(key, {fallback});
  if (values.size() != 1) throw Unusable(file, key + " must be one number");
  return values[0];
}

std::size_t StudyDefinition::whole(const std::string& key, std::size_t fallback,
                                   std::size_t most) const {
  const double value = number(key, static_cast<double>(fallback));
  if (!(value >= 1 && value <= static_cast<double>(most)) || value != std::floor(value))
    throw Unusable(file, key + " must be a whole number from 1 to " + std::to_string(most));
  return static_cast<std::size_t>(value);
}

std::optional<StudyDefinition> study_from(const std::string& text, const std::string& file) {
  // What the reader of experiments refuses before it parses is refused here, too, by that reader.
  if (text.find("kind") == std::string::npos) return {};
  check_text(text, file);
  toml::table table;
  try {
    table = toml::parse(text, file);
  } catch (const toml::parse_error&) {
    return {};  // the other reader says what is wrong
  }
  const auto* kind = table.get("kind");
  if (!kind) return {};
  StudyDefinition definition;
  definition.file = file, definition.text = text;
  definition.kind = scalar(file, *kind);
  for (auto&& [key, node] : table) {
    if (key == "name") {
      definition.name = scalar(file, node);
    } else if (key == "repetitions") {
      const auto value = node.value_exact<std::int64_t>();
      if (!value || *value < 1 || *value > 1000)
        fail(file, node, "repetitions must be a whole number from 1 to 1000");
      definition.repetitions = static_cast<unsigned>(*value);
    } else if (key == "parameters") {
      const auto* parameters = node.as_table();
      if (!parameters) fail(file, node, "parameters must be a table");
      for (auto&& [name, value] : *parameters) {
        auto& list = definition.parameters[std::string(name.str())];
        if (const auto* array = value.as_array())
          for (auto&& each : *array) list.push_back(scalar(file, each));
        else
          list.push_back(scalar(file, value));
      }
    } else if (key == "figure") {
      definition.figures = read_figures(node, file);
    } else if (key != "kind" && key != "description") {
      fail(file, node, "unknown key '" + std::string(key.str()) + "' of a study");
    }
  }
  if (definition.name.empty() || definition.name.find('/') != std::string::npos)
    throw Unusable(file, "needs a name (without '/')");
  return definition;
}

void check(const StudyDefinition& definition) {
  const StudyKind& kind = kind_of(definition);
  asked().clear();
  try {
    kind.check(definition);
  } catch (const Unusable& fault) {
    // Names are refused by those who look them up, and they don't know the file.
    const std::string what = fault.what();
    if (what.starts_with(definition.file)) throw;
    throw Unusable(definition.file, what);
  }
  std::string names;
  for (const auto& key : asked()) names += (names.empty() ? "" : ", ") + key;
  for (const auto& [key, value] : definition.parameters)
    if (!asked().contains(key))
      throw Unusable(definition.file, "unknown parameter '" + key + "' of kind " + definition.kind +
                                          "; there are " + names);
}

void check_extends(const StudyDefinition& held, const StudyDefinition& definition) {
  if (held.name != definition.name) throw Unusable("it is named " + held.name);
  if (held.kind != definition.kind) throw Unusable("it is of kind " + held.kind);
  if (held.repetitions != definition.repetitions || held.parameters != definition.parameters)
    throw Unusable("a study goes on with the same parameters and repetitions alone");
}

void run_study(const StudyDefinition& definition, const std::filesystem::path& folder,
               const Progress& progress) {
  kind_of(definition).run(definition, folder, progress);
}

StudyRecord::StudyRecord(const StudyDefinition& definition, const std::filesystem::path& folder,
                         Row columns, std::size_t keys, const Progress& progress)
    : table_(folder / (definition.name + ".csv"), std::move(columns)),
      folder_(folder),
      keys_(keys),
      progress_(progress) {
  DrawnColumns there;
  there.record = table_.columns();
  for (const char* made : {"peer", "variant", "later_ns", "later_pairs"})
    there.record.push_back(made);
  check_figures(definition.figures, there, definition.file);
}

bool StudyRecord::has(const Row& key) const {
  const auto count = static_cast<std::ptrdiff_t>(std::min(keys_, key.size()));
  return std::any_of(table_.rows().begin(), table_.rows().end(), [&](const Row& row) {
    return std::equal(key.begin(), key.begin() + count, row.begin());
  });
}

void StudyRecord::save(std::size_t done, std::size_t all) {
  if (done < all) mark_unfinished(folder_, "parts", done, all);
  table_.save();
  if (done == all) mark_finished(folder_);
  progress_(done, all);
}

}  // namespace bvlab
