// SPDX-License-Identifier: BSD-3-Clause
/// Decides from run to run whether margins measure gaps. Where bodies move so far that few gaps
/// last until the next run, testing every entry costs less than measuring.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace bvlab {

class MeasuringRule {
 public:
  /// `step`: about how much nearer two bodies are expected to come from run to run; `leaf_size`:
  /// the mean size of their leaves. Where the bodies are fast, the first runs do not measure.
  explicit MeasuringRule(double step = 0, double leaf_size = 0)
      : step_(step), runs_without_(step > fast * leaf_size ? patience : 0), stopped_at_(step) {}

  /// Counts a run, whether or not it collects due entries. `step`: about how much nearer the
  /// bodies have come since the last run; 0 at rest.
  void begin_run(double step) {
    ++runs_;
    step_ = step;
  }

  /// Whether this run measures, before its due entries are collected.
  bool expected() const { return runs_without_ == 0 || step_ < stopped_at_ / 2; }

  /// Whether this run measures, where `due` of the front's entries are due.
  bool decide(std::size_t due, std::size_t entries) {
    const std::size_t lasting = entries - due;
    // How many would be left had only `least_lasting` of them lasted in each run since.
    auto least = static_cast<double>(known_);
    for (std::uint32_t run = 0; run < runs_ && least > 1; ++run) least *= least_lasting;
    if (static_cast<double>(lasting) + 1 < least) {
      runs_without_ = patience;
      stopped_at_ = std::max(step_, measured_at_);
    }
    const bool measures = expected();
    if (measures) measured_at_ = step_;
    runs_without_ = measures ? 0 : runs_without_ - 1;
    runs_ = 0;
    known_ = measures ? lasting : 0;
    return measures;
  }
  /// Adds gaps announced in this run. Ignored if it has not collected the due entries.
  void add_announced(std::size_t count) {
    if (runs_ == 0) known_ += count;
  }
  /// The next decision ignores the gaps of earlier runs: the front or the query has changed.
  void ignore_earlier() { known_ = 0; }

 private:
  /// Measuring stops when a smaller share of the gaps lasts until the next run. Of 0.2, 0.3, 0.4
  /// and 0.5 this was fastest in the mean (five motions, touching and contacts, two volumes).
  static constexpr double least_lasting = 0.3;
  /// Measuring is tried again after this many runs. At a steady step one run in 33
  /// measures in vain.
  static constexpr int patience = 32;
  /// In leaf sizes per run. Hardly any gap of faster bodies lasts until the next run.
  static constexpr double fast = 2;

  std::size_t known_ = 0;   // gaps that lasted, or were announced, when entries were last collected
  std::uint32_t runs_ = 0;  // since then
  double step_;             // of this run
  int runs_without_;        // runs to come that do not measure
  double measured_at_ = 0;  // step of the last run that measured
  double stopped_at_;       // larger step of two: when measuring stopped, and in its last run
};

}  // namespace bvlab
