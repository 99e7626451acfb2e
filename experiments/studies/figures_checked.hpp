// SPDX-License-Identifier: BSD-3-Clause
/// Whether the figures of a definition can be drawn of the record that it will make. What a figure
/// is plots/draw alone knows: it is asked before hours of measuring.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace bvlab {

/// Writes into a folder what is known of a record's tables before anything is run.
using WritesTables = std::function<void(const std::filesystem::path& folder)>;

/// Throws Unusable naming the file and the line where `plots/draw --check` refuses a figure of the
/// definition `text`. Without tables only the keys of figures are checked. Where plots/draw does
/// not run, as without Python, a line on standard error says so.
void check_figures(const std::string& text, const std::string& file,
                   const WritesTables& write_tables = {});

}  // namespace bvlab
