// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/length.hpp"

#include <charconv>
#include <cmath>

#include "experiments/files/unusable.hpp"

namespace bvlab {

Length length_from(std::string_view text) {
  Length length;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, length.value);
  std::string_view unit(rest, static_cast<std::size_t>(end - rest));
  while (unit.starts_with(' ')) unit.remove_prefix(1);
  if (unit == "leaf")
    length.unit = Length::Unit::leaf;
  else if (unit == "body")
    length.unit = Length::Unit::body;
  if (error != std::errc{} || !std::isfinite(length.value) || length.value < 0 ||
      (length.unit == Length::Unit::mesh && !unit.empty()))
    throw Unusable("'" + std::string(text) +
                   "' is not a length: a number that is not negative, then nothing, 'leaf' or "
                   "'body'");
  return length;
}

std::string text_of(const Length& length) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, length.value).ptr;
  std::string text(digits, end);
  if (length.unit == Length::Unit::leaf) text += "leaf";
  if (length.unit == Length::Unit::body) text += "body";
  return text;
}

}  // namespace bvlab
