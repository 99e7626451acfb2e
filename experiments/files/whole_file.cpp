// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/files/whole_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "experiments/files/unusable.hpp"

namespace bvlab {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, int error) {
  throw std::runtime_error(path.string() + ": cannot be written: " + std::strerror(error));
}

/// An open file; closed at the end unless that has been done and its outcome looked at.
class Descriptor {
 public:
  explicit Descriptor(int file) : file_(file) {}
  Descriptor(const Descriptor&) = delete;
  ~Descriptor() {
    if (file_ >= 0) ::close(file_);
  }
  explicit operator bool() const { return file_ >= 0; }
  int get() const { return file_; }
  bool close() { return ::close(std::exchange(file_, -1)) == 0; }

  bool write(std::span<const std::string_view> parts) const {
    for (std::string_view text : parts)
      while (!text.empty()) {
        const ssize_t written = ::write(file_, text.data(), text.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        text.remove_prefix(static_cast<std::size_t>(written));
      }
    return true;
  }

  /// All there, with the rights that the file is to have, and on the disk.
  bool finish(std::span<const std::string_view> parts, mode_t mode) const {
    return write(parts) && ::fchmod(file_, mode) == 0 && ::fsync(file_) == 0;
  }

 private:
  int file_;
};

/// A device or a pipe has no "beside": it is written straight through; and so is standard output,
/// of which others may have written the beginning.
void write_through(const std::filesystem::path& path, std::span<const std::string_view> parts) {
  const bool is_output = path == "/dev/stdout";
  Descriptor file(is_output ? ::dup(STDOUT_FILENO) : ::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (!file || !file.write(parts) || !file.close()) fail(path, errno);
}

constexpr std::string_view partial = ".partial-";

/// A name beside `path` that says whose it is.
std::string name_beside(const std::filesystem::path& path, std::string_view ending) {
  return path.string().append(partial) + std::to_string(::getpid()) + "." + std::string(ending);
}

/// Whether it is such a name, of a process that is no more.
bool left_behind(const std::string& name) {
  const auto at = name.rfind(partial);
  if (at == name.npos) return false;
  pid_t process = 0;
  const char* const first = name.data() + at + partial.size();
  const auto [end, error] = std::from_chars(first, name.data() + name.size(), process);
  return error == std::errc() && *end == '.' && process > 0 && ::kill(process, 0) != 0 &&
         errno == ESRCH;
}

/// Gives the nameless file its name. A name that is taken can only be replaced by renaming, so the
/// file, whole already, bears another one for that moment.
bool give_name(const Descriptor& file, const std::filesystem::path& path) {
  const std::string self = "/proc/self/fd/" + std::to_string(file.get());
  const auto link = [&](const char* name) {
    return ::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, name, AT_SYMLINK_FOLLOW) == 0;
  };
  if (link(path.c_str())) return true;
  if (errno != EEXIST) return false;
  for (int attempt = 0; attempt < 100; ++attempt) {
    const std::string beside = name_beside(path, std::to_string(attempt));
    if (!link(beside.c_str())) {
      if (errno == EEXIST) continue;
      return false;
    }
    if (::rename(beside.c_str(), path.c_str()) == 0) return true;
    const int error = errno;
    ::unlink(beside.c_str());
    errno = error;
    return false;
  }
  return false;
}

/// False, with nothing done, where the file system (or a machine without /proc) has no such files.
bool write_nameless(const std::filesystem::path& path, std::span<const std::string_view> parts,
                    mode_t mode) {
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  Descriptor file(::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600));
  struct stat ignored;
  if (!file || ::stat("/proc/self/fd", &ignored) != 0) return false;
  if (!file.finish(parts, mode) || !give_name(file, path)) fail(path, errno);
  return true;
}

void write_beside(const std::filesystem::path& path, std::span<const std::string_view> parts,
                  mode_t mode) {
  std::string beside = name_beside(path, "XXXXXX");
  Descriptor file(::mkostemp(beside.data(), O_CLOEXEC));
  if (!file) fail(path, errno);
  if (file.finish(parts, mode) && file.close() && ::rename(beside.c_str(), path.c_str()) == 0)
    return;
  const int error = errno;
  ::unlink(beside.c_str());
  fail(path, error);
}

/// Where a link leads, whether there is a file yet or not.
std::filesystem::path end_of_links(std::filesystem::path path) {
  std::error_code none;
  for (int links = 0; links < 40 && std::filesystem::is_symlink(path, none); ++links)
    path = path.parent_path() / std::filesystem::read_symlink(path, none);
  return path;
}

