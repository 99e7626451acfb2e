// SPDX-License-Identifier: BSD-3-Clause
/// Bytes as text, for arrays inside a page (RFC 4648, with padding).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace bvlab {

inline std::string base64_of(std::span<const std::byte> bytes) {
  static constexpr char digits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t here = bytes.size() - i < 3 ? bytes.size() - i : 3;
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (k < here ? static_cast<std::uint32_t>(bytes[i + k]) : 0);
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= here ? digits[three >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace bvlab
