// SPDX-License-Identifier: BSD-3-Clause
/// A check of the command line: a whole number of a range, in decimal digits. (Left to itself the
/// parser takes "-1" for the largest number that an unsigned option holds.)
#pragma once

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <limits>
#include <string>

namespace bvlab {

inline CLI::Validator whole_number(std::uint64_t least = 0,
                                   std::uint64_t most = std::numeric_limits<std::uint64_t>::max()) {
  const std::string range = std::to_string(least) + " to " + std::to_string(most);
  const auto fault = [least, most, range](const std::string& text) -> std::string {
    std::uint64_t value = 0;
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, value);
    if (error == std::errc{} && end == last && value >= least && value <= most) return {};
    return "'" + text + "' is not a whole number from " + range;
  };
  return CLI::Validator(fault, most == std::numeric_limits<std::uint64_t>::max() ? "" : range);
}

}  // namespace bvlab
