// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/definitions/figure_tables.hpp"

#include <algorithm>
#include <charconv>
#include <regex>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>

#include "experiments/definitions/figure_expression.hpp"
#include "experiments/files/unusable.hpp"

namespace bvlab {
namespace {

/// A key of a figure, and its values where there are only these.
struct Key {
  std::string_view name;
  std::vector<std::string_view> values = {};
};

const std::vector<Key>& keys() {
  static const std::vector<Key> all{
      {"name"},
      {"x"},
      {"kind", {"line", "bars", "map", "scatter", "stacked", "ecdf", "box", "table"}},
      {"y"},
      {"value"},
      {"over"},
      {"ratio", {"cost", "speedup"}},
      {"series"},
      {"panels"},
      {"panel_rows"},
      {"where"},
      {"pool"},
      {"statistic", {"median", "mean", "p99", "worst", "least"}},
      {"interval", {"quartiles", "range", "95%", "none"}},
      {"fit", {"line", "power"}},
      {"clock", {"processor", "wall"}},
      {"table", {"frames"}},
      {"log", {"none", "x", "y", "xy"}},
      {"peers", {"all"}},
      {"width", {"column", "page"}},
      {"x_label"},
      {"y_label"},
      {"value_label"}};
  return all;
}

class FigureCheck {
 public:
  explicit FigureCheck(const std::string& file) : file_(file) {}

  FigureTable operator()(const toml::table& figure) const {
    for (auto&& [name, value] : figure) check(std::string(name.str()), name.source(), value);
    for (const char* needed : {"name", "x"})
      if (text(figure, needed).empty())
        fail(figure.source(),
             std::string("a figure needs ") + (*needed == 'x' ? "an x" : "a name"));
    const std::string name = text(figure, "name");
    if (name.find('/') != std::string::npos)
      fail(figure.get("name")->source(), "a figure's name must be without '/'");
    const std::string kind = text(figure, "kind");
    if ((kind == "map" || kind == "scatter") && text(figure, "y").empty())
      fail(figure.source(), "figure '" + name + "': a " + kind + " needs a y");
    if (figure.contains("fit") && kind != "scatter")
      fail(figure.get("fit")->source(), "figure '" + name + "': a fit is drawn through a scatter");
    if (figure.contains("ratio") && !figure.contains("over"))
      fail(figure.source(), "figure '" + name + "': a ratio needs what it is over");
    FigureTable table{name, {}, {}, figure.source().begin.line};
    for (auto&& [key, value] : figure) {
      if (const auto* list = value.as_array())
        for (auto&& each : *list) table.where.push_back(each.value_or(std::string()));
      else
        table.keys[std::string(key.str())] = value.value_or(std::string());
    }
    return table;
  }

  [[noreturn]] void fail(const toml::source_region& where, const std::string& what) const {
    throw Unusable(file_, "line " + std::to_string(where.begin.line) + ": " + what);
  }

 private:
  static std::string text(const toml::table& figure, std::string_view key) {
    return figure[key].value_or(std::string());
  }

  void check(const std::string& name, const toml::source_region& where,
             const toml::node& value) const {
    const auto key = std::find_if(keys().begin(), keys().end(),
                                  [&](const Key& each) { return each.name == name; });
    if (key == keys().end()) {
      std::string names;
      for (const Key& each : keys()) names += (names.empty() ? "" : ", ") + std::string(each.name);
      fail(where, "unknown key '" + name + "' of a figure; available: " + names);
    }
    if (name == "where") return check_conditions(value);
    const auto given = value.value_exact<std::string>();
    if (!given) fail(value.source(), name + " of a figure must be a string");
    const auto& allowed = key->values;
    if (allowed.empty() || std::count(allowed.begin(), allowed.end(), *given)) return;
    std::string names;
    for (const auto each : allowed) names += (names.empty() ? "" : ", ") + std::string(each);
    fail(value.source(), "unknown " + name + " '" + *given + "' of a figure; available: " + names);
  }

  void check_conditions(const toml::node& value) const {
    const auto* list = value.as_array();
    if (!list || std::any_of(list->begin(), list->end(),
                             [](const toml::node& each) { return !each.is_string(); }))
      fail(value.source(), "where of a figure must be a list of strings");
  }

  const std::string& file_;
};

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\n");
  return first == text.npos ? "" : text.substr(first, text.find_last_not_of(" \t\n") - first + 1);
}

std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(trimmed(part));
  return parts;
}

/// "0.03" and "3e-2", and, of lengths, "0.03body".
bool same_value(const std::string& held, const std::string& asked) {
  if (held == asked) return true;
  double one = 0, other = 0;
  const auto number = [](const std::string& text, double& value) {
    return std::from_chars(text.data(), text.data() + text.size(), value);
  };
  const auto [end, error] = number(held, one);
  const auto [last, fault] = number(asked, other);
  if (error != std::errc{} || fault != std::errc{} || last != asked.data() + asked.size() ||
      one != other)
    return false;
  const std::string rest(end, held.data() + held.size());
  return rest.empty() || rest == "body" || rest == "leaf";
}

