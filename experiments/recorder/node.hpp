// SPDX-License-Identifier: BSD-3-Clause
/// Where rows were measured, and whether anything else was at work there.
#pragma once

#include <chrono>
#include <string>

namespace bvlab {

/// This machine's name on its network.
std::string node_name();

/// Processor time that other processes take, and the hypervisor: /proc/stat less this process' own.
/// It is measured, not declared, so that whatever started a run, and whoever's the other work is,
/// the rows say what happened.
class Neighbours {
 public:
  /// Of one core: what a quiet machine's services take stays below.
  static constexpr double tolerated_share = 0.1;

  Neighbours() : older_(now()), newer_(older_) {}

  /// "yes" where others have taken less than the tolerated share since the last call but one half
  /// a second ago, at least: the clock of /proc/stat is coarse, so that the first call waits until
  /// there is as much to judge by. "no" also where /proc/stat cannot be read.
  std::string alone();

 private:
  struct Moment {
    std::chrono::steady_clock::time_point time;
    double others = 0;  ///< seconds of processors, all together; NaN where unknown
  };
  static Moment now();

  Moment older_, newer_;
};

}  // namespace bvlab
