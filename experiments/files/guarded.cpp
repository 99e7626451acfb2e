// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/files/guarded.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <fstream>
#include <string_view>

namespace bvlab {
namespace {

void limit_to(const Guard& guard, std::size_t bytes_before) {
  const rlimit time{guard.seconds, guard.seconds + 1}, none{0, 0};
  const rlimit room{bytes_before + guard.bytes, bytes_before + guard.bytes};
  setrlimit(RLIMIT_CPU, &time);
  setrlimit(RLIMIT_AS, &room);
  setrlimit(RLIMIT_CORE, &none);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGINT, SIGSEGV, SIGBUS, SIGFPE, SIGABRT, SIGXCPU})
    std::signal(signal, SIG_DFL);
}

/// What a library prints as it breaks off is not the line that a refusal is.
void silence_standard_error() {
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) dup2(nowhere, STDERR_FILENO);
}

[[noreturn]] void work_and_exit(const std::function<std::string()>& work, int out) {
  try {
    const std::string bytes = work();
    for (std::string_view left = bytes; !left.empty();) {
      const ssize_t written = write(out, left.data(), left.size());
      if (written > 0) left.remove_prefix(static_cast<std::size_t>(written));
      if (written < 0 && errno != EINTR) _exit(1);
    }
  } catch (...) {
    std::signal(SIGABRT, SIG_DFL);
    kill(getpid(), SIGABRT);
  }
  _exit(0);
}

std::size_t bytes_of_this_process() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

Guarded guarded(const Guard& guard, const std::function<std::string()>& work) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return {work(), 0};
  const std::size_t bytes_before = bytes_of_this_process();
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    limit_to(guard, bytes_before);
    silence_standard_error();
    work_and_exit(work, ends[1]);
  }
  close(ends[1]);
  Guarded found;
  char part[65536];
  for (ssize_t got = 1; child > 0 && got != 0;) {
    got = read(ends[0], part, sizeof part);
    if (got > 0) found.bytes.append(part, static_cast<std::size_t>(got));
    if (got < 0 && errno != EINTR) break;
  }
  close(ends[0]);
  if (child < 0) return {work(), 0};
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status)) found.signal = WTERMSIG(status);
  if (WIFEXITED(status) && WEXITSTATUS(status) != 0) found.signal = SIGABRT;
  return found;
}

}  // namespace bvlab
