// SPDX-License-Identifier: BSD-3-Clause
/// The state that WideMargins keeps for each pair of bodies: the last answer and until when it is
/// valid (PairAnswer), and what is needed to renew it (KeptOfPair).
#pragma once

#include <cstdint>
#include <optional>

#include "traversal/lasting_answer.hpp"
#include "traversal/queries/candidate.hpp"
#include "traversal/wide/front_record.hpp"

namespace bvlab {

/// The last answer. Read in every frame, so it is small and apart from the rest.
struct PairAnswer {
  static constexpr double unknown = -1;

  double until = unknown;    ///< valid while displacements sum to less; negative: none is known
  std::uint32_t epochs = 0;  ///< sum of both bodies' epochs then; the same until one moves
  bool touching = false;
};
/// All else that is kept, read where the answer has expired by PairAnswer::until.
struct KeptOfPair {
  LastingAnswer lasting;
  NearestTriangles nearest;         ///< the last answer, where a distance is sought
  std::optional<NodePair> touched;  ///< FrontRecord::touched of the last traversal that had one
  WideFront front;
  FrontPause pause, verdicts_pause;
  std::optional<Crossing> crossing;
  int crossing_pause = 0;       ///< traversals left in which no crossing is kept
  int next_crossing_pause = 1;  ///< the length of the next such pause
  bool known = false;           ///< the bodies were traversed, or a direction has separated them
  bool was_apart = false, touched_twice = false;
};

}  // namespace bvlab
