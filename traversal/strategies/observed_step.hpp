// SPDX-License-Identifier: BSD-3-Clause
/// How far a pair of bodies moves from run to run, in sizes of their leaves, as `Adaptive` samples
/// it: measuring costs as much as a few tests.
#pragma once

#include <algorithm>
#include <cstdint>

#include "traversal/moving_body.hpp"

namespace bvlab {

class ObservedStep {
 public:
  /// Counts a run without a look at the bodies.
  void skip() { ++unseen_; }
  int skipped() const { return unseen_; }

  /// Measures how far the bodies have moved since the last run. Unless `always`, and unless they
  /// rest or begin to move, only two of eight successive runs do it, the same two for all pairs of
  /// bodies that move together. Returns whether it was done.
  bool measure(MovingBody& a, MovingBody& b, bool always) {
    const std::uint32_t moves = a.epoch() + b.epoch();
    const bool rested = at_rest();
    rests_ = moves == moves_ ? std::min(rests_ + 1, long_rest) : 0;
    moves_ = moves;
    constexpr std::uint32_t cycle = 16, measured = 4;  // in moves of both bodies, which begin at 2
    if (!always && !rested && !at_rest() && (moves - 2) % cycle >= measured && leaf_ > 0) {
      skip();
      return false;
    }
    const double displacement = a.displacement_bound() + b.displacement_bound();
    if (leaf_ == 0) {
      leaf_ = mean_leaf_size(a, b);
      // A move may combine several frames.
      step_ = std::max(leaf_, mean_step(a, b));
    } else if ((always || unseen_ == 0) && displacement != displacement_) {
      step_ = (displacement - displacement_) / (1 + unseen_);
    }
    displacement_ = displacement;
    unseen_ = 0;
    return true;
  }

  /// The motion per run when it was last measured and not 0.
  double last() const { return step_; }
  /// The motion that is expected in the next run.
  double expected() const { return at_rest() ? 0 : step_; }
  double expected_in_leaves() const { return expected() / leaf_; }

 private:
  /// After so many runs without a move, bodies are expected to stay.
  static constexpr int long_rest = 4;

  bool at_rest() const { return rests_ == long_rest; }

  int unseen_ = 0;              // runs since the bodies were measured
  int rests_ = 0;               // successive runs without a move, at most long_rest
  std::uint32_t moves_ = 0;     // of both bodies
  double displacement_ = 0;     // bound of both bodies, when they were measured
  double step_ = 0, leaf_ = 0;  // the last one; size of a leaf, mean of both bodies
};

}  // namespace bvlab
