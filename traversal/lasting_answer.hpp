// SPDX-License-Identifier: BSD-3-Clause
/// How long the answer for a pair of bodies is valid: until they can have come nearer by the gap
/// that was found. Two tests decide this. The first compares the sum of both bodies' displacement
/// bounds with the sum at which the answer expires; it overestimates motion where bodies jitter or
/// move together. The second bounds the motion from the reference poses to the present ones, which
/// is tighter.
#pragma once

#include "traversal/moving_body.hpp"

namespace bvlab {

/// The sum of displacements at which an answer expires if the bodies are `gap` apart now, the sum
/// being `displacement`. Covers the rounding of such sums, here and where they are compared.
inline double displacement_at_expiry(double displacement, double gap) {
  return (displacement + gap) * (1 - 8 * unit_roundoff<double>);
}

/// The second test: the validity of an answer by the bound from reference poses
/// (reference_pose.hpp), which falls when the bodies move back.
class LastingAnswer {
 public:
  /// The answer lasts until the bodies have come nearer than they are now by `gap`, less what the
  /// poses and rounding may be off by.
  void restart(MovingBody& a, MovingBody& b, double gap) {
    a_ = a.present_pose(), b_ = b.present_pose();
    const double off = a_.error_bound + b_.error_bound;
    gap_ = (gap - off) - 4 * unit_roundoff<double> * (gap + off);
  }
  /// No answer lasts.
  void forget() { gap_ = 0; }
  /// A lower bound on what is left of the gap; not positive where the answer may have changed.
  double remaining(MovingBody& a, MovingBody& b) const {
    constexpr double u = unit_roundoff<double>;
    if (!(gap_ > 0)) return 0;
    const ReferencePose &to_a = a.present_pose(), &to_b = b.present_pose();
    const Vec3<double> shift = (to_a.centre - a_.centre) - (to_b.centre - b_.centre);
    const double moved = shift.norm() + rotation_difference(a_, to_a) * a.extent().radius +
                         rotation_difference(b_, to_b) * b.extent().radius;
    const double nearer = moved * (1 + 32 * u) +
                          (a_.error_bound + to_a.error_bound + b_.error_bound + to_b.error_bound);
    return (gap_ - nearer * (1 + 4 * u)) * (1 - 4 * u);
  }

 private:
  ReferencePose a_, b_;
  double gap_ = 0;
};

}  // namespace bvlab
