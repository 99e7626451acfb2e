// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/definitions/figure_expression.hpp"

#include <algorithm>
#include <regex>
#include <set>

namespace bvlab {

std::vector<std::string> names_in(const std::string& text) {
  static const std::regex token(R"("[^"]*"|'[^']*'|[0-9.]+(?:[eE][-+]?[0-9]+)?|([A-Za-z_]\w*))");
  static const std::set<std::string> words{"and", "or", "not", "in", "True", "False"};
  std::vector<std::string> names;
  for (std::sregex_iterator match(text.begin(), text.end(), token), end; match != end; ++match)
    if ((*match)[1].matched && !words.contains((*match)[1])) names.push_back((*match)[1]);
  return names;
}

std::string fault_in(const std::string& text) {
  enum Group { value = 1, joining, arithmetic, negation, opening, closing };
  static const std::regex token(
      R"(\s*(?:("[^"]*"|'[^']*'|(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)"
      R"(|(?!(?:and|or|not|in|True|False)\b)[A-Za-z_]\w*))"
      R"(|(and\b|or\b)|(\*\*|[-+*/]|[<>=!]=|[<>])|(not\b)|(\()|(\))))");
  const std::size_t length = text.find_last_not_of(" \t\n") + 1;
  if (length == 0) return "an expression is missing";
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(length);
  bool wants_value = true, may_negate = true;
  int open = 0;
  for (auto at = text.begin(); at != end;) {
    std::smatch match;
    if (!std::regex_search(at, end, match, token, std::regex_constants::match_continuous))
      return "'" + std::string(std::find_if(at, end, [](char c) { return c > ' '; }), end) +
             "' is not understood";
    const auto found = std::find_if(match.begin() + 1, match.end(),
                                    [](const std::ssub_match& group) { return group.matched; });
    const auto group = static_cast<Group>(found - match.begin());
    const bool is_minus = *found == "-";
    const bool follows_value =
        group == joining || group == closing || (group == arithmetic && !(is_minus && wants_value));
    if (wants_value == follows_value || (group == negation && !may_negate))
      return "'" + found->str() + "' is not expected";
    open += (group == opening) - (group == closing);
    if (open < 0) return "')' closes nothing";
    wants_value = group != value && group != closing;
    may_negate = group == joining || group == negation || group == opening;
    at = match[0].second;
  }
  if (wants_value) return "it ends where a value is needed";
  return open > 0 ? "'(' is not closed" : "";
}

}  // namespace bvlab
