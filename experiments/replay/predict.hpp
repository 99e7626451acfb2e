// SPDX-License-Identifier: BSD-3-Clause
/// What each strategy would cost on a trace, without playing it: from recursions in every frame,
/// and from what the strategy makes, in some windows, of the front that a recursion leaves there.
///
/// Recursion is counted in every frame. A window begins in every `stride`-th frame, about, and is
/// `window` frames long. In its first frame each strategy knows nothing and recurses; in the others
/// it goes on by its own rules from the front that this left, entries opened, raised and rebuilt
/// included. That takes window / stride of playing every strategy, and recursion once.
///
/// In a run the a-th frame has a strategy of age a. In its first `window` frames it is taken to
/// make as many tests for one of the recursion's as it did at that age, all windows together; in
/// all others
///
///     mean + b (recursion's tests - their mean in the windows),
///
/// with the mean, and the slope b by least squares (at least 0, at most mean over mean), of the
/// second halves of the windows (the regression estimator of survey sampling). A trace that one
/// window covers is predicted exactly. What is left out is how a strategy goes on to age after a
/// window's length: lists that nothing makes shorter (violent motion) are predicted too short, and
/// where bodies stay about a place and yes or no is asked, by-cost and raise up to twice too dear,
/// since the witnesses they find get better for longer than that.
///
/// Seconds are predicted tests at the unit costs of `Adaptive`, times what the windows' frames took
/// beside that: the median over frames, weighted by their cost, so that a frame in which the
/// machine did something else does not count.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "experiments/replay/replay.hpp"

namespace bvlab {

struct Predicted {
  std::string_view strategy;
  double n_v = 0;      ///< pairs of volumes tested, all frames and pairs
  double n_p = 0;      ///< pairs of triangles
  double seconds = 0;  ///< as measured here; n_v and n_p are the same every time
};

struct PredictOptions {
  std::size_t stride = 96;
  std::size_t window = 48;
};

/// For the variant's volume, query (touching or contacts), build and leaf size, in binary trees;
/// its strategy does not matter. In the order recursive, recursive-both, separation-list, deferred,
/// by-cost, raise, margins. Recursion's counts are exact.
std::vector<Predicted> predict(std::span<const TriangleMesh> meshes, const Trace& trace,
                               const Variant& variant, const PredictOptions& options = {});

/// The one that takes the fewest seconds. Of an empty list none.
std::string_view fastest(std::span<const Predicted> predicted);

}  // namespace bvlab
