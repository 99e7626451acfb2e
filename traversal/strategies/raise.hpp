// SPDX-License-Identifier: BSD-3-Clause
/// A separation list that is raised to parents where the bodies have come apart, so that it need
/// not be rebuilt from the roots (li1998incremental; ehmann2001accurate raises fronts, too).
///
/// Cost. Two siblings whose parent is apart cost one test too many in every run. Testing a parent
/// costs one test; if it is apart, it replaces two entries and saves one test a run. If a share h
/// of the parents come apart in a run, testing all in every T-th run costs 1 / T + h T / 2 for
/// each, which is least where as much is spent in vain as is lost by raising late. But h falls with
/// the time since the parent was last seen to overlap, so it is tested after 1 run, 2, 4, ... (see
/// rising_front.hpp): of first tests, one in seven succeeds in little motion, nine in ten in
/// violent motion; either way the waste is small relative to the cost of descending. Bodies at
/// rest, with n entries, take n tests a run and at most n / 32 for parents.
///
/// On binary trees, a rebuild that finds n leaves of the test tree takes 2n - 1 tests. Where bodies
/// jump, raising and descending costs more than that: then the list is dropped and rebuilt in the
/// next run. If no run of the new list is cheaper either, it is rebuilt only after twice as many
/// runs from the roots, up to 16. As a list has more entries than the test tree would have leaves,
/// a run counts as too expensive from (2n - 1) / 1.2 tests on, n being its entries at the end (with
/// 1 or 1.5 in place of 1.2 more tests were made on the whole).
///
/// Runs cut short. The pair that was hit is tested first in the next run, before any parent, and a
/// hit there ends that run at once. Parents come next, so that raises persist if a hit then cuts
/// the run short. Pairs that were pushed but not tested become entries like all others. Such a run
/// does not count for or against the list. For distances, parents are tested against the bound that
/// the witness, or else one descent from the roots, has given.
#pragma once

#include <algorithm>
#include <string_view>

#include "traversal/no_front.hpp"
#include "traversal/strategies/rising_front.hpp"

namespace bvlab {

class Raise {
 public:
  static constexpr std::string_view name = "raise";
  static constexpr std::string_view description =
      "separation list that is raised where the parent of two entries is apart again";

  template <class Pair>
  TraversalStatistics run(const Pair& pair) {
    if (recursions_ > 0) {
      --recursions_;
      return pair.from_roots();
    }
    const bool rebuild = front_.empty() || front_.size() > longest_list(pair);
    if (rebuild) {
      front_.restart();
      paid_ = false;
    }
    const TraversalStatistics statistics = pair.from_front(front_);
    if (!rebuild && statistics.everything) judge(static_cast<double>(statistics.volumes));
    return statistics;
  }

  /// Also where the roots are its one entry.
  bool starts_at_roots() const { return recursions_ > 0 || front_.size() <= 1; }
  void roots_are_apart() {
    if (recursions_ > 0) {
      --recursions_;
      return;
    }
    if (front_.empty()) {
      front_.restart();
      paid_ = false;
    }
    front_.pass_by();
  }
  template <class Pair>
  void run_below_roots(const Pair& pair) {
    if (recursions_ > 0) {
      --recursions_;
      pair.from_roots(Start::below_roots);
      return;
    }
    const bool rebuild = front_.empty();
    if (rebuild) paid_ = false;
    front_.restart_below_roots();
    const TraversalStatistics statistics = pair.from_front(front_);
    if (!rebuild && statistics.everything) judge(1 + static_cast<double>(statistics.volumes));
  }

  const Front& front() const { return front_; }
  std::size_t front_size() const { return front_.size(); }

 private:
  static constexpr unsigned longest_pause = 16;
  static constexpr double surplus = 1.2;
  static constexpr std::size_t few = 8;  // lists up to this length are not judged

  /// Drops the list if recursion would have been cheaper than the run just made through it.
  void judge(double tests) {
    if (front_.size() < few) return;
    const double recursion = 2 * static_cast<double>(front_.size()) - 1;
    if (surplus * tests < recursion) {
      paid_ = true;
      return;
    }
    pause_ = paid_ ? 1 : std::min(2 * pause_, longest_pause);
    recursions_ = pause_ - 1;
    front_.clear();
  }

  RisingFront front_;
  bool paid_ = false;        // some run of this list cost less than recursion
  unsigned recursions_ = 0;  // runs from the roots before it is rebuilt
  unsigned pause_ = 1;       // runs from its drop to its rebuild
};

}  // namespace bvlab
