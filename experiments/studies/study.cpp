// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/studies/study.hpp"

#include <algorithm>
#include <stdexcept>

#include "experiments/definitions/definition.hpp"
#include "experiments/definitions/toml.hpp"
#include "experiments/files/joined.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/scenes/named_mesh.hpp"
#include "experiments/studies/figures_checked.hpp"

namespace bvlab {
namespace {

/// THE list of kinds.
const StudyKind* const kinds[] = {&studies::boxes,     &studies::distance,  &studies::stability,
                                  &studies::tightness, &studies::triangles, &studies::worlds};

const StudyKind& kind_of(const StudyDefinition& definition) {
  for (const auto* kind : kinds)
    if (kind->name == definition.kind) return *kind;
  throw Unusable(definition.file, "unknown kind '" + definition.kind +
                                      "'; available: " + joined(kinds, &StudyKind::name));
}

const StudyParameter* find(const StudyParameters& all, const std::string& key) {
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const auto& parameter) { return parameter.name == key; });
  return found == all.end() ? nullptr : &*found;
}

const StudyParameter& parameter_named(const std::string& key, const StudyParameters& all,
                                      const StudyDefinition& definition) {
  if (const StudyParameter* parameter = find(all, key)) return *parameter;
  throw Unusable(definition.file, "unknown parameter '" + key + "' of kind " + definition.kind +
                                      "; available: " + joined(all, &StudyParameter::name));
}

class Reader : TomlReader {
 public:
  using TomlReader::TomlReader;

  StudyDefinition read(const toml::table& from) const {
    StudyDefinition definition;
    definition.file = file_;
    definition.kind = word(*from.get("kind"));
    for (auto&& [key, node] : from) {
      if (key == "name")
        definition.name = word(node);
      else if (key == "repetitions")
        definition.repetitions = repetitions(node);
      else if (key == "parameters")
        for (auto&& [name, value] : table(node, "parameters"))
          definition.parameters[std::string(name.str())] = words(value);
      else if (key == "figure")
        definition.has_figures = true;
      else if (key != "kind" && key != "description")
        fail(node.source(), "unknown key '" + std::string(key.str()) + "' of a study");
    }
    require_name(definition.name);
    return definition;
  }

 private:
  std::string word(const toml::node& node) const {
    if (auto value = scalar(node)) return *std::move(value);
    fail(node.source(), "must be a number, a string or a list of them");
  }
  std::vector<std::string> words(const toml::node& node) const {
    const auto* list = node.as_array();
    if (!list) return {word(node)};
    std::vector<std::string> all;
    for (auto&& each : *list) all.push_back(word(each));
    return all;
  }
};

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
  if (!table.get("kind")) return {};
  StudyDefinition definition = Reader(file).read(table);
  definition.text = text;
  return definition;
}

void check(const StudyDefinition& definition) {
  const StudyKind& kind = kind_of(definition);
  const StudyParameters all = kind.parameters();
  for (const auto& [key, values] : definition.parameters)
    parameter_named(key, all, definition).check(values, definition.file);
  if (kind.check) name_file(definition.file, [&] { kind.check(definition); });
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
      progress_(progress),
      repetitions_(definition.repetitions) {
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
