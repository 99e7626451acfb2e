// SPDX-License-Identifier: BSD-3-Clause
/// Bounds on the motion of many bodies since their first frames, in arrays: a frame reads those of
/// every pair of bodies, so they lie side by side. See moving_body.hpp for the bounds of one body.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "traversal/moving_body.hpp"
#include "traversal/shape.hpp"

namespace bvlab {

class FollowedBodies {
  class Followed : public MovingBody {
   public:
    using MovingBody::MovingBody;
    bool set_pose(const Pose& pose) { return MovingBody::set_pose(pose, Vec3<double>::Zero()); }
  };

 public:
  void add(const HierarchyExtent& extent) {
    bodies_.emplace_back(extent);
    displacements_.push_back(0), steps_.push_back(0), rotations_.push_back(0), epochs_.push_back(0);
  }
  MovingBody& operator[](std::size_t i) { return bodies_[i]; }

  /// Moves body i to `pose`, and updates its bounds. Returns whether it was elsewhere.
  bool set_pose(std::size_t i, const Pose& pose) {
    Followed& body = bodies_[i];
    steps_[i] = 0;
    if (!body.set_pose(pose)) return false;
    const double displacement = body.displacement_bound();
    steps_[i] = displacement - displacements_[i];
    displacements_[i] = displacement, rotations_[i] = body.rotation_bound();
    epochs_[i] = body.epoch();
    return true;
  }
  /// Body i has not moved since the last frame.
  void rest(std::size_t i) { steps_[i] = 0; }

  /// The displacement bounds of both bodies, summed.
  double displacement(const ObjectPair& pair) const { return sum(displacements_, pair); }
  /// By how much that sum has grown since the last frame.
  double step(const ObjectPair& pair) const { return sum(steps_, pair); }
  /// The rotation bounds of both bodies, summed.
  double rotation(const ObjectPair& pair) const { return sum(rotations_, pair); }
  /// Changes whenever one of the bodies moves.
  std::uint32_t epochs(const ObjectPair& pair) const { return sum(epochs_, pair); }

 private:
  template <class T>
  static T sum(const std::vector<T>& of, const ObjectPair& pair) {
    return of[pair.i] + of[pair.j];
  }

  std::vector<Followed> bodies_;
  std::vector<double> displacements_, steps_, rotations_;
  std::vector<std::uint32_t> epochs_;
};

}  // namespace bvlab
