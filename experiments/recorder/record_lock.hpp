// SPDX-License-Identifier: BSD-3-Clause
/// Keeps runs at work on one record apart.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <utility>

namespace bvlab {

/// Two runs at work on one record would undo each other's rows. A record is held by one run at a
/// time, as long as its RecordLock exists. Where the file system has no locks, only runs of one
/// process are kept apart.
class RecordLock {
 public:
  using Identity = std::pair<dev_t, ino_t>;

  /// Makes the folder if it is not there. Waits while another process has it open, says which, and
  /// calls `waiting` every so often, which may throw. Throws Unusable if another run of this
  /// program has it open.
  explicit RecordLock(const std::filesystem::path& record, const std::function<void()>& waiting);
  RecordLock(RecordLock&& other) noexcept
      : identity_(std::exchange(other.identity_, {})),
        folder_(std::exchange(other.folder_, -1)),
        made_(other.made_) {}
  RecordLock& operator=(RecordLock&&) = delete;
  ~RecordLock() { release(); }

  /// Whether the folder was not there.
  bool made() const { return made_; }

 private:
  void hold(const std::filesystem::path& record, const std::function<void()>& waiting);
  void release();

  std::optional<Identity> identity_;
  int folder_ = -1;
  bool made_ = false;
};

}  // namespace bvlab
