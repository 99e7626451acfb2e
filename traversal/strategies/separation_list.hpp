// SPDX-License-Identifier: BSD-3-Clause
/// The separation list of li1998incremental, with deferred rebuilding.
///
/// A run starts from the pairs at which the last one stopped, and the list never shrinks. When it
/// has stopped growing the bodies are predicted to move apart, and the list is rebuilt from the
/// roots in the next run: after one run without growth (`SeparationList`), or only after `1 + k`
/// such runs in a row (`Deferred`, k = 1 as published). For bodies at rest on binary trees, whose
/// BVTT has n leaves, a rebuild makes 2n - 1 tests and each other run n: in the mean
/// (2n - 1 + (1 + k) n) / (2 + k).
///
/// The slides of li1998incremental leave some cases open. Here:
/// - a rebuild does not count as a run without growth, so the run after it always uses the list;
/// - a run that a hit cuts short counts like any other: as growth where the list grew, and as a run
///   without growth where it did not (if it did not count, the list of two bodies in lasting
///   contact would never be rebuilt, and in long runs it grows to ten times the necessary length);
/// - the pair that was hit stays in the list and is tested first in the next run (a witness);
/// - pairs that were pushed but not tested when a hit cut a run short stay in the list.
#pragma once

#include <string_view>

#include "traversal/front.hpp"
#include "traversal/strategies/rebuild_rule.hpp"

namespace bvlab {

/// A separation list that a rule rebuilds from the roots.
class RebuiltList {
 public:
  explicit RebuiltList(const RebuildRule& rule) : rule_(rule) {}

  template <class Pair>
  TraversalStatistics run(const Pair& pair) {
    if (front_.empty() || rule_.due(front_.size(), longest_list(pair)))
      front_.restart(), rule_.restart();
    const std::size_t before = front_.size();
    const TraversalStatistics statistics = pair.from_front(front_);
    rule_.ran(front_.size() > before, statistics.volumes);
    return statistics;
  }

  /// Also where the roots are its one entry.
  bool starts_at_roots() const { return front_.size() <= 1 || rule_.due(); }
  void roots_are_apart() {
    if (front_.empty() || rule_.due()) front_.restart(), rule_.restart();
    rule_.ran(false, 1);
  }
  template <class Pair>
  void run_below_roots(const Pair& pair) {
    if (front_.empty() || rule_.due()) rule_.restart();
    front_.restart_below_roots();
    const TraversalStatistics statistics = pair.from_front(front_);
    rule_.ran(front_.size() > 1, 1 + statistics.volumes);
  }

  const RebuildRule& rule() const { return rule_; }
  const Front& front() const { return front_; }
  std::size_t front_size() const { return front_.size(); }

 private:
  Front front_;
  RebuildRule rule_;
};

class Deferred : public RebuiltList {
 public:
  static constexpr std::string_view name = "deferred";
  static constexpr std::string_view description =
      "separation list, rebuilt once it has not grown for 1 + k runs (deferred:k; k = 1 as "
      "published)";

  /// `defer`: how many runs without growth pass before the one that triggers a rebuild.
  explicit Deferred(unsigned defer = 1) : RebuiltList(RebuildRule::after_still_runs(defer)) {}
};

class SeparationList : public Deferred {
 public:
  static constexpr std::string_view name = "separation-list";
  static constexpr std::string_view description =
      "starts from where the last run stopped; rebuilt in the run after one without growth";

  SeparationList() : Deferred(0) {}
};

}  // namespace bvlab