/// Of one figure: each of its columns is there, each value in a cell, each axis named or fixed.
class ColumnCheck {
 public:
  ColumnCheck(const FigureTable& figure, const DrawnColumns& columns, const std::string& file)
      : figure_(figure), columns_(columns), file_(file) {
    const auto& there = figure["table"] == "frames" ? columns.frames : columns.record;
    known_.insert(there.begin(), there.end());
    known_.insert("program");  // which experiments/builds adds
  }

  void operator()() {
    for (const char* key : {"x", "y", "value", "series", "panels", "panel_rows", "pool"})
      for (const auto& part : parts_of(figure_[key])) {
        if (known_.contains(part)) {
          named_.insert(part);
          continue;
        }
        require_names_in(part, key);
      }
    if (figure_["table"] == "frames")
      named_.insert(columns_.fixed_in_frames.begin(), columns_.fixed_in_frames.end());
    for (const auto& condition : figure_.where) check_condition(condition, "where");
    check_over(figure_["over"]);
    check_axes();
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Unusable(
        file_, "line " + std::to_string(figure_.line) + ": figure '" + figure_.name + "': " + what);
  }

  void require(const std::string& name, const std::string& key) {
    named_.insert(name);
    if (known_.contains(name)) return;
    std::string names;
    for (const auto& each : known_) names += (names.empty() ? "" : ", ") + each;
    fail(key + ": no column '" + name + "'; available: " + names);
  }

  void require_names_in(const std::string& expression, const std::string& key) {
    for (const auto& name : names_in(expression)) require(name, key);
    if (const std::string fault = fault_in(expression); !fault.empty())
      fail(key + ": " + expression + ": " + fault);
  }

  void check_over(const std::string& over) {
    static const std::set<std::string> words{"", "best", "best peer", "best of ours"};
    static const std::regex record(R"(^record\s*=[^]*$)");
    if (words.contains(over) || std::regex_match(over, record)) return;
    const auto named = named_;
    for (const auto& part : parts_of(over)) check_condition(part, "over");
    named_ = named;  // what a ratio is over does not say where the ratio stands
  }

  /// name=value, name!=value, or an expression.
  void check_condition(const std::string& text, const std::string& key) {
    static const std::regex simple(R"(^\s*(\w+)\s*(!?=)(?!=)((?:(?!==|!=|[<>])[^])*)$)");
    std::smatch match;
    if (!std::regex_match(text, match, simple)) return require_names_in(text, key);
    require(match[1], key);
    const auto values = columns_.values.find(match[1]);
    const std::string asked = trimmed(match[3]);
    // What a peer does not have is blank in its rows, whatever a cell says.
    if (values == columns_.values.end() || asked.empty()) return;
    std::string there;
    for (const auto& each : values->second) {
      if (same_value(each, asked)) return;
      there += (there.empty() ? "'" : ", '") + each + "'";
    }
    fail(key + " " + text + ": " + std::string(match[1]) + " has no '" + asked +
         "'; available: " + there);
  }

  void check_axes() const {
    static const std::set<std::string> of_variants{"volume", "strategy", "peer",  "fan_out",
                                                   "frame",  "kernel",   "build", "configuration",
                                                   "fit",    "leaf_size"};
    if (figure_["kind"] == "scatter" || is_measured(figure_["x"])) return;
    for (const auto& axis : columns_.axes) {
      const auto any = [&](const std::set<std::string>& names) {
        return std::any_of(axis.columns.begin(), axis.columns.end(),
                           [&](const std::string& column) { return names.contains(column); });
      };
      // Peers, where they are drawn alone, have none of it.
      const bool all = named_.contains("variant") || named_.contains("peer");
      if (any(named_) || (all && any(of_variants))) continue;
      fail("axis '" + axis.name + "' is neither named nor fixed: its values would be one point; " +
           "name it in x, series, panels or where, or say pool = \"" + axis.name + "\"");
    }
  }

  /// Each cell has a point of its own.
  bool is_measured(const std::string& x) const {
    const auto names = names_in(x);
    return figure_["kind"] != "ecdf" &&
           std::any_of(names.begin(), names.end(), [&](const std::string& name) {
             return !columns_.values.contains(name) && name != "variant" && name != "frame";
           });
  }

  const FigureTable& figure_;
  const DrawnColumns& columns_;
  const std::string& file_;
  std::set<std::string> known_, named_;
};

}  // namespace

const std::string& FigureTable::operator[](const std::string& key) const {
  static const std::string nothing;
  const auto found = keys.find(key);
  return found == keys.end() ? nothing : found->second;
}

std::vector<FigureTable> read_figures(const toml::node& figures, const std::string& file) {
  const FigureCheck check(file);
  const auto* list = figures.as_array();
  if (!list) check.fail(figures.source(), "figures are written as [[figure]]");
  std::vector<FigureTable> tables;
  std::set<std::string> names;
  for (auto&& each : *list) {
    const auto* figure = each.as_table();
    if (!figure) check.fail(each.source(), "figures are written as [[figure]]");
    tables.push_back(check(*figure));
    if (!names.insert(tables.back().name).second)
      check.fail(figure->source(), "a second figure '" + tables.back().name + "'");
  }
  return tables;
}

void check_figures(const std::vector<FigureTable>& figures, const DrawnColumns& columns,
                   const std::string& file) {
  for (const auto& figure : figures) ColumnCheck(figure, columns, file)();
}

}  // namespace bvlab
