// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/files/whole_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

namespace bvlab {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, int error) {
  throw std::runtime_error(path.string() + ": cannot be written: " + std::strerror(error));
}

bool write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(file, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

void write_whole(const std::filesystem::path& path, std::span<const std::string_view> parts) {
  struct stat status;
  const bool exists = ::stat(path.c_str(), &status) == 0;
  // A device or a pipe (/dev/stdout, say) has no "beside": it is written straight through.
  if (exists && !S_ISREG(status.st_mode)) {
    const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (file < 0) fail(path, errno);
    for (const auto part : parts)
      if (!write_all(file, part)) {
        const int error = errno;
        ::close(file);
        fail(path, error);
      }
    if (::close(file) != 0) fail(path, errno);
    return;
  }
  std::string beside = path.string() + ".partial-XXXXXX";
  const int file = ::mkostemp(beside.data(), O_CLOEXEC);
  if (file < 0) fail(path, errno);
  const auto give_up = [&](int error) {
    ::unlink(beside.c_str());
    fail(path, error);
  };
  for (const auto part : parts)
    if (!write_all(file, part)) {
      const int error = errno;
      ::close(file);
      give_up(error);
    }
  const mode_t mask = ::umask(0);
  ::umask(mask);
  const mode_t mode = exists ? (status.st_mode & 07777) : (0666 & ~mask);
  if (::fchmod(file, mode) != 0 || ::fsync(file) != 0) {
    const int error = errno;
    ::close(file);
    give_up(error);
  }
  if (::close(file) != 0) give_up(errno);
  if (::rename(beside.c_str(), path.c_str()) != 0) give_up(errno);
}

}  // namespace bvlab
