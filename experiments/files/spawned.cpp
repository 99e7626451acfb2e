// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/files/spawned.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace bvlab {

Spawned spawned(std::vector<std::string> words, Stream kept) {
  int ends[2];
  if (pipe(ends) != 0) return {};
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const int stream = static_cast<int>(kept);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], stream);
  posix_spawn_file_actions_addopen(&actions, 3 - stream, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addclose(&actions, ends[0]);
  pid_t child = 0;
  const int fault =
      posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  Spawned found;
  char part[65536];
  for (ssize_t got; fault == 0 && (got = read(ends[0], part, sizeof part)) > 0;)
    found.text.append(part, static_cast<std::size_t>(got));
  close(ends[0]);
  int status = 0;
  if (fault == 0 && waitpid(child, &status, 0) == child && WIFEXITED(status))
    found.status = WEXITSTATUS(status);
  return found;
}

}  // namespace bvlab
