// SPDX-License-Identifier: BSD-3-Clause
/// When margins pause. Where bodies are fast, hardly any answer outlasts a frame, and what margins
/// measure and keep is wasted: up to a seventh of the time. If in six frames or more, and in a
/// hundred traversals or more, less than one in twenty was spared by what was kept, traversals
/// start from the roots for 32 frames, or 64 if a full pause came before. Few pairs therefore pause
/// rarely: in a few frames nothing may be spared by chance. A pause ends early when the bodies have
/// slowed down to half their motion at its begin, or when a quarter more of the pairs are decided
/// without a traversal.
#pragma once

#include <cstddef>

namespace bvlab {

/// What became of the pairs in a frame.
struct FrameOfPairs {
  std::size_t queried = 0;
  std::size_t traversed = 0;
  std::size_t spared =
      0;              ///< traversals that were shortened by what was kept (GapMeasure::spared),
                      ///< or not needed, since the last one's answer was kept
  double motion = 0;  ///< mean motion of a moved body, in any measure; used in pauses alone

  /// Adds the counts, not the motion.
  void add(const FrameOfPairs& other) {
    queried += other.queried, traversed += other.traversed, spared += other.spared;
  }
};

class MarginPause {
 public:
  bool active() const { return remaining_ > 0; }

  /// A frame is over; the next one begins. Returns whether a pause begins with it.
  bool next(const FrameOfPairs& last) {
    if (active()) {
      watch_pause(last);
      return false;
    }
    if (++age_ <= uncounted) return false;
    counted_.add(last);
    if (age_ < uncounted + counted) return false;
    const std::size_t traversals = counted_.traversed + counted_.spared;
    const bool useless = few * counted_.spared < traversals;
    if (useless && traversals < enough) return false;
    counted_ = {}, age_ = useless ? 0 : uncounted;
    remaining_ = useless ? length_ : 0;
    length_ = useless ? longest : shortest;
    return useless;
  }
  /// Starts watching anew, without a pause.
  void restart() { *this = {}; }

 private:
  static constexpr int uncounted = 2, counted = 6;  // frames
  static constexpr int shortest = 32, longest = 64;
  static constexpr std::size_t few = 20, enough = 100;

  void watch_pause(const FrameOfPairs& last) {
    --remaining_;
    // In the first frame of a pause a body may seem to have moved for several.
    if (++age_ < 2) return;
    if (age_ == 2) {
      first_ = last;
    } else if (2 * last.motion < first_.motion ||
               last.traversed + last.queried / 4 < first_.traversed) {
      remaining_ = 0;
      length_ = shortest;
    }
    if (remaining_ == 0) age_ = 0, counted_ = {};
  }

  FrameOfPairs counted_, first_;  // since watching began; in the second frame of a pause
  int age_ = 0;                   // frames since watching, or the pause, began
  int remaining_ = 0, length_ = shortest;
};

}  // namespace bvlab
