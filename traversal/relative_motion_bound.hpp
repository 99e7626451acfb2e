// SPDX-License-Identifier: BSD-3-Clause
/// An upper bound on how much nearer two bodies, or any parts of them, can have come to each other
/// since `restart`, in units of the mesh. It falls when the bodies move back: it is a bound from
/// the reference poses to the present ones (reference_pose.hpp), not along the path.
#pragma once

#include "traversal/moving_body.hpp"

namespace bvlab {

class RelativeMotionBound {
 public:
  /// Makes the current poses the reference poses. The bound starts at what poses and rounding may
  /// be off by.
  void restart(MovingBody& a, MovingBody& b) {
    a_ = a.present_pose(), b_ = b.present_pose();
    nearer_ = a_.error_bound + b_.error_bound;
  }

  /// Updates the bound after the bodies have moved.
  void advance(MovingBody& a, MovingBody& b) {
    const ReferencePose &to_a = a.present_pose(), &to_b = b.present_pose();
    const Vec3<double> shift = (to_a.centre - a_.centre) - (to_b.centre - b_.centre);
    nearer_ = (shift.norm() + rotation_difference(a_, to_a) * a.extent().radius +
               rotation_difference(b_, to_b) * b.extent().radius) *
              (1 + 32 * unit_roundoff<double>)+(a_.error_bound + to_a.error_bound + b_.error_bound +
                                                to_b.error_bound);
  }

  double now() const { return nearer_ * (1 + 4 * unit_roundoff<double>); }
  /// Returns the value that `now()` must reach before parts that are `gap` apart at the reference
  /// poses can touch. Must be called before the first `advance`.
  double left_of(double gap) const {
    return (gap - nearer_) - 4 * unit_roundoff<double> * (gap + nearer_);
  }

 private:
  ReferencePose a_, b_;
  double nearer_ = 0;
};

}  // namespace bvlab
