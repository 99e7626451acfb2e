// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/definitions/figure_tables.hpp"

#include <algorithm>
#include <set>
#include <string_view>
#include <vector>

#include "experiments/files/unusable.hpp"

namespace bvlab {
namespace {

/// A key of a figure, and its values where there are only these.
struct Key {
  std::string_view name;
  std::vector<std::string_view> values = {};
};

const std::vector<Key>& keys() {
  static const std::vector<Key> all{{"name"},
                                    {"x"},
                                    {"kind", {"line", "bars", "map"}},
                                    {"y"},
                                    {"value"},
                                    {"over"},
                                    {"series"},
                                    {"panels"},
                                    {"where"},
                                    {"log", {"none", "x", "y", "xy"}},
                                    {"peers", {"all"}},
                                    {"x_label"},
                                    {"y_label"},
                                    {"value_label"}};
  return all;
}

class FigureCheck {
 public:
  explicit FigureCheck(const std::string& file) : file_(file) {}

  /// The figure's name.
  std::string operator()(const toml::table& figure) const {
    for (auto&& [name, value] : figure) check(std::string(name.str()), name.source(), value);
    for (const char* needed : {"name", "x"})
      if (text(figure, needed).empty())
        fail(figure.source(),
             std::string("a figure needs ") + (*needed == 'x' ? "an x" : "a name"));
    const std::string name = text(figure, "name");
    if (name.find('/') != std::string::npos)
      fail(figure.get("name")->source(), "a figure's name must be without '/'");
    if (text(figure, "kind") == "map" && text(figure, "y").empty())
      fail(figure.source(), "figure '" + name + "': a map needs a y");
    return name;
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
      fail(where, "unknown key '" + name + "' of a figure; there are " + names);
    }
    if (name == "where") return check_conditions(value);
    const auto given = value.value_exact<std::string>();
    if (!given) fail(value.source(), name + " of a figure must be a string");
    const auto& allowed = key->values;
    if (allowed.empty() || std::count(allowed.begin(), allowed.end(), *given)) return;
    std::string names;
    for (const auto each : allowed) names += (names.empty() ? "" : ", ") + std::string(each);
    fail(value.source(), "unknown " + name + " '" + *given + "' of a figure; there are " + names);
  }

  void check_conditions(const toml::node& value) const {
    const auto* list = value.as_array();
    if (!list || std::any_of(list->begin(), list->end(),
                             [](const toml::node& each) { return !each.is_string(); }))
      fail(value.source(), "where of a figure must be a list of strings");
  }

  const std::string& file_;
};

}  // namespace

void check_figures(const toml::node& figures, const std::string& file) {
  const FigureCheck check(file);
  const auto* list = figures.as_array();
  if (!list) check.fail(figures.source(), "figures are written as [[figure]]");
  std::set<std::string> names;
  for (auto&& each : *list) {
    const auto* figure = each.as_table();
    if (!figure) check.fail(each.source(), "figures are written as [[figure]]");
    if (const auto [name, added] = names.insert(check(*figure)); !added)
      check.fail(figure->source(), "a second figure '" + *name + "'");
  }
}

}  // namespace bvlab
