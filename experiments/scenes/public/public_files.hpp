// SPDX-License-Identifier: BSD-3-Clause
/// Files that others published: those of one repository at one commit, each known by its SHA-256.
/// They are taken from a clone that one has, or by git, and kept under build/public, where they are
/// looked for when nothing is named. Nothing of them is part of this project.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>

namespace bvlab {

struct PublicSource {
  std::string_view repository;  ///< "owner/name" on GitHub
  std::string_view commit;
};

struct PublicFile {
  std::string_view path, sha256;
};

class PublicFiles {
 public:
  /// Reads all of them, or throws Unusable with one line: what is missing, where it was looked for,
  /// or which file is not the one of that commit. `from` is a clone (with or without a work tree),
  /// a folder that holds the files under their paths, or "git": then git fetches the commit. Where
  /// it is empty, the files that were kept.
  PublicFiles(const std::string& scene, const PublicSource& source,
              std::span<const PublicFile> files, const std::string& from);

  /// For tests: these bytes, unchecked.
  explicit PublicFiles(std::map<std::string, std::string> bytes) : bytes_(std::move(bytes)) {}

  /// Of a file that was named; `name` of it for messages is its path.
  const std::string& operator[](const std::string& path) const { return bytes_.at(path); }

 private:
  std::map<std::string, std::string> bytes_;
};

/// build/public of the source tree.
std::filesystem::path public_directory();

}  // namespace bvlab
