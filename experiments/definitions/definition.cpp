// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/definitions/definition.hpp"

#include <algorithm>
#include <set>
#include <sstream>

#include "experiments/definitions/toml.hpp"
#include "experiments/files/joined.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/files/whole_file.hpp"
#include "experiments/replay/variant_parameters.hpp"
#include "experiments/scenes/scenes.hpp"

namespace bvlab {
namespace {

/// Adds a scene's options, those that another scene has not named before.
struct AddingParameter {
  std::vector<Parameter>& all;
  template <class T>
  void operator()(std::string_view name, const T& value, std::string_view what) const {
    add(name, text_of(value), what);
  }
  void operator()(std::string_view name, const Length& value, std::string_view what) const {
    add(name, text_of(value), std::string(what) + " (a LENGTH)");
  }
  void add(std::string_view name, const std::string& value, std::string_view what) const {
    const auto same = [&](const Parameter& each) { return each.name == name; };
    if (std::none_of(all.begin(), all.end(), same))
      all.push_back({std::string(name), value, std::string(what)});
  }
};

/// Keys with dots make tables in tables, as deep as the file likes: reading them, and giving them
/// back, takes stack for each.
void check_depth(const std::string& text, const std::string& name) {
  constexpr std::ptrdiff_t deepest = 1000;
  std::istringstream lines(text);
  std::size_t number = 0;
  for (std::string line; ++number, std::getline(lines, line);)
    if (std::count(line.begin(), line.end(), '.') > deepest)
      throw Unusable(name, "line " + std::to_string(number) + ": more than " +
                               std::to_string(deepest) + " dots");
}

/// Behind the string that starts at `i`, or where it has to end at the latest.
std::size_t end_of_string(std::string_view text, std::size_t i) {
  const char quote = text[i];
  const std::string three(3, quote);
  const bool long_one = text.substr(i).starts_with(three);
  for (i += long_one ? 3 : 1; i < text.size(); ++i) {
    if (text[i] == '\n' && !long_one) return i;
    if (text[i] == '\\' && quote == '"' && !text.substr(i).starts_with("\\\n")) {
      ++i;
    } else if (text[i] == quote && !long_one) {
      return i + 1;
    } else if (text.substr(i).starts_with(three)) {
      // Quotes just before the end are part of the string.
      for (i += 3; text.substr(i, 1) == three.substr(0, 1);) ++i;
      return i;
    }
  }
  return text.size();
}

/// Letters beyond ASCII belong into strings and comments. (Elsewhere toml++ 3.3 asks whether they
/// are blanks, and on the answer for most of them runs into what it declares unreachable.)
void check_characters(std::string_view text, const std::string& name) {
  std::size_t line = 1;
  for (std::size_t i = text.starts_with("\xef\xbb\xbf") ? 3 : 0; i < text.size();) {
    std::size_t end = i + 1;
    if (text[i] == '#')
      end = std::min(text.find('\n', i), text.size());
    else if (text[i] == '"' || text[i] == '\'')
      end = end_of_string(text, i);
    else if (static_cast<unsigned char>(text[i]) >= 128)
      throw Unusable(name, "line " + std::to_string(line) +
                               ": a character that is not ASCII outside of strings and comments");
    line += static_cast<std::size_t>(std::count(&text[i], text.data() + end, '\n'));
    i = end;
  }
}

/// So that <name>.disagreements.csv is a name for a file.
constexpr std::size_t longest_name = 200;

/// Reads one definition.
class Reader : TomlReader {
 public:
  using TomlReader::TomlReader;

  Definition read(const std::string& text) {
    check_text(text, file_);
    toml::table table;
    try {
      table = toml::parse(text, file_);
    } catch (const toml::parse_error& error) {
      fail(error.source(), std::string(error.description()));
    }
    Definition definition;
    definition.text = text;
    definition.file = file_;
    for (auto&& [key, node] : table) {
      if (key == "name")
        definition.name = name(node, "name");
      else if (key == "description")
        definition.description = string(node, "description");
      else if (key == "repetitions")
        definition.repetitions = repetitions(node);
      else if (key == "measures")
        definition.measures = measures(node);
      else if (key == "parameters")
        definition.parameters = settings(node, {});
      else if (key == "axis")
        definition.axes = axes(node);
      else if (key == "series")
        read_series(node, definition);
      else if (key == "figure")
        definition.has_figures = true;
      else
        fail(key.source(), "unknown key '" + std::string(key.str()) + "'");
    }
    require_name(definition.name);
    if (definition.name.size() > longest_name)
      throw Unusable(file_, "the name is longer than " + std::to_string(longest_name) + " letters");
    check_size(definition.axes);
    check_series(definition);
    return definition;
  }

