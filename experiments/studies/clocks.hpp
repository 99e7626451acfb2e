// SPDX-License-Identifier: BSD-3-Clause
/// Runs that something else on the machine has disturbed are made again: a process that works all
/// the time takes as long by the wall clock as by its processor's.
#pragma once

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <string>
#include <utility>

namespace bvlab {

/// What this process has had of its processors, seconds.
inline double processor_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}
inline double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// As a record has times.
inline std::string nanoseconds(double seconds) {
  return std::to_string(std::llround(seconds * 1e9));
}

/// How many runs of this process were made again: said where a run says how far it is.
inline std::atomic<std::size_t>& repeated_runs() {
  static std::atomic<std::size_t> count = 0;
  return count;
}

/// What came of it, and how many seconds went by for each that the process worked.
template <class Result>
struct Undisturbed {
  Result result;
  double wall_per_processor;
};

/// `run()`, again while more than a tenth of the time went to others, five times at most; of all
/// runs the one that was disturbed least.
template <class Run>
auto undisturbed(Run&& run) {
  constexpr double tolerated = 1.1;
  constexpr int at_most = 5;
  const auto once = [&] {
    const double wall = wall_seconds(), processor = processor_seconds();
    auto result = run();
    const double worked = processor_seconds() - processor, passed = wall_seconds() - wall;
    return Undisturbed<decltype(run())>{std::move(result), worked > 0 ? passed / worked : 1};
  };
  auto best = once();
  for (int again = 1; again < at_most && best.wall_per_processor > tolerated; ++again) {
    ++repeated_runs();
    if (auto next = once(); next.wall_per_processor < best.wall_per_processor)
      best = std::move(next);
  }
  return best;
}

}  // namespace bvlab
