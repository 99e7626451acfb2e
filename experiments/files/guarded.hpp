// SPDX-License-Identifier: BSD-3-Clause
/// Work in a process of its own: what crashes there, takes all memory or does not end is an answer
/// here. For libraries that are given what anybody wrote. Costs a fork and a copy of the result.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace bvlab {

struct Guard {
  unsigned seconds;   ///< of processor time, at least 1
  std::size_t bytes;  ///< of memory beside what this process has
};

struct Guarded {
  std::string bytes;  ///< what the work returned
  int signal = 0;     ///< that ended it (SIGXCPU: the time was up); 0 where it returned
};

/// The work has to be such as a child of a process with threads may do: it takes no lock that they
/// may hold. What it throws counts as SIGABRT.
Guarded guarded(const Guard& guard, const std::function<std::string()>& work);

}  // namespace bvlab
