// SPDX-License-Identifier: BSD-3-Clause
/// Strategies as they are written in commands and definitions: a name, or name:parameter.
#pragma once

#include <charconv>
#include <string>
#include <string_view>
#include <type_traits>

#include "experiments/files/unusable.hpp"

namespace bvlab {

/// The parameter of "name:parameter"; nothing where there is none.
inline std::string_view parameter_of(std::string_view text) {
  const auto colon = text.find(':');
  return colon == text.npos ? std::string_view{} : text.substr(colon + 1);
}
inline std::string_view name_of(std::string_view text) { return text.substr(0, text.find(':')); }

/// A strategy as its text asks for it: "deferred:3" is Deferred(3).
template <class Strategy>
Strategy made_from(std::string_view text) {
  const std::string_view parameter = parameter_of(text);
  if (name_of(text).size() == text.size()) return Strategy{};
  if constexpr (std::is_constructible_v<Strategy, unsigned>) {
    unsigned value = 0;
    const auto [end, error] =
        std::from_chars(parameter.data(), parameter.data() + parameter.size(), value);
    if (error == std::errc{} && end == parameter.data() + parameter.size()) return Strategy(value);
    throw Unusable("--strategy " + std::string(text) + ": '" + std::string(parameter) +
                   "' is not a whole number");
  } else {
    throw Unusable("--strategy " + std::string(text) + ": " + std::string(Strategy::name) +
                   " takes no parameter");
  }
}

}  // namespace bvlab
