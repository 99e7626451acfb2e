// SPDX-License-Identifier: BSD-3-Clause
/// A volume in wide trees of one fan-out and one frame of comparison, as the study of frames sees
/// it while it runs. Every volume in every frame and fan-out takes minutes to compile and is
/// compared by that study alone: they are in the program bvlab_frames, which is built when it is
/// asked for, and in bvlab there are none.
#pragma once

#include <span>
#include <string_view>

#include "experiments/replay/replay.hpp"

namespace bvlab {

/// What is in T = N_u C_u + N_v C_v + ..., in nanoseconds.
struct FrameCosts {
  double begin = 0;  ///< what a pair of bodies needs before its first volume
  double pose = 0;   ///< C_u
  double test = 0;   ///< C_v, of one lane
};

struct FramesEntry {
  std::string_view volume, frame;
  int fan_out;
  /// Touching, every pair from the roots in every frame.
  ReplayResult (*replay)(std::span<const TriangleMesh> meshes, const Trace& trace,
                         const Variant& variant, const ReplayOptions& options);
  /// Timed apart, on what pairs of the first frames meet.
  FrameCosts (*costs)(std::span<const TriangleMesh> meshes, const Trace& trace,
                      const Variant& variant);
};

/// THE list of what was compiled; empty in bvlab.
std::span<const FramesEntry* const> frames_entries();

}  // namespace bvlab