 private:
  void check_size(const std::vector<Definition::Axis>& axes) const {
    std::size_t cells = 1;
    for (const auto& axis : axes) {
      cells *= axis.values.size();
      if (cells > most_cells)
        throw Unusable(file_, "axis '" + axis.name + "': the axes up to this one multiply into " +
                                  std::to_string(cells) + " cells; " + std::to_string(most_cells) +
                                  " are the most");
    }
  }

  void check_series(const Definition& definition) const {
    for (const auto& [key, value] : definition.series) check_series(key, definition);
  }
  void check_series(const std::string& key, const Definition& definition) const {
    std::vector<std::string> names;
    for (const auto& axis : definition.axes)
      if (!axis.is_parameter) names.push_back(axis.name);
    for (const auto& [name, ignored] : default_parameters()) names.push_back(name);
    if (std::find(names.begin(), names.end(), key) == names.end())
      throw Unusable(file_, "series: unknown '" + key + "'; available: " + joined(names));
  }

  std::string string(const toml::node& node, const std::string& key) const {
    if (const auto value = node.value_exact<std::string>()) return *value;
    fail(node.source(), key + " must be a string");
  }

  /// Files and columns bear it.
  std::string name(const toml::node& node, const std::string& key) const {
    std::string value = string(node, key);
    if (value != one_line(value)) fail(node.source(), key + " holds a control character");
    return value;
  }

  std::set<std::string> measures(const toml::node& node) const {
    static const std::set<std::string> all{"best rebuilds", "coherence", "frames", "predictions"};
    const auto* list = node.as_array();
    if (!list) fail(node.source(), "measures must be a list");
    std::set<std::string> result;
    for (auto&& each : *list) {
      const auto name = each.value_exact<std::string>();
      if (!name || !all.contains(*name)) fail(each.source(), "measures: there are " + joined(all));
      result.insert(*name);
    }
    return result;
  }

  /// Of meshes also a list, which is written with commas between; `none` is the peer without a
  /// name.
  std::string setting(const toml::node& node, const std::string& key) const {
    const auto* list = key == "mesh" ? node.as_array() : nullptr;
    if (!list) {
      const std::string value = scalar(node, key);
      return key == "peer" && value == "none" ? "" : value;
    }
    std::string all;
    for (auto&& each : *list) {
      const std::string mesh = string(each, "a mesh in a list");
      if (mesh.find_first_not_of(' ') == mesh.npos || mesh.find(',') != mesh.npos)
        fail(each.source(), "mesh: '" + mesh + "' in a list must be one mesh, without commas");
      all += (all.empty() ? "" : ",") + mesh;
    }
    if (all.empty()) fail(node.source(), "mesh: the list is empty");
    return all;
  }

  std::string scalar(const toml::node& node, const std::string& key) const {
    if (auto value = TomlReader::scalar(node)) return *std::move(value);
    fail(node.source(), "'" + key + "' must be a number or a string");
  }

  static bool is_parameter(const std::string& name) {
    const auto& all = default_parameters();
    return std::any_of(all.begin(), all.end(),
                       [&](const auto& each) { return each.first == name; });
  }

  void known(const std::string& parameter, const toml::source_region& where) const {
    if (!is_parameter(parameter))
      fail(where, "unknown parameter '" + parameter +
                      "'; available: " + joined(parameters(), &Parameter::name));
  }

  void read_series(const toml::node& node, Definition& definition) const {
    definition.has_series = true;
    for (auto&& [key, value] : table(node, "series")) {
      if (key != "until") {
        definition.series.emplace_back(key.str(), scalar(value, std::string(key.str())));
        continue;
      }
      const auto frames = value.value_exact<std::int64_t>();
      if (!frames || *frames < 1) fail(value.source(), "until must be a whole number above 0");
      definition.series_until = static_cast<std::size_t>(*frames);
    }
  }

