// SPDX-License-Identifier: BSD-3-Clause
/// A replay frame by frame: what of it does not depend on volume, strategy and query.
#pragma once

#include <chrono>

#include "experiments/replay/replay.hpp"

namespace bvlab {

using Clock = std::chrono::steady_clock;
inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

namespace detail {

/// An engine that is asked all pairs in each frame of a trace.
class Player {
 public:
  virtual ~Player() = default;
  virtual void play(std::size_t frame) = 0;
  /// Adds what was counted.
  virtual void finish() = 0;
};

/// Whether a broad phase saves more than it costs, and nothing asked for needs every pair's tests.
bool broad_phase_pays(const Trace& trace, const ReplayOptions& options);

/// Plays and times all frames; then puts in order what they found.
void play_frames(Player& player, const Trace& trace, const ReplayOptions& options,
                 ReplayResult& result);

}  // namespace detail

}  // namespace bvlab
