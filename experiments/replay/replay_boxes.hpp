// SPDX-License-Identifier: BSD-3-Clause
/// A box trace played through one broad-phase method, by name.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "broadphase/settings.hpp"
#include "experiments/files/totals.hpp"

namespace bvlab {

/// Boxes of all frames, one frame after the other; read, not kept.
template <class T>
struct BoxTrace {
  std::size_t frames = 0, boxes = 0;  ///< of each frame
  Boxes<T> all;
  std::string name;  ///< for messages
};

struct BoxReplayOptions {
  std::string method = "auto";
  std::string precision = "exact";
  Coherence coherence = Coherence::on;
  int threads = 1;
  bool keep_pairs = true;  ///< fill `pairs`
  /// Called after every frame; what it throws ends the replay.
  std::function<void(std::size_t frame)> after_frame;
};

struct BoxReplayResult {
  double seconds = 0;        ///< from boxes to pairs, every frame
  double first_seconds = 0;  ///< the first frame of these
  double build_seconds = 0;  ///< making the method
  std::uint64_t overlaps = 0;
  std::string reason;  ///< why the method did what it did, where it has a choice
  std::string scalar;  ///< of the boxes that were compared: float, double
  std::vector<std::array<std::uint32_t, 3>> pairs;  ///< frame, i, j with i < j; sorted
};

/// Throws Unusable for names that there are not.
void check(const BoxReplayOptions& options);

/// Boxes of float64 are rounded outward to float32 where the precision says so. Throws Unusable for
/// unknown names and, naming the trace, the frame and the box, for NaN, infinity and lo > hi.
template <class T>
BoxReplayResult replay_boxes(const BoxTrace<T>& trace, const BoxReplayOptions& options);

template <class T>
Totals totals_of(const BoxReplayResult& result, const BoxTrace<T>& trace,
                 const BoxReplayOptions& options);

}  // namespace bvlab
