// SPDX-License-Identifier: BSD-3-Clause
/// Numbers as text, and back.
#pragma once

#include <charconv>
#include <concepts>
#include <optional>
#include <string>
#include <string_view>

namespace bvlab {

/// Digits enough to read the same number again, and no more.
inline std::string text_of(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}
template <std::integral T>
std::string text_of(T value) {
  return std::to_string(value);
}
/// Fields of a table may be texts, too.
inline std::string text_of(std::string_view text) { return std::string(text); }

/// The number that the whole text is; nothing where it is none, or none that T holds.
template <class T>
std::optional<T> number_in(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

}  // namespace bvlab
