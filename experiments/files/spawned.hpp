// SPDX-License-Identifier: BSD-3-Clause
/// Another program, run to its end, and what it wrote.
#pragma once

#include <string>
#include <vector>

namespace bvlab {

struct Spawned {
  int status = 127;  ///< its exit status; 127 where it could not be started, or a signal ended it
  std::string text;
};

enum class Stream { output = 1, error = 2 };

/// Runs words[0], found in PATH unless it has a '/', and keeps what it writes to one stream. The
/// other one goes to /dev/null. No shell is asked.
Spawned spawned(std::vector<std::string> words, Stream kept);

}  // namespace bvlab
