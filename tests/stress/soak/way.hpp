// SPDX-License-Identifier: BSD-3-Clause
/// Two bodies on a long way. Speeds change over six orders of magnitude; there are stops of one
/// body and of both, teleports, and contacts. One body's quaternions have any length; the other's
/// rotation is a product of all the turns so far, never made orthonormal again.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdlib>
#include <random>

#include "hierarchies/geometry/pose.hpp"

namespace bvlab {

/// How many frames a soak lasts: BVLAB_SOAK_FRAMES, or `otherwise`.
inline std::size_t soak_frames(std::size_t otherwise) {
  const char* const text = std::getenv("BVLAB_SOAK_FRAMES");
  return text ? std::strtoul(text, nullptr, 10) : otherwise;
}

class Way {
 public:
  void step() {
    if (left_-- == 0) begin();
    if (happens(0.001)) position_ = Vec3<double>(anywhere(), anywhere(), anywhere());
    if (!first_stops_) {
      first_ = (first_ * small_turn()).normalized();
      position_ = (0.999 * position_ + speed_ * direction()).eval();
    }
    if (!second_stops_) {
      const Eigen::Quaterniond turn = small_turn();
      second_ = second_ * turn;
      second_rotation_ = (turn.toRotationMatrix() * second_rotation_).eval();
    }
  }

  Pose first() const {
    return *pose_from(position_, length_ * first_.w(), length_ * first_.x(), length_ * first_.y(),
                      length_ * first_.z());
  }
  /// Its rotation is a product of matrices.
  Pose second() const { return {second_rotation_, Vec3<double>::Zero()}; }

  /// Both as a trace has them; the second body's quaternion is a product of quaternions.
  std::array<double, 14> values() const {
    const Eigen::Quaterniond q(length_ * first_.coeffs());
    return {position_.x(), position_.y(), position_.z(), q.w(),      q.x(), q.y(), q.z(), 0, 0, 0,
            second_.w(),   second_.x(),   second_.y(),   second_.z()};
  }

 private:
  void begin() {
    left_ = static_cast<int>(std::pow(10, 2.5 * unit_(random_)));
    speed_ = std::pow(10, -6 * unit_(random_));
    first_stops_ = happens(0.25), second_stops_ = happens(0.25);
    length_ = std::pow(10, 6 * unit_(random_) - 3);
  }
  bool happens(double probability) { return unit_(random_) < probability; }
  double anywhere() { return 3 * unit_(random_) - 1.5; }
  Vec3<double> direction() {
    return Vec3<double>(anywhere(), anywhere(), anywhere() + 1e-9).normalized();
  }
  Eigen::Quaterniond small_turn() {
    return Eigen::Quaterniond(Eigen::AngleAxisd(speed_ * unit_(random_), direction()));
  }

  std::mt19937_64 random_{42};
  std::uniform_real_distribution<double> unit_{0, 1};
  Eigen::Quaterniond first_ = Eigen::Quaterniond::Identity(), second_ = first_;
  Mat3<double> second_rotation_ = Mat3<double>::Identity();
  Vec3<double> position_{1, 0, 0};
  double speed_ = 0, length_ = 1;
  bool first_stops_ = false, second_stops_ = false;
  int left_ = 0;
};

}  // namespace bvlab
