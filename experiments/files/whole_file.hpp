// SPDX-License-Identifier: BSD-3-Clause
/// A file that appears whole or not at all: written beside its place under another name, flushed
/// to the disk, then renamed.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

namespace bvlab {

/// Replaces `path` by `parts`, one after the other. Throws std::runtime_error naming the file and
/// the system's reason; then `path` is as it was before and nothing is left beside it.
void write_whole(const std::filesystem::path& path, std::span<const std::string_view> parts);

inline void write_whole(const std::filesystem::path& path, std::string_view text) {
  write_whole(path, std::span(&text, 1));
}

}  // namespace bvlab
