// SPDX-License-Identifier: BSD-3-Clause
/// How much nearer two bodies, and any parts of them, can have come to each other: a clock that
/// shows an upper bound on it, by which a gap that was measured expires. The bound is derived in
/// reference_pose.hpp.
#pragma once

#include <utility>

#include "traversal/moving_body.hpp"

namespace bvlab {

class RelativeMotionBound {
 public:
  /// Begins at zero.
  void restart(MovingBody& a, MovingBody& b) {
    base_ = since_ = 0;
    refer(a, b);
  }

  /// The bodies have moved.
  void advance(MovingBody& a, MovingBody& b) {
    const ReferencePose &to_a = a.reference_pose(), &to_b = b.reference_pose();
    const Vec3<double> shift = (to_a.centre - a_.centre) - (to_b.centre - b_.centre);
    since_ = (shift.norm() + turn_between(a_, to_a) * a.extent().radius +
              turn_between(b_, to_b) * b.extent().radius) *
             (1 + 32 * unit_roundoff<double>)+(a_.noise + to_a.noise + b_.noise + to_b.noise);
  }

  /// From now on motion is measured from here. What was shown before goes on to hold, but what is
  /// measured later no longer profits from motions that cancel.
  void refer(MovingBody& a, MovingBody& b) {
    base_ = now();
    a_ = a.reference_pose(), b_ = b.reference_pose();
    since_ = a_.noise + b_.noise;
  }

  /// What the clock shows.
  double now() const { return (base_ + since_) * (1 + 4 * unit_roundoff<double>); }
  /// The part of it since the reference poses that motion is measured from.
  double since() const { return since_; }

  /// Bodies (or parts) that are `gap` apart now cannot touch while the clock shows less than this.
  double deadline(double gap) const {
    return base_ + (gap - since_) - 4 * unit_roundoff<double> * (base_ + gap + since_);
  }

  /// Sets the clock back to what has passed since motion was last referred; says by how much.
  double set_back() { return std::exchange(base_, 0); }

 private:
  ReferencePose a_, b_;
  double base_ = 0;   // what it showed at those reference poses
  double since_ = 0;  // how much nearer since then, at most
};

}  // namespace bvlab
