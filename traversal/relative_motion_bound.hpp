// SPDX-License-Identifier: BSD-3-Clause
/// An upper bound on how much nearer two bodies, or any parts of them, can have come to each other
/// since `restart`, in units of the mesh. It serves as a clock: a gap g that is measured now has
/// its deadline at now() + g. Unlike a clock it goes back when the bodies do: it is a bound from
/// the reference poses to the present ones (reference_pose.hpp), not along the path.
#pragma once

#include <utility>

#include "traversal/moving_body.hpp"

namespace bvlab {

class RelativeMotionBound {
 public:
  /// Starts the clock anew, at what poses and rounding may be off by.
  void restart(MovingBody& a, MovingBody& b) {
    base_ = since_ = 0;
    refer(a, b);
  }

  /// Advances the clock after the bodies have moved.
  void advance(MovingBody& a, MovingBody& b) {
    const ReferencePose &to_a = a.reference_pose(), &to_b = b.reference_pose();
    const Vec3<double> shift = (to_a.centre - a_.centre) - (to_b.centre - b_.centre);
    since_ = (shift.norm() + rotation_difference(a_, to_a) * a.extent().radius +
              rotation_difference(b_, to_b) * b.extent().radius) *
             (1 + 32 * unit_roundoff<double>)+(a_.error_bound + to_a.error_bound + b_.error_bound +
                                               to_b.error_bound);
  }

  /// Makes the current poses the reference poses. Earlier deadlines stay valid, but motion back
  /// towards the former reference poses now counts as motion instead of cancelling.
  void refer(MovingBody& a, MovingBody& b) {
    base_ = now();
    a_ = a.reference_pose(), b_ = b.reference_pose();
    since_ = a_.error_bound + b_.error_bound;
  }

  /// The time on the clock.
  double now() const { return (base_ + since_) * (1 + 4 * unit_roundoff<double>); }
  /// The part of `now()` since the reference poses.
  double since() const { return since_; }

  /// The time until which bodies (or parts) that are `gap` apart now cannot touch.
  double deadline(double gap) const {
    return base_ + (gap - since_) - 4 * unit_roundoff<double> * (base_ + gap + since_);
  }

  /// Sets the clock back to the time since the reference poses; returns by how much.
  double set_back() { return std::exchange(base_, 0); }

 private:
  ReferencePose a_, b_;
  double base_ = 0;   // the clock at the reference poses
  double since_ = 0;  // how much nearer since then, at most
};

}  // namespace bvlab
