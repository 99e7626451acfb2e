// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/studies/study.hpp"

#include <algorithm>
#include <stdexcept>

#include "experiments/definitions/definition.hpp"
#include "experiments/definitions/toml.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/scenes/named_mesh.hpp"
#include "experiments/studies/figures_checked.hpp"

namespace bvlab {
namespace {

/// THE list of kinds.
const StudyKind* const kinds[] = {&studies::boxes,     &studies::distance,  &studies::stability,
                                  &studies::tightness, &studies::triangles, &studies::worlds};

const StudyKind& kind_of(const StudyDefinition& definition) {
  std::string names;
  for (const auto* kind : kinds) {
    if (kind->name == definition.kind) return *kind;
    names += (names.empty() ? "" : ", ") + std::string(kind->name);
  }
  throw Unusable(definition.file, "unknown kind '" + definition.kind + "'; available: " + names);
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

const StudyParameter* find(const StudyParameters& all, const std::string& key) {
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const auto& parameter) { return parameter.name == key; });
  return found == all.end() ? nullptr : &*found;
}

const StudyParameter& parameter_named(const std::string& key, const StudyParameters& all,
                                      const StudyDefinition& definition) {
  if (const StudyParameter* parameter = find(all, key)) return *parameter;
  std::string names;
  for (const auto& each : all) names += (names.empty() ? "" : ", ") + each.name;
  throw Unusable(definition.file, "unknown parameter '" + key + "' of kind " + definition.kind +
                                      "; available: " + names);
}

}  // namespace

std::span<const StudyKind* const> study_kinds() { return kinds; }

std::vector<std::string> StudyDefinition::words(const std::string& key) const {
  const StudyParameters all = kind_of(*this).parameters();
  const StudyParameter* parameter = find(all, key);
  if (!parameter) throw std::logic_error(kind + " has no parameter " + key);
  const auto found = parameters.find(key);
  if (found == parameters.end()) return parameter->fallback;
  parameter->check(found->second, file);
  return found->second;
}

std::vector<double> StudyDefinition::numbers(const std::string& key) const {
  std::vector<double> values;
  for (const auto& text : words(key)) values.push_back(number_of(text, key, file));
  return values;
}

std::vector<std::size_t> StudyDefinition::wholes(const std::string& key) const {
  std::vector<std::size_t> values;
  for (const double value : numbers(key)) values.push_back(static_cast<std::size_t>(value));
  return values;
}

TriangleMesh mesh_of(const StudyDefinition& definition, const std::string& name) {
  auto meshes = named_meshes(name, definition.whole("polygons"));
  if (meshes.size() != 1) throw Unusable(definition.file, name + ": must be one mesh");
  return std::move(meshes[0].mesh);
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
      definition.has_figures = true;
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
  const StudyParameters all = kind.parameters();
  for (const auto& [key, values] : definition.parameters)
    parameter_named(key, all, definition).check(values, definition.file);
  if (!kind.check) return;
  try {
    kind.check(definition);
  } catch (const Unusable& fault) {
    // Names are refused by those who look them up, and they don't know the file.
    const std::string what = fault.what();
    if (what.starts_with(definition.file)) throw;
    throw Unusable(definition.file, what);
  }
}

void check_extends(const StudyDefinition& held, const StudyDefinition& definition) {
  if (held.name != definition.name) throw Unusable("it is named " + held.name);
  if (held.kind != definition.kind) throw Unusable("it is of kind " + held.kind);
  if (held.repetitions != definition.repetitions || held.parameters != definition.parameters)
    throw Unusable("a study can be continued only with the same parameters and repetitions");
}

void run_study(const StudyDefinition& definition, const std::filesystem::path& folder,
               const Progress& progress) {
  const StudyKind& kind = kind_of(definition);
  StudyRecord record(definition, folder, kind.columns, progress);
  kind.run(definition, record);
}

StudyRecord::StudyRecord(const StudyDefinition& definition, const std::filesystem::path& folder,
                         Row columns, const Progress& progress)
    : table_(folder / (definition.name + ".csv"), std::move(columns)),
      folder_(folder),
      progress_(progress) {
  if (!definition.has_figures) return;
  check_figures(definition.text, definition.file, [&](const std::filesystem::path& to) {
    Table(to / (definition.name + ".csv"), table_.columns()).save();
  });
}

void StudyRecord::save(std::size_t done, std::size_t all) {
  if (done < all) mark_unfinished(folder_, "parts", done, all);
  table_.save();
  if (done == all) mark_finished(folder_);
  progress_(done, all);
}

}  // namespace bvlab
