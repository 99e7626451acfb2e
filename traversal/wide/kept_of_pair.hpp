// SPDX-License-Identifier: BSD-3-Clause
/// What margins keep of a pair of bodies (wide_margins.hpp).
#pragma once

#include <cstdint>
#include <optional>

#include "traversal/relative_motion_bound.hpp"
#include "traversal/wide/gap_measure.hpp"

namespace bvlab {

/// The last answer. Read in every frame, so it is small and apart from the rest.
struct PairAnswer {
  static constexpr double unknown = -1;

  double until = unknown;  ///< valid below this displacement; negative: while nothing moves
  std::uint32_t epochs = 0;
  bool touching = false;
  bool traversed = false;  ///< a traversal has found it, or a crossing that one has found
};
/// All else that is kept, read where the answer's deadline has passed.
struct KeptOfPair {
  RelativeMotionBound clock;
  double deadline = 0;  ///< by the clock; 0: none
  double distance = 0;
  NodePair touched{};
  WideFront front;
  FrontPause pause;
  std::optional<Crossing> crossing;
  int rest = 0, next_rest = 1;  // number of traversals whose crossing is not kept
  bool was_apart = false, touched_twice = false;
};

}  // namespace bvlab
