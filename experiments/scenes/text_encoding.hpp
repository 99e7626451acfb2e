// SPDX-License-Identifier: BSD-3-Clause
/// Text in the encodings that editors write, as UTF-8.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace bvlab {

/// The text without its byte-order mark. UTF-16 of either byte order, with a mark or without one,
/// becomes UTF-8 in `room`, which the result then refers to. Throws Unusable, naming the file, for
/// UTF-32, and for UTF-16 that ends within a character.
std::string_view as_utf8(std::string_view bytes, std::string& room, const std::string& name);

/// Appends a character by its number.
void append_utf8(std::string& text, std::uint32_t code);

/// Whether the bytes begin with a byte-order mark.
bool has_mark(std::string_view bytes);

}  // namespace bvlab
