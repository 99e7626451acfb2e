// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>

#include "experiments/scenes/trace.hpp"

namespace bvlab {

void Trace::poses(std::size_t frame, std::span<Pose> poses) const {
  const double* v = values.data() + frame * objects * 7;
  for (std::size_t i = 0; i < objects; ++i, v += 7)
    poses[i] = *pose_from({v[0], v[1], v[2]}, v[3], v[4], v[5], v[6]);
}

std::span<const Pose> PosesInTurn::at(std::size_t frame) {
  const std::size_t length = 7 * trace_.objects;
  const double* v = trace_.values.data() + frame * length;
  const double* before = frame_ ? trace_.values.data() + *frame_ * length : nullptr;
  for (std::size_t i = 0; i < trace_.objects; ++i, v += 7) {
    if (before && std::memcmp(v, before + 7 * i, 7 * sizeof *v) == 0) continue;
    poses_[i] = *pose_from({v[0], v[1], v[2]}, v[3], v[4], v[5], v[6]);
  }
  frame_ = frame;
  return poses_;
}

}  // namespace bvlab
