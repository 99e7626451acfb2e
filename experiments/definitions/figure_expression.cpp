// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/definitions/figure_expression.hpp"

#include <algorithm>
#include <regex>

namespace bvlab {
namespace {

/// What a token of an expression is: the group of the expression below that matches it.
enum Token { name = 1, constant, joining, arithmetic, negation, opening, closing };
const std::regex& tokens() {
  static const std::regex all(
      R"(\s*(?:(\b(?!(?:and|or|not|in|True|False)\b)[A-Za-z_]\w*))"
      R"(|("[^"]*"|'[^']*'|(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?))"
      R"(|(and\b|or\b)|(\*\*|[-+*/]|[<>=!]=|[<>])|(not\b)|(\()|(\))))");
  return all;
}

}  // namespace

std::vector<std::string> names_in(const std::string& text) {
  std::vector<std::string> names;
  for (std::sregex_iterator match(text.begin(), text.end(), tokens()), end; match != end; ++match)
    if ((*match)[name].matched) names.push_back((*match)[name]);
  return names;
}

std::string fault_in(const std::string& text) {
  const std::size_t length = text.find_last_not_of(" \t\n") + 1;
  if (length == 0) return "an expression is missing";
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(length);
  bool wants_value = true, may_negate = true;
  int open = 0;
  for (auto at = text.begin(); at != end;) {
    std::smatch match;
    if (!std::regex_search(at, end, match, tokens(), std::regex_constants::match_continuous))
      return "'" + std::string(std::find_if(at, end, [](char c) { return c > ' '; }), end) +
             "' is not understood";
    const auto found = std::find_if(match.begin() + 1, match.end(),
                                    [](const std::ssub_match& group) { return group.matched; });
    const auto token = static_cast<Token>(found - match.begin());
    const bool is_minus = *found == "-";
    const bool follows_value =
        token == joining || token == closing || (token == arithmetic && !(is_minus && wants_value));
    if (wants_value == follows_value || (token == negation && !may_negate))
      return "'" + found->str() + "' is not expected";
    open += (token == opening) - (token == closing);
    if (open < 0) return "')' closes nothing";
    wants_value = token != name && token != constant && token != closing;
    may_negate = token == joining || token == negation || token == opening;
    at = match[0].second;
  }
  if (wants_value) return "it ends where a value is needed";
  return open > 0 ? "'(' is not closed" : "";
}

}  // namespace bvlab
