// SPDX-License-Identifier: BSD-3-Clause
/// Files within a ZIP file.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace bvlab {

/// The file of that name in the archive, letters of either case; nothing where there is none.
/// Throws Unusable, naming the archive, where that is damaged, or the file's bytes are not those
/// that were packed.
std::optional<std::string> unzipped(std::string_view archive, std::string_view file,
                                    const std::string& name);

}  // namespace bvlab
