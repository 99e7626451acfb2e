// SPDX-License-Identifier: BSD-3-Clause
/// A file as one piece: read as a whole, and written so that it appears whole or not at all, also
/// when the program is killed.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace bvlab {

/// All bytes of a file. Throws Unusable naming the file and the system's reason. Where a signal
/// arrives while a pipe is waited for, `on_signal` is called, which may throw.
std::string read_whole(
    const std::filesystem::path& path, const std::function<void()>& on_signal = [] {});

/// Replaces `path` by `parts`, one after the other: written without a name (or, where the file
/// system knows no such files, beside its place under another name), flushed to the disk, then
/// given its name. Throws std::runtime_error naming the file and the system's reason; then `path`
/// is as it was before and nothing is left beside it.
void write_whole(const std::filesystem::path& path, std::span<const std::string_view> parts);

inline void write_whole(const std::filesystem::path& path, std::string_view text) {
  write_whole(path, std::span(&text, 1));
}

/// Adds text to the end of a file that is there, in one write. Throws std::runtime_error as above.
void append_to(const std::filesystem::path& path, std::string_view text);

/// Removes what processes that were killed while they wrote into `folder` have left there.
void clear_left_behind(const std::filesystem::path& folder);

/// Throws Unusable, naming the option and the path, if nothing can be written at `path`: its folder
/// is missing or read-only, or it is a folder itself. Asked before the work is done, not after.
/// An empty path asks for nothing.
void require_place(const std::string& option, const std::filesystem::path& path);

/// What is read or written, and the option that says so. An empty path means none.
struct NamedFile {
  std::string option;
  std::filesystem::path path;
};

/// The same of every result; further throws Unusable where one would replace another one, or what
/// is read.
void require_places(std::span<const NamedFile> read, std::span<const NamedFile> written);

/// Where totals are written, for `require_places`.
inline NamedFile place_of_totals(const std::string& json) {
  return json.empty() ? NamedFile{"the totals", "/dev/stdout"} : NamedFile{"--json", json};
}

}  // namespace bvlab
