// SPDX-License-Identifier: BSD-3-Clause
/// When a separation list is rebuilt from the roots: a rule as data, so that the loop over a list
/// is compiled once for all rules.
#pragma once

#include <cstddef>
#include <cstdint>

namespace bvlab {

class RebuildRule {
 public:
  /// Rebuilt in the run after 1 + `defer` runs in a row in which the list did not grow: the bodies
  /// are predicted to move apart (li1998incremental).
  static RebuildRule after_still_runs(unsigned defer) { return {Kind::still, defer}; }
  /// Rebuilt once a run has made more tests than the mean run since the last rebuild, that included
  /// (see by_cost.hpp).
  static RebuildRule by_mean_cost() { return {Kind::mean, 0}; }
  /// Rebuilt once a run has made as many tests as the last rebuild.
  static RebuildRule by_last_rebuild() { return {Kind::rebuild, 0}; }

  /// Whether the next run is to start from the roots, by the runs so far. `longest`: a list that is
  /// longer is rebuilt whatever it costs, unless the rule is about growth alone.
  bool due() const { return due_; }
  bool due(std::size_t size, std::size_t longest) const {
    return due_ || (kind_ != Kind::still && size > longest);
  }
  /// The next run starts from the roots.
  void restart() { due_ = false, runs_ = 0, still_ = 0, cost_ = 0; }
  /// A run has made so many tests of volumes.
  void ran(bool grew, std::size_t tests) {
    const auto cost = static_cast<double>(tests);
    cost_ += kind_ == Kind::mean || runs_ == 0 ? cost : 0;
    if (runs_++ > 0) still_ = grew ? 0 : still_ + 1;
    due_ = kind_ == Kind::still  ? still_ > defer_
           : kind_ == Kind::mean ? cost * runs_ > cost_
                                 : runs_ > 1 && cost >= cost_;
  }

 private:
  enum class Kind : std::uint8_t { still, mean, rebuild };
  RebuildRule(Kind kind, unsigned defer) : kind_(kind), defer_(defer) {}

  Kind kind_;
  bool due_ = false;
  unsigned defer_, still_ = 0;  // runs in a row without growth since the last rebuild
  double runs_ = 0, cost_ = 0;  // since the last rebuild, that included; of the rebuild alone
};

}  // namespace bvlab
