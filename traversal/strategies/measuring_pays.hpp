// SPDX-License-Identifier: BSD-3-Clause
/// Decides from run to run whether margins measure gaps. Where bodies move so far that few gaps
/// last until the next run, testing every entry costs less than measuring.
#pragma once

#include <cstddef>

namespace bvlab {

class MeasuringPays {
 public:
  /// The decision as far as it is known before a run collects its due entries. `step`: about how
  /// much nearer the bodies come from run to run.
  bool expected(double step) const { return runs_without_ == 0 || step < stopped_at_ / 2; }

  /// The decision for a run, once it is known how many of the front's entries are due.
  bool decide(std::size_t due, std::size_t entries, double step) {
    const std::size_t lasting = entries - due;
    if (static_cast<double>(lasting) < least_lasting * static_cast<double>(known_)) {
      runs_without_ = patience;
      stopped_at_ = step;
    }
    known_ = lasting;
    const bool pays = expected(step);
    runs_without_ = pays ? 0 : runs_without_ - 1;
    return pays;
  }
  /// A run has measured `count` gaps, besides those that lasted.
  void measured(std::size_t count) { known_ += count; }
  /// How many of the known gaps last until the next run says nothing: it has another front, another
  /// query or another limit.
  void ignore_last_run() { known_ = 0; }

 private:
  /// Measuring stops when a smaller share of the known gaps lasts until the next run. Among 0.2 to
  /// 0.5 this was fastest in the mean of three motions, three queries and two volumes.
  static constexpr double least_lasting = 0.3;
  /// It is tried again after this many runs: one in 33 is then measured to no use.
  static constexpr int patience = 32;

  std::size_t known_ = 0;  // gaps, at the end of the last run
  int runs_without_ = 0;   // runs to come that do not measure
  double stopped_at_ = 0;  // step when measuring stopped
};

}  // namespace bvlab
