// SPDX-License-Identifier: BSD-3-Clause
/// Names of files are bytes; what is written about them in JSON and XML is UTF-8.
#pragma once

#include <string>
#include <string_view>

namespace bvlab {

/// The text with U+FFFD in place of every byte that is no part of UTF-8.
std::string as_utf8(std::string_view text);

}  // namespace bvlab
