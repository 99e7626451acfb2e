// SPDX-License-Identifier: BSD-3-Clause
/// A text file of words and numbers, read line by line; it knows where it is, so that a fault can
/// be named.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "experiments/files/unusable.hpp"

namespace bvlab {

class TextScanner {
 public:
  TextScanner(std::string_view text, std::string name) : rest_(text), name_(std::move(name)) {}

  /// Goes to the next line that has a word on it. False at the end.
  bool next_line() {
    while (!rest_.empty()) {
      const std::size_t end = std::min(rest_.find('\n'), rest_.size());
      line_ = rest_.substr(0, end);
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
      ++number_;
      if (const std::size_t comment = line_.find('#'); comment != std::string_view::npos)
        line_ = line_.substr(0, comment);
      skip_blanks();
      if (!line_.empty()) return true;
    }
    line_ = {};
    return false;
  }

  /// The next word of the line; empty at its end.
  std::string_view word() {
    skip_blanks();
    std::size_t end = 0;
    while (end < line_.size() && !blank(line_[end])) ++end;
    const std::string_view found = line_.substr(0, end);
    line_.remove_prefix(end);
    return found;
  }
  /// What is left of the line.
  std::string_view line() const { return line_; }

  bool at_line_end() {
    skip_blanks();
    return line_.empty();
  }
  std::size_t bytes_left() const { return line_.size() + rest_.size(); }

  double coordinate() {
    const std::string_view text = word();
    if (text.empty()) fault("a coordinate is missing");
    double value = 0;
    if (!parse(text, value)) fault(shown(text) + " is not a number");
    if (!std::isfinite(value)) fault("coordinate " + shown(text) + " is not finite");
    if (vanishes(text, value)) fault("coordinate " + shown(text) + " is too small for float64");
    return value;
  }

  std::int64_t integer(const char* what) {
    const std::string_view text = word();
    if (text.empty()) fault(std::string(what) + " is missing");
    return integer(text, what);
  }
  std::int64_t integer(std::string_view text, const char* what) const {
    std::string_view digits = text;
    if (digits.starts_with('+')) digits.remove_prefix(1);
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size())
      fault(shown(text) + " is not " + what);
    return value;
  }

  /// The whole of `text` as a number, rounded to the nearest float64.
  static bool parse(std::string_view text, double& value) {
    if (text.starts_with('+')) text.remove_prefix(1);
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, value);
    if (rest != end || text.empty()) return false;
    // Too large or too small: the C library tells which.
    if (error == std::errc::result_out_of_range)
      value = std::strtod(std::string(text).c_str(), nullptr);
    return error == std::errc{} || error == std::errc::result_out_of_range;
  }

  /// Whether a number that is not 0 has become 0.
  static bool vanishes(std::string_view text, double value) {
    const std::string_view digits = text.substr(0, text.find_first_of("eE"));
    return value == 0 && digits.find_first_of("123456789") != std::string_view::npos;
  }

  std::size_t line_number() const { return number_; }
  [[noreturn]] void fault(const std::string& what) const { fault(what, number_); }
  [[noreturn]] void fault(const std::string& what, std::size_t line) const {
    throw Unusable(name_, "line " + std::to_string(line) + ": " + what);
  }

  /// As much of a word as a message can bear, in quotes.
  static std::string shown(std::string_view text) {
    std::string clean(1, '\'');
    for (const char c : text.substr(0, 40)) clean += c >= ' ' && c < 127 ? c : '?';
    if (text.size() > 40) clean += "...";
    return clean += '\'';
  }

 private:
  static bool blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }
  void skip_blanks() {
    while (!line_.empty() && blank(line_.front())) line_.remove_prefix(1);
  }

  std::string_view rest_, line_;
  std::string name_;
  std::size_t number_ = 0;
};

}  // namespace bvlab
