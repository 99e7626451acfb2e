// SPDX-License-Identifier: BSD-3-Clause
/// A body as far as its motion is concerned: what a strategy may know of it, whatever its volumes.
#pragma once

#include <cstdint>

#include "traversal/once.hpp"
#include "traversal/reference_pose.hpp"

namespace bvlab {

class MovingBody {
 public:
  explicit MovingBody(const HierarchyExtent& extent) : extent_(extent) {}

  const Pose& pose() const { return pose_; }
  const HierarchyExtent& extent() const { return extent_; }
  /// The same number means that the body has not moved, unless 2^32 - 1 moves lie between.
  std::uint32_t epoch() const { return epoch_; }
  /// Where it stands. Computed when it is asked for: a strategy that keeps no margins does not ask.
  const ReferencePose& reference_pose() {
    follow();
    return reference_pose_;
  }
  /// How far any of its points can have moved from each reference pose that was asked for to the
  /// next, all together: it grows whenever the body has moved.
  double displacement_bound() {
    follow();
    return displacement_bound_;
  }
  /// The same of what its rotation matrices differ by, in the spectral norm.
  double turn_bound() {
    follow();
    return turn_bound_;
  }

 protected:
  /// Says whether the body has moved.
  bool place(const Pose& pose, const Vec3<double>& origin) {
    if (epoch_ > 0 && pose == pose_ && origin == origin_) return false;
    pose_ = pose;
    origin_ = origin;
    ++epoch_;
    return true;
  }

  Pose pose_;
  Vec3<double> origin_ = Vec3<double>::Zero();
  std::uint32_t epoch_ = 0;
  Askers askers_ = Askers::one;  // who asks: several threads may

 private:
  void follow() {
    once(followed_, epoch_, askers_, [this] { follow_here(); });
  }
  void follow_here() {
    const ReferencePose now(pose_, extent_);
    // Rounded up, so that no step is lost in a long way.
    constexpr double up = 1 + 4 * unit_roundoff<double>;
    if (displacement_bound_ < 0) {
      displacement_bound_ = 0;
    } else {  // what is no number stays none
      const double turn = turn_between(reference_pose_, now);
      const double step = step_between(reference_pose_, now, turn, extent_.radius);
      displacement_bound_ = (displacement_bound_ + step) * up;
      turn_bound_ = (turn_bound_ + turn * (1 + 32 * unit_roundoff<double>)) * up;
    }
    reference_pose_ = now;
  }

  HierarchyExtent extent_;
  ReferencePose reference_pose_;
  double displacement_bound_ = -1;  // before the first reference pose
  double turn_bound_ = 0;
  std::uint32_t followed_ = never_done;  // the epoch that the reference pose is of
};

}  // namespace bvlab
