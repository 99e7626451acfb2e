// SPDX-License-Identifier: BSD-3-Clause
/// What each strategy would cost on a trace: from recursions in every frame, and from what the
/// strategy makes, in some windows, of the front that a recursion leaves there.
///
/// Recursion is counted and timed in every frame. Windows are `window` frames long, one in every
/// `stride` frames, about: the first begins with the trace, each of the others anywhere in its
/// part, so that no period of the motion is met in the same place every time. In the first frame of
/// a window each strategy knows nothing and recurses; in the others it goes on by its own rules
/// from the front that this left, entries opened, raised and rebuilt included. A window is played
/// twice: once counted, and once timed, since counting takes time (up to as much as what is
/// counted).
///
/// In a run the a-th frame has a strategy of age a. In its first `window` frames it is taken to
/// make as many tests for one of the recursion's as it did at that age, all windows together; in
/// all others
///
///     mean + b (recursion's tests - their mean in the windows),
///
/// with the mean, and the slope b by least squares (at least 0, at most mean over mean), of the
/// second halves of the windows (the regression estimator of survey sampling). Seconds are
/// extended as tests are, beside what recursion's tests cost at the unit costs of `Adaptive`. A
/// trace that one window covers is predicted exactly. What is left out is how a strategy goes on to
/// age after a window's length: lists that nothing makes shorter (violent motion) are predicted too
/// short. Where bodies stay about a place and yes or no is asked, the witnesses they find get
/// better for longer than that: of twelve such motions, witness, margins, by-cost and raise were
/// predicted 1.3, 1.3, 1.5 and 1.9 times too dear in the mean, raise 2.9 times at most. Counts of
/// margins scatter most: those of contacts by 6 % (one standard deviation), of lists by 0.5 %.
///
/// A trace of fewer than four strides is played as a whole, as one window: that is no more work
/// than a longer one takes, and its counts are exact.
///
/// The interval beside the seconds is 20 % each way (a run repeats itself to about that on a
/// machine with other work), and what leaving out one window after the other says (the jackknife,
/// with Student's t for 95 %), and as much as times still grew or fell in the second halves of
/// windows, on the frames that none covers. What is said here was rehearsed on motions of 600
/// frames (walks of five kinds, two and six bunnies of 500, boxes and spheres, yes or no and
/// contacts, eight strategies): the interval held 305 of 320 times that strategies took where it
/// was chosen, and 311 of 320 on another seed, and was 46 % each way (median). So it seldom tells
/// one strategy from all others: there 6.7 of the eight stayed candidates, the fastest always among
/// them. `predict_coverage` beside this file measures that of the program: on 40 other motions of
/// that kind (seed 901, a busy machine, processor time) 312 of 320 were held, of recursion's, which
/// is 20 % each way, 35 of 40; it was 56 % each way (median), and 7.3 of the eight stayed.
/// Of fewer than four windows that do not cover the trace nothing is told.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "experiments/replay/replay.hpp"

namespace bvlab {

struct Predicted {
  std::string_view strategy;
  double n_v = 0;            ///< pairs of volumes tested, all frames and pairs
  double n_p = 0;            ///< pairs of triangles
  double seconds = 0;        ///< as measured here; n_v and n_p are the same every time
  double low = 0, high = 0;  ///< of the seconds, see above
  std::size_t windows = 0;   ///< that it stands on; 0 where there is nothing to tell
  bool is_played = false;    ///< one window is the whole trace
};

struct PredictOptions {
  std::size_t stride = 96;
  std::size_t window = 48;
  /// Called now and then; what it throws ends the work.
  std::function<void()> waiting = [] {};
};

/// Windows of which an interval is told, at least.
inline constexpr std::size_t least_windows = 4;

/// What is looked at unless somebody says so: all of a short trace.
PredictOptions options_for(std::size_t frames);

/// For the variant's volume, query, tree (fan-out and frame), build and leaf size; its strategy
/// does not matter. Every strategy that was compiled, in the order of the list; recursion's counts
/// are exact. Throws Unusable without the strategy `recursive`, and for kernels of sixteen lanes,
/// of which every strategy but two is missing: replays tell what they cost.
std::vector<Predicted> predict(std::span<const TriangleMesh> meshes, const Trace& trace,
                               const Variant& variant, const PredictOptions& options);
std::vector<Predicted> predict(std::span<const TriangleMesh> meshes, const Trace& trace,
                               const Variant& variant);

/// Why nothing can be told of that trace, whatever its windows: "there are no frames"; else empty.
std::string_view nothing_to_tell(const Trace& trace);

/// Whether the windows are enough for intervals.
bool can_tell(std::span<const Predicted> predicted);

/// Those that may be the fastest, the fewest seconds first: of whose interval the low end is below
/// the high end of the first one's. One alone is the fastest; where nothing can be told, all.
std::vector<std::string_view> candidates(std::span<const Predicted> predicted);

}  // namespace bvlab
