// SPDX-License-Identifier: BSD-3-Clause
/// The motion of a body: its pose, and bounds on how far it has moved. It is all that a strategy
/// may know of a body, whatever the volumes.
#pragma once

#include <cstdint>

#include "hierarchies/geometry/once.hpp"
#include "hierarchies/geometry/relative_pose.hpp"
#include "traversal/reference_pose.hpp"

namespace bvlab {

/// The distance of a body's origin from the world's from which on it is far (MovingBody::is_far). A
/// volume in the world is larger by ten roundings of its distance from the origin, and more.
template <class T>
double far_from_origin(const HierarchyExtent& extent) {
  return extent.leaf_size() / (256 * unit_roundoff<T>)-extent.reach;
}

class MovingBody {
 public:
  explicit MovingBody(const HierarchyExtent& extent) : extent_(extent) {}

  const Pose& pose() const { return pose_; }
  const HierarchyExtent& extent() const { return extent_; }
  /// Counts the moves: equal values mean that the body has not moved in between (unless by about
  /// 2^32 moves).
  std::uint32_t epoch() const { return epoch_; }
  /// Whether, in the world frame, the body is so far from the origin that volumes would grow there
  /// by more than a 25th of a leaf. Pairs of which a body is far are tested in the frame of their
  /// second body.
  bool is_far() const { return is_far_; }
  /// The pose from which relative poses to other bodies are formed. Computed once after each move.
  const OrthonormalPose& orthonormal_pose() {
    once(orthonormal_done_, epoch_, sharing_,
         [this] { orthonormal_pose_ = OrthonormalPose(pose_, extent_.reach, extent_.origin); });
    return orthonormal_pose_;
  }
  /// The present pose, to serve as the reference pose of bounds on later motion. Computed on
  /// request: a strategy without margins never requests it.
  const ReferencePose& present_pose() {
    follow();
    return present_pose_;
  }
  /// An upper bound on the length of any point's path through the poses of the requests so far, in
  /// units of the world. It never falls, while a bound from reference poses (lasting_answer.hpp)
  /// does when a body moves back.
  double displacement_bound() {
    follow();
    return displacement_bound_;
  }
  /// The same for the rotation: the sum of the spectral norms of its matrix differences.
  double rotation_bound() {
    follow();
    return rotation_bound_;
  }

 protected:
  /// Sets pose and origin; returns whether either changed.
  bool set_pose(const Pose& pose, const Vec3<double>& origin) {
    if (epoch_ > 0 && pose == pose_ && origin == origin_) return false;
    pose_ = pose;
    origin_ = origin;
    ++epoch_;
    return true;
  }

  Pose pose_;
  Vec3<double> origin_ = Vec3<double>::Zero();
  std::uint32_t epoch_ = 0;
  bool is_far_ = false;
  Sharing sharing_ = Sharing::one_thread;        // whether several threads use the body
  std::uint32_t orthonormal_done_ = never_done;  // the epoch of `orthonormal_pose_`

 private:
  void follow() {
    once(followed_, epoch_, sharing_, [this] { follow_here(); });
  }
  void follow_here() {
    const ReferencePose now(pose_, extent_);
    // Rounded up, so that the sum of many steps stays an upper bound.
    constexpr double up = 1 + 4 * unit_roundoff<double>;
    if (displacement_bound_ < 0) {
      displacement_bound_ = 0;
    } else {  // NaN stays NaN
      const double rotation = rotation_difference(present_pose_, now);
      const double step = step_between(present_pose_, now, rotation, extent_.radius);
      displacement_bound_ = (displacement_bound_ + step) * up;
      rotation_bound_ = (rotation_bound_ + rotation * (1 + 32 * unit_roundoff<double>)) * up;
    }
    present_pose_ = now;
  }

  HierarchyExtent extent_;
  ReferencePose present_pose_;
  double displacement_bound_ = -1;  // before the first request
  double rotation_bound_ = 0;
  std::uint32_t followed_ = never_done;  // the epoch of `present_pose_`
  OrthonormalPose orthonormal_pose_;
};

/// About how much nearer two bodies come when both move: their displacement bounds, each over the
/// number of the body's poses so far, the first included. At most the mean per move.
inline double mean_step(MovingBody& a, MovingBody& b) {
  return a.displacement_bound() / a.epoch() + b.displacement_bound() / b.epoch();
}
/// The mean of the leaf sizes of two bodies.
inline double mean_leaf_size(const MovingBody& a, const MovingBody& b) {
  return (a.extent().leaf_size() + b.extent().leaf_size()) / 2;
}

}  // namespace bvlab
