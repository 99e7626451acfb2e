// SPDX-License-Identifier: BSD-3-Clause
/// The command of a package for any x86-64 (experiments/package). It becomes the program that is
/// compiled for the most that this processor can do: PREFIX/bin/bvlab starts
/// PREFIX/libexec/bvlab/LEVEL/bvlab, LEVEL being the highest of x86-64, x86-64-v2, x86-64-v3 and
/// x86-64-v4 that is installed and that the processor and the system support.
///
/// BVLAB_PROCESSOR=LEVEL asks for a level: exit 2 where it is not installed or not supported.
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#if !defined(__x86_64__) || defined(__clang__)
#error "bvlab: the launcher needs x86-64 and GCC 12 or later, which knows the levels by name"
#endif

namespace {

struct Level {
  const char* name;
  bool supported;
};

/// The folder that holds `bin`.
std::string prefix() {
  std::string path(4096, '\0');
  const ssize_t length = readlink("/proc/self/exe", path.data(), path.size());
  if (length <= 0) return "..";
  path.resize(static_cast<std::size_t>(length));
  for (int k = 0; k < 2; ++k) path.resize(std::min(path.rfind('/'), path.size()));
  return path;
}

}  // namespace

int main(int, char** argv) {
  __builtin_cpu_init();
  const Level levels[] = {{"x86-64-v4", __builtin_cpu_supports("x86-64-v4") != 0},
                          {"x86-64-v3", __builtin_cpu_supports("x86-64-v3") != 0},
                          {"x86-64-v2", __builtin_cpu_supports("x86-64-v2") != 0},
                          {"x86-64", true}};
  const std::string programs = prefix() + "/libexec/bvlab/";
  const char* const asked = std::getenv("BVLAB_PROCESSOR");
  for (const auto& [name, supported] : levels) {
    if (!supported || (asked && std::strcmp(asked, name) != 0)) continue;
    const std::string program = programs + name + "/bvlab";
    execv(program.c_str(), argv);
    if (errno == ENOENT) continue;
    std::fprintf(stderr, "bvlab: %s: %s\n", program.c_str(), std::strerror(errno));
    return 1;
  }
  if (asked)
    std::fprintf(stderr, "bvlab: BVLAB_PROCESSOR=%s: not installed, or not for this processor\n",
                 asked);
  else
    std::fprintf(stderr, "bvlab: %s*/bvlab: none is for this processor\n", programs.c_str());
  return asked ? 2 : 1;
}
