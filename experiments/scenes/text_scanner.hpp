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

/// What of a number's digits a file says that count.
enum class Digits { float64, float32 };

class TextScanner {
 public:
  /// '\0': there is no such character.
  struct Syntax {
    char comment = '#';        ///< from there to the end of the line, unless it follows a '.'
    char continuation = '\0';  ///< at the end of a line: the next one belongs to it
  };

  /// Text and name have to live as long as the scanner and its copies, which are cheap.
  TextScanner(std::string_view text, std::string_view name) : TextScanner(text, name, {}) {}
  TextScanner(std::string_view text, std::string_view name, Syntax syntax)
      : rest_(text), name_(name), syntax_(syntax) {
    // What DOS wrote at the end of a text, and blocks that are filled up.
    while (!rest_.empty() && (rest_.back() == '\x1a' || rest_.back() == '\0'))
      rest_.remove_suffix(1);
  }

  /// Goes to the next line that has a word on it; lines end with LF, CR LF or CR. False at the end.
  bool next_line() {
    while (!rest_.empty()) {
      number_ += std::exchange(lines_, 0);
      const std::string_view all = rest_;
      line_ = all.substr(0, taken_line());
      skip_blanks();
      // Where files were joined, a byte-order mark stands within.
      if (line_.starts_with("\xef\xbb\xbf")) line_.remove_prefix(3);
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
  /// Passes over so many characters of the line.
  void skip(std::size_t length) { line_.remove_prefix(std::min(length, line_.size())); }
  /// What is left of the line.
  std::string_view line() const { return line_; }
  /// The same as a name, in which a '#' within a word is a letter as others.
  std::string_view name() {
    skip_blanks();
    std::string_view text(line_.data(), static_cast<std::size_t>(end_ - line_.data()));
    for (std::size_t at = 0; (at = text.find(syntax_.comment, at)) != text.npos; ++at)
      if (at == 0 || blank(text[at - 1])) text = text.substr(0, at);
    while (!text.empty() && blank(text.back())) text.remove_suffix(1);
    return text;
  }

  bool at_line_end() {
    skip_blanks();
    return line_.empty();
  }
  std::size_t bytes_left() const { return line_.size() + rest_.size(); }
  /// What follows the line.
  std::string_view rest() const { return rest_; }
  /// How many lines with a word on them follow this one.
  std::size_t lines_left() const {
    std::size_t lines = 0;
    for (TextScanner ahead = *this; ahead.next_line();) ++lines;
    return lines;
  }

  double coordinate(Digits digits = Digits::float64) {
    const std::string_view text = word();
    if (text.empty()) fault("a coordinate is missing");
    double value = 0;
    const bool is_number = parse(text, value);
    const bool is_float = digits == Digits::float32;
    if (is_float) value = static_cast<double>(static_cast<float>(value));
    // As old compilers print what is not a number: 1.#IND, -1.#INF, 1.#QNAN.
    if (!std::isfinite(value) || text.find(".#") != std::string_view::npos)
      fault("coordinate " + shown(text) + " is not finite");
    if (!is_number) fault(shown(text) + " is not a number");
    if (vanishes(text, value))
      fault("coordinate " + shown(text) + " is too small for " +
            (is_float ? "float32" : "float64"));
    return value;
  }

  std::int64_t integer(const char* what) {
    const std::string_view text = word();
    if (text.empty()) fault(std::string(what) + " is missing");
    return integer(text, what);
  }
  std::int64_t integer(std::string_view text, const char* what) const {
    std::string_view digits = text;
    if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size())
      fault(shown(text) + " is not " + what);
    return value;
  }

  /// The whole of `text` as a number, rounded to the nearest float64.
  static bool parse(std::string_view text, double& value) {
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
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
  std::string place() const { return place(number_); }
  static std::string place(std::size_t line) { return "line " + std::to_string(line); }
  [[noreturn]] void fault(const std::string& what) const { fault(what, number_); }
  [[noreturn]] void fault(const std::string& what, std::size_t line) const {
    throw Unusable(std::string(name_), place(line) + ": " + what);
  }

  /// As much of a word as a message can bear, in quotes.
  static std::string shown(std::string_view text) {
    std::string clean(1, '\'');
    for (const char c : text.substr(0, 40)) clean += c >= ' ' && c < 127 ? c : '?';
    if (text.size() > 40) clean += "...";
    return clean += '\'';
  }

 private:
  bool blank(char c) const {
    return c == ' ' || ('\t' <= c && c <= '\r') || (c == syntax_.continuation && c != '\0');
  }
  void skip_blanks() {
    while (!line_.empty() && blank(line_.front())) line_.remove_prefix(1);
  }

  /// Takes a line and its end from the rest; returns the length without end and comment.
  std::size_t taken_line() {
    std::size_t at = 0, length = std::string_view::npos;
    for (bool goes_on = true; goes_on; ++lines_) {
      for (; at < rest_.size() && rest_[at] != '\n' && rest_[at] != '\r'; ++at)
        if (rest_[at] == syntax_.comment && syntax_.comment != '\0' &&
            length == std::string_view::npos && (at == 0 || rest_[at - 1] != '.'))
          length = at;
      // A comment is not continued: folders' names end with a backslash, too.
      goes_on = length == std::string_view::npos && at > 0 && at < rest_.size() &&
                syntax_.continuation != '\0' && rest_[at - 1] == syntax_.continuation;
      if (!goes_on) length = std::min(length, at), end_ = rest_.data() + std::min(at, rest_.size());
      at += rest_.substr(at).starts_with("\r\n") ? 2 : 1;
    }
    rest_.remove_prefix(std::min(at, rest_.size()));
    return length;
  }

  std::string_view rest_, line_, name_;
  const char* end_ = nullptr;  // of the line, comment included
  Syntax syntax_;
  std::size_t number_ = 0, lines_ = 1;  // lines_: that this one takes
};

}  // namespace bvlab
