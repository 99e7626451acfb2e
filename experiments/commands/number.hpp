// SPDX-License-Identifier: BSD-3-Clause
/// Checks of the command line: a number, and nothing else; a whole number of a range. (Left to
/// itself the parser takes "" for 0, and "-1" for the largest number that an unsigned option
/// holds.)
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <limits>
#include <string>

#include "experiments/files/numbers.hpp"

namespace bvlab {

inline CLI::Validator number() {
  const auto fault = [](const std::string& text) {
    return number_in<double>(text) ? std::string() : "'" + text + "' is not a number";
  };
  return CLI::Validator(fault, "");
}

inline CLI::Validator whole_number(std::uint64_t least = 0,
                                   std::uint64_t most = std::numeric_limits<std::uint64_t>::max()) {
  const std::string range = std::to_string(least) + " to " + std::to_string(most);
  const auto fault = [least, most, range](const std::string& text) -> std::string {
    const auto value = number_in<std::uint64_t>(text);
    if (value && *value >= least && *value <= most) return {};
    return "'" + text + "' is not a whole number from " + range;
  };
  return CLI::Validator(fault, most == std::numeric_limits<std::uint64_t>::max() ? "" : range);
}

}  // namespace bvlab