/// A file of its own, or standard output; a terminal or /dev/null has room for several.
bool is_same_place(const std::filesystem::path& a, const std::filesystem::path& b) {
  if (a.empty() || b.empty()) return false;
  struct stat of_a, of_b;
  const bool has_a = ::stat(a.c_str(), &of_a) == 0, has_b = ::stat(b.c_str(), &of_b) == 0;
  if (has_a && has_b && S_ISREG(of_a.st_mode))
    return of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
  if (a == "/dev/stdout" || (has_a && !S_ISCHR(of_a.st_mode))) return a == b;
  const auto canonical = [](const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::weakly_canonical(std::filesystem::absolute(end_of_links(path), ignored),
                                             ignored);
  };
  return !has_a && !has_b && canonical(a) == canonical(b);
}

}  // namespace

std::string read_whole(const std::filesystem::path& path, const std::function<void()>& on_signal) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw Unusable(path.string(), "is a directory");
  // Some have no end.
  if (std::filesystem::is_character_file(path, ignored))
    throw Unusable(path.string(), "is a device");
  // A pipe is waited for, to be opened and to be read.
  const auto going_on = [&](const auto& call) {
    for (;;) {
      const auto result = call();
      if (result >= 0) return result;
      if (errno != EINTR) throw Unusable(path.string(), std::strerror(errno));
      on_signal();
    }
  };
  const Descriptor file(going_on([&] { return ::open(path.c_str(), O_RDONLY | O_CLOEXEC); }));
  std::string bytes;
  if (const auto size = std::filesystem::file_size(path, ignored); !ignored)
    bytes.reserve(size + 1);
  std::vector<char> block(1 << 16);
  while (const ssize_t n = going_on([&] { return ::read(file.get(), block.data(), block.size()); }))
    bytes.append(block.data(), static_cast<std::size_t>(n));
  return bytes;
}

void write_whole(const std::filesystem::path& path, std::span<const std::string_view> parts) {
  struct stat status;
  const bool exists = ::stat(path.c_str(), &status) == 0;
  if (path == "/dev/stdout" || (exists && !S_ISREG(status.st_mode)))
    return write_through(path, parts);
  // A link stays; what it points to is replaced.
  const auto place = end_of_links(path);
  const mode_t mask = ::umask(0);
  ::umask(mask);
  const mode_t mode = exists ? (status.st_mode & 07777) : (0666 & ~mask);
  if (!write_nameless(place, parts, mode)) write_beside(place, parts, mode);
}

void append_to(const std::filesystem::path& path, std::string_view text) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC));
  if (!file || !file.write(std::span(&text, 1)) || !file.close()) fail(path, errno);
}

void clear_left_behind(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
    if (left_behind(entry.path().filename().string()))
      std::filesystem::remove(entry.path(), ignored);
}

void require_place(const std::string& option, const std::filesystem::path& path) {
  if (path.empty()) return;
  const auto refuse = [&](const std::string& what) {
    throw Unusable(option + " " + path.string(), what);
  };
  struct stat status;
  if (path == "/dev/stdout") return;
  if (::stat(path.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) refuse("is a directory");
    if (!S_ISREG(status.st_mode)) return;  // a device says itself what it thinks of writing
  }
  std::error_code ignored;
  const auto place = end_of_links(path);
  if (std::filesystem::is_symlink(place, ignored)) refuse(std::strerror(ELOOP));
  const auto folder = place.has_parent_path() ? place.parent_path() : std::filesystem::path(".");
  if (::stat(folder.c_str(), &status) != 0)
    refuse("folder " + folder.string() + ": " + std::strerror(errno));
  if (!S_ISDIR(status.st_mode)) refuse("folder " + folder.string() + ": is not a folder");
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    refuse("folder " + folder.string() + ": " + std::strerror(errno));
}

void require_places(std::span<const NamedFile> read, std::span<const NamedFile> written) {
  for (std::size_t i = 0; i < written.size(); ++i) {
    const auto& [option, path] = written[i];
    require_place(option, path);
    const auto apart = [&](const NamedFile& other) {
      if (is_same_place(path, other.path))
        throw Unusable(option + " " + path.string(), "is the place of " + other.option + ", too");
    };
    std::for_each(read.begin(), read.end(), apart);
    std::for_each(written.begin(), written.begin() + static_cast<std::ptrdiff_t>(i), apart);
  }
}

}  // namespace bvlab