  Settings settings(const toml::node& node, std::string_view but) const {
    Settings result;
    for (auto&& [key, value] : table(node, "parameters")) {
      if (key == but) continue;
      const std::string name(key.str());
      if (name == "tree") {
        add_tree(scalar(value, name), key.source(), result);
        continue;
      }
      known(name, key.source());
      result.emplace_back(name, setting(value, name));
    }
    return result;
  }
  /// What definitions said before there were fan-outs and frames.
  void add_tree(const std::string& tree, const toml::source_region& where,
                Settings& settings) const {
    if (tree != "binary" && tree != "wide") fail(where, "tree must be binary or wide");
    const bool wide = tree == "wide";
    settings.emplace_back("fan_out", wide ? "native" : "2");
    settings.emplace_back("frame", wide ? "body" : "world");
    settings.emplace_back("kernel", wide ? "siblings" : "gathered");
  }

  std::vector<Definition::Axis> axes(const toml::node& node) const {
    const auto* array = node.as_array();
    if (!array) fail(node.source(), "axes are written as [[axis]]");
    std::vector<Definition::Axis> result;
    for (auto&& each : *array) {
      result.push_back(axis(table(each, "an axis")));
      for (std::size_t i = 0; i + 1 < result.size(); ++i) {
        if (result[i].name == result.back().name)
          fail(each.source(), "a second axis '" + result[i].name + "'");
        for (const auto& name : set_by(result[i]))
          if (set_by(result.back()).contains(name))
            fail(each.source(), "axis '" + result.back().name + "' sets '" + name + "', as axis '" +
                                    result[i].name + "' does");
      }
    }
    return result;
  }

  static std::set<std::string> set_by(const Definition::Axis& axis) {
    std::set<std::string> names;
    for (const auto& value : axis.values)
      for (const auto& [name, ignored] : value.settings) names.insert(name);
    return names;
  }

