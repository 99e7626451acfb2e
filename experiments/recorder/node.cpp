// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recorder/node.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <limits>
#include <thread>

namespace bvlab {
namespace {

using Seconds = std::chrono::duration<double>;

double own_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Of all processors since the machine was started: user, nice, system, interrupts, stolen.
double busy_seconds() {
  std::ifstream stat("/proc/stat");
  std::string cpu;
  double user, nice, system, idle, waiting, interrupts, soft, stolen;
  if (!(stat >> cpu >> user >> nice >> system >> idle >> waiting >> interrupts >> soft >> stolen))
    return std::numeric_limits<double>::quiet_NaN();
  return (user + nice + system + interrupts + soft + stolen) /
         static_cast<double>(sysconf(_SC_CLK_TCK));
}

}  // namespace

std::string node_name() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 && name[0] ? name : "unknown";
}

Neighbours::Moment Neighbours::now() {
  return {std::chrono::steady_clock::now(), busy_seconds() - own_seconds()};
}

std::string Neighbours::alone() {
  constexpr Seconds window{0.5};
  Moment current = now();
  if (const Seconds seen = current.time - older_.time; seen < window) {
    std::this_thread::sleep_for(window - seen);
    current = now();
  }
  const double share =
      (current.others - older_.others) / Seconds(current.time - older_.time).count();
  if (current.time - newer_.time >= window) older_ = newer_, newer_ = current;
  return share < tolerated_share ? "yes" : "no";
}

}  // namespace bvlab
