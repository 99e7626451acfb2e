// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/public/public_files.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "experiments/files/spawned.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/files/whole_file.hpp"
#include "experiments/scenes/public/sha256.hpp"

namespace bvlab {
namespace {

/// What a program writes to its standard output; nothing where it fails.
std::optional<std::string> output_of(std::vector<std::string> words) {
  Spawned run = spawned(std::move(words), Stream::output);
  if (run.status != 0) return std::nullopt;
  return std::move(run.text);
}

class Reader {
 public:
  Reader(std::string scene, const PublicSource& source, std::string from)
      : scene_(std::move(scene)), source_(source), from_(std::move(from)) {
    std::string folder(source.repository);
    std::replace(folder.begin(), folder.end(), '/', '+');
    kept_ = public_directory() / folder;
    if (from_ == "git") from_ = cloned().string();
  }

  std::string read(const PublicFile& file) const {
    const auto kept = kept_ / file.path;
    if (from_.empty()) {
      if (!std::filesystem::is_regular_file(kept)) throw absent(file);
      return checked(read_whole(kept), file, kept.string());
    }
    const auto plain = std::filesystem::path(from_) / file.path;
    std::optional<std::string> bytes;
    if (std::filesystem::is_regular_file(plain)) bytes = read_whole(plain);
    // A work tree may be at another commit.
    if (!bytes || sha256(*bytes) != file.sha256)
      if (auto of_commit = blob(from_, file)) bytes = std::move(of_commit);
    if (!bytes) throw absent(file);
    std::string right = checked(std::move(*bytes), file, plain.string());
    std::filesystem::create_directories(kept.parent_path());
    write_whole(kept, right);
    return right;
  }

 private:
  std::string text_of_source() const {
    return "github.com/" + std::string(source_.repository) + " at " +
           std::string(source_.commit.substr(0, 12));
  }
  Unusable absent(const PublicFile& file) const {
    const std::string what = "has no " + std::string(file.path) + " of " + text_of_source();
    return from_.empty()
               ? Unusable(scene_, "needs " + std::string(file.path) + " of " + text_of_source() +
                                      ": name a clone, or git: bvlab scene " + scene_ +
                                      " --from CLONE|git --out FILE")
               : Unusable(from_, what);
  }
  static std::string checked(std::string bytes, const PublicFile& file, const std::string& place) {
    if (sha256(bytes) != file.sha256)
      throw Unusable(place, "is not the expected file: its SHA-256 is another");
    return bytes;
  }
  std::optional<std::string> blob(const std::string& clone, const PublicFile& file) const {
    return output_of({"git", "-C", clone, "cat-file", "blob",
                      std::string(source_.commit) + ":" + std::string(file.path)});
  }
  /// Without its files: git fetches each when it is read.
  std::filesystem::path cloned() const {
    const auto clone = kept_.string() + ".git";
    const std::string url = "https://github.com/" + std::string(source_.repository) + ".git";
    if (!std::filesystem::exists(clone) &&
        !output_of({"git", "clone", "--quiet", "--bare", "--filter=blob:none", url, clone}))
      throw Unusable(scene_, "git does not clone " + url);
    return clone;
  }

  std::string scene_;
  const PublicSource& source_;
  std::string from_;
  std::filesystem::path kept_;
};

}  // namespace

std::filesystem::path public_directory() { return BVLAB_PUBLIC_DIRECTORY; }

PublicFiles::PublicFiles(const std::string& scene, const PublicSource& source,
                         std::span<const PublicFile> files, const std::string& from) {
  const Reader reader(scene, source, from);
  for (const auto& file : files) bytes_[std::string(file.path)] = reader.read(file);
}

}  // namespace bvlab