  Definition::Axis axis(const toml::table& from) const {
    Definition::Axis axis;
    const auto *name = from.get("name"), *values = from.get("values"), *tables = from.get("value");
    if (!name || !values == !tables)
      fail(from.source(), "an axis needs a name and either values or [[axis.value]]");
    axis.name = this->name(*name, "an axis' name");
    if (axis.name.empty()) fail(name->source(), "an axis' name is empty");
    for (auto&& [key, node] : from)
      if (key != "name" && key != "values" && key != "value")
        fail(key.source(), "unknown key '" + std::string(key.str()) + "' of an axis");
    const auto* list = (values ? values : tables)->as_array();
    if (!list || list->empty()) fail(from.source(), "axis '" + axis.name + "' has no values");
    axis.is_parameter = values != nullptr;
    if (values)
      known(axis.name, name->source());
    else if (is_parameter(axis.name))
      fail(name->source(), "axis '" + axis.name + "' is a parameter: it needs values");
    std::set<std::string> labels;
    for (auto&& each : *list) {
      if (values) {
        const std::string value = setting(each, axis.name);
        axis.values.push_back({value, {{axis.name, value}}});
      } else {
        const auto& one = table(each, "a value");
        const auto* label = one.get("name");
        if (!label) fail(one.source(), "a value of axis '" + axis.name + "' needs a name");
        axis.values.push_back({string(*label, "a value's name"), settings(one, "name")});
      }
      // The values in their rows distinguish cells.
      if (const auto& label = axis.values.back().label; !labels.insert(label).second)
        fail(each.source(), "axis '" + axis.name + "' has '" + label + "' twice");
    }
    return axis;
  }
};

/// Stands for a value until all axes have set theirs.
const std::string unsaid(1, '\0');

void set(Settings& settings, const Settings& to) {
  for (const auto& [name, value] : to)
    for (auto& [known, old] : settings)
      if (known == name) old = value;
}

/// Defaults, but for how much of a recorded motion is taken: all, where nothing else is said.
void set_unsaid(Cell& cell) {
  const bool is_recorded = cell["scene"] == Recorded::name;
  for (std::size_t i = 0; i < cell.parameters.size(); ++i) {
    auto& [name, value] = cell.parameters[i];
    if (value != unsaid) continue;
    const bool is_length = name == "objects" || name == "frames";
    value = is_recorded && is_length ? "0" : default_parameters()[i].second;
  }
}

/// Parameters that are columns only where a definition sets them: records from before there were
/// these can be continued.
bool is_column_where_set(std::string_view name) {
  return name == "joints" || name == "asked_pairs" || name == "without_pairs" || name == "groups";
}

}  // namespace

const std::string& Cell::operator[](std::string_view name) const {
  static const std::string nothing;
  for (const auto* settings : {&labels, &parameters})
    for (const auto& [key, value] : *settings)
      if (key == name) return value;
  return nothing;
}

const std::vector<Parameter>& parameters() {
  static const std::vector<Parameter> all = [] {
    std::vector<Parameter> all{
        {"scene", std::string(Scenes::at<0>::name), "how bodies move; see `bvlab list scenes`"},
        {"mesh", "bunny",
         "meshes: NAME[:POLYGONS[:SCALE]] or FILE[:SCALE], a list or separated by commas; object i "
         "has mesh i mod their number"},
        {"polygons", "500", "triangles of each mesh given by name; of a file's, what it has"}};
    const AddingParameter add{all};
    Scenes::for_each([&]<class S>(std::type_identity<S>) { S{}.visit_options(add); });
    add.add("asked_pairs", "",
            "file of the pairs asked about: `.npy`, uint32 or int64, shape (k, 2)");
    add.add("without_pairs", "", "file of pairs left out, as `asked_pairs`");
    add.add("groups", "",
            "file of the group of each body: `.npy`, shape (objects,); pairs within one are left "
            "out");
    visit_parameters(Variant{}, [&](std::string_view name, const auto& value, std::string_view what,
                                    SetBy) { add(name, value, what); });
    add.add("configuration", "",
            "sets volume, strategy, fan_out, frame, kernel, build, leaf_size and fit, which it "
            "excludes; see `bvlab list`");
    add.add("peer", "", "another library in place of ours, or none; see `bvlab list peers`");
    return all;
  }();
  return all;
}

const Settings& default_parameters() {
  static const Settings defaults = [] {
    Settings settings;
    for (const auto& each : parameters()) settings.emplace_back(each.name, each.fallback);
    return settings;
  }();
  return defaults;
}

void name_file(const std::string& file, const std::function<void()>& check) {
  try {
    check();
  } catch (const Unusable& fault) {
    const std::string what = fault.what();
    if (what.starts_with(file)) throw;
    throw Unusable(file, what);
  }
}

void check_text(const std::string& text, const std::string& name) {
  check_depth(text, name);
  check_characters(text, name);
}

Definition parse_definition(const std::string& text, const std::string& name) {
  return Reader(name).read(text);
}

Definition read_definition(const std::string& path) {
  return parse_definition(read_whole(path), path);
}

std::vector<Cell> cells_of(const Definition& definition) {
  std::vector<Cell> cells(1);
  cells[0].parameters = default_parameters();
  for (auto& [name, value] : cells[0].parameters) value = unsaid;
  set(cells[0].parameters, definition.parameters);
  for (const auto& axis : definition.axes) {
    std::vector<Cell> next;
    for (const auto& cell : cells)
      for (const auto& value : axis.values) {
        next.push_back(cell);
        set(next.back().parameters, value.settings);
        if (!axis.is_parameter) next.back().labels.emplace_back(axis.name, value.label);
      }
    cells = std::move(next);
  }
  for (Cell& cell : cells) set_unsaid(cell);
  for (const auto& [name, usual] : default_parameters()) {
    if (!is_column_where_set(name)) continue;
    const auto is_usual = [&](const Cell& cell) { return cell[name] == usual; };
    if (!std::all_of(cells.begin(), cells.end(), is_usual)) continue;
    for (Cell& cell : cells)
      std::erase_if(cell.parameters, [&](const auto& each) { return each.first == name; });
  }
  return cells;
}

}  // namespace bvlab
