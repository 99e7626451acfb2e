// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/text_encoding.hpp"

#include <cstdint>

#include "experiments/files/unusable.hpp"

namespace bvlab {
namespace {

using namespace std::string_view_literals;

/// Where the more significant byte of each pair stands.
enum class HighByte : std::size_t { first = 0, second = 1 };

std::string from_utf16(std::string_view bytes, HighByte high, const std::string& name) {
  if (bytes.size() % 2 != 0) throw Unusable(name, "truncated: ends within a character of UTF-16");
  const auto unit = [&](std::size_t at) {
    const auto h = static_cast<std::size_t>(high);
    return std::uint32_t{static_cast<unsigned char>(bytes[at + h])} << 8 |
           std::uint32_t{static_cast<unsigned char>(bytes[at + 1 - h])};
  };
  std::string text;
  text.reserve(bytes.size() / 2);
  for (std::size_t at = 0; at < bytes.size(); at += 2) {
    std::uint32_t code = unit(at);
    const bool is_pair =
        (code & 0xfc00) == 0xd800 && at + 2 < bytes.size() && (unit(at + 2) & 0xfc00) == 0xdc00;
    if (is_pair) code = 0x10000 + ((code & 0x3ff) << 10) + (unit(at += 2) & 0x3ff);
    append_utf8(text, code);
  }
  return text;
}

}  // namespace

void append_utf8(std::string& text, std::uint32_t code) {
  const auto put = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
  if (code < 0x80) return put(code);
  if (code < 0x800) {
    put(0xc0 | code >> 6);
  } else {
    if (code < 0x10000) {
      put(0xe0 | code >> 12);
    } else {
      put(0xf0 | code >> 18);
      put(0x80 | (code >> 12 & 0x3f));
    }
    put(0x80 | (code >> 6 & 0x3f));
  }
  put(0x80 | (code & 0x3f));
}

std::string_view as_utf8(std::string_view bytes, std::string& room, const std::string& name) {
  if (bytes.starts_with("\xef\xbb\xbf")) return bytes.substr(3);
  if (bytes.starts_with("\xff\xfe\0\0"sv) || bytes.starts_with("\0\0\xfe\xff"sv))
    throw Unusable(name, "is UTF-32 text: only UTF-8 and UTF-16 are read");
  const auto converted = [&](std::size_t mark, HighByte high) {
    return std::string_view(room = from_utf16(bytes.substr(mark), high, name));
  };
  if (bytes.starts_with("\xff\xfe")) return converted(2, HighByte::second);
  if (bytes.starts_with("\xfe\xff")) return converted(2, HighByte::first);
  // Without a mark: every other byte of what all formats begin with is 0.
  const auto are = [&](std::size_t first) {
    for (std::size_t at = 0; at < 4; at += 2)
      if (bytes[at + first] == '\0' || bytes[at + 1 - first] != '\0') return false;
    return true;
  };
  if (bytes.size() >= 4 && are(0)) return converted(0, HighByte::second);
  if (bytes.size() >= 4 && are(1)) return converted(0, HighByte::first);
  return bytes;
}

bool has_mark(std::string_view bytes) {
  return bytes.starts_with("\xef\xbb\xbf") || bytes.starts_with("\xff\xfe") ||
         bytes.starts_with("\xfe\xff");
}

}  // namespace bvlab
