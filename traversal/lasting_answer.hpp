// SPDX-License-Identifier: BSD-3-Clause
/// How long the answer for a pair of bodies is valid: until they can have come nearer by the gap
/// that was found. Two tests decide this. The first compares the sum of both bodies' displacement
/// bounds with the sum at which the answer expires; it overestimates motion where bodies jitter or
/// move together. The second bounds the motion from the reference poses to the present ones, which
/// is tighter.
#pragma once

#include "traversal/relative_motion_bound.hpp"

namespace bvlab {

/// The sum of displacements at which an answer expires if the bodies are `gap` apart now, the sum
/// being `displacement`. Covers the rounding of such sums, here and where they are compared.
inline double displacement_at_expiry(double displacement, double gap) {
  return (displacement + gap) * (1 - 8 * unit_roundoff<double>);
}

/// The second test: the validity of an answer by the bound from reference poses.
class LastingAnswer {
 public:
  /// The answer lasts until the bodies have come nearer than they are now by `gap`.
  void restart(MovingBody& a, MovingBody& b, double gap) {
    motion_.restart(a, b);
    gap_ = motion_.left_of(gap);
  }
  /// No answer lasts.
  void forget() { gap_ = 0; }
  /// A lower bound on what is left of the gap; not positive where the answer may have changed.
  double remaining(MovingBody& a, MovingBody& b) {
    if (!(gap_ > 0)) return 0;
    motion_.advance(a, b);
    return (gap_ - motion_.now()) * (1 - 4 * unit_roundoff<double>);
  }

 private:
  RelativeMotionBound motion_;
  double gap_ = 0;
};

}  // namespace bvlab
