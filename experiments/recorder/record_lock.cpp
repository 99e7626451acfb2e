// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recorder/record_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "experiments/files/unusable.hpp"

namespace bvlab {
namespace {

/// Calls visit(entry) for the entries of a folder until it returns true, as far as they can be
/// read: in /proc they come and go.
template <class Visit>
void for_each_entry(const std::filesystem::path& folder, Visit&& visit) {
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (visit(entry->path())) return;
}

/// Who else has the folder open, as " by process 12 (bvlab run mine.toml)"; "" where nobody can be
/// seen.
std::string holder_of(const std::filesystem::path& record) {
  std::error_code error;
  const auto folder = std::filesystem::canonical(record, error);
  std::string holder;
  for_each_entry("/proc", [&](const std::filesystem::path& process) {
    const std::string pid = process.filename();
    if (pid.find_first_not_of("0123456789") != pid.npos || pid == std::to_string(getpid()))
      return false;
    for_each_entry(process / "fd", [&](const std::filesystem::path& file) {
      if (std::filesystem::read_symlink(file, error) != folder) return false;
      std::ifstream command(process / "cmdline", std::ios::binary);
      std::string words{std::istreambuf_iterator<char>(command), {}};
      std::replace(words.begin(), words.end(), '\0', ' ');
      holder = " by process " + pid + " (" +
               one_line(words.substr(0, words.find_last_not_of(' ') + 1)) + ")";
      return true;
    });
    return !holder.empty();
  });
  return holder;
}

RecordLock::Identity identity_of(int folder) {
  struct stat status {};
  fstat(folder, &status);
  return {status.st_dev, status.st_ino};
}
bool is_still(const std::filesystem::path& folder, const RecordLock::Identity& identity) {
  struct stat status;
  return stat(folder.c_str(), &status) == 0 &&
         RecordLock::Identity(status.st_dev, status.st_ino) == identity;
}

/// The folders that runs of this program hold.
struct Held {
  std::mutex mutex;
  std::set<RecordLock::Identity> folders;
};
Held& held_here() {
  static Held held;
  return held;
}

/// Returns whether it was not there.
bool make_folder(const std::filesystem::path& record) {
  std::error_code error;
  const bool made = std::filesystem::create_directories(record, error);
  if (error) throw Unusable(record.string(), "cannot be made: " + error.message());
  return made;
}

}  // namespace

RecordLock::RecordLock(const std::filesystem::path& record, const std::function<void()>& waiting) {
  // A run that is refused removes the folder that it made, perhaps while another one waits for it.
  try {
    do {
      release();
      made_ = make_folder(record);
      folder_ = open(record.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
      if (folder_ < 0 && errno == ENOENT) continue;
      if (folder_ < 0) throw Unusable(record.string(), std::strerror(errno));
      hold(record, waiting);
    } while (folder_ < 0 || !is_still(record, *identity_));
  } catch (...) {
    release();
    throw;
  }
}

void RecordLock::hold(const std::filesystem::path& record, const std::function<void()>& waiting) {
  const Identity identity = identity_of(folder_);
  {
    const std::lock_guard lock(held_here().mutex);
    if (!held_here().folders.insert(identity).second)
      throw Unusable(record.string(), "another run of this program is at work on it");
    identity_ = identity;
  }
  for (bool said = false;
       flock(folder_, LOCK_EX | LOCK_NB) != 0 && (errno == EWOULDBLOCK || errno == EINTR);
       said = true) {
    if (!said)
      std::fprintf(stderr, "%s: waiting for another run to end%s\n",
                   one_line(record.string()).c_str(), holder_of(record).c_str());
    if (waiting) waiting();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

void RecordLock::release() {
  const std::lock_guard lock(held_here().mutex);
  if (folder_ >= 0) {
    if (identity_) flock(folder_, LOCK_UN);  // a child process may have the descriptor, too
    close(folder_);
  }
  if (identity_) held_here().folders.erase(*identity_);
  folder_ = -1, identity_.reset();
}

}  // namespace bvlab
