// SPDX-License-Identifier: BSD-3-Clause
/// A check of the command line: a number, and nothing else. (Left to itself the parser takes "" for
/// 0.)
#pragma once

#include <CLI/CLI.hpp>
#include <charconv>
#include <string>

namespace bvlab {

inline CLI::Validator number() {
  const auto fault = [](const std::string& text) -> std::string {
    double value = 0;
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, value);
    if (error == std::errc{} && end == last) return {};
    return "'" + text + "' is not a number";
  };
  return CLI::Validator(fault, "");
}

}  // namespace bvlab
