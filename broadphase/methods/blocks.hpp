// SPDX-License-Identifier: BSD-3-Clause
/// Our own method. From scratch: boxes in spatial order, sixteen to a block, the tree of blocks
/// joined with itself by vector comparisons; O(n) to sort and O(n + k) to join where boxes are
/// alike (JoinedBlocks).
///
/// With coherence, what is done follows what moved:
///
/// - nothing moved: the boxes are compared with the last frame's, and the list stands.
/// - moved steadily: *followed* within fat boxes (FollowedBlocks). A frame costs one look at every
///   box and under two nanoseconds a candidate, in the cache. For how many frames fat boxes are
///   made is chosen so that those frames and making the next candidates cost least together.
/// - a few moved: the same, but only their candidates are compared, and the list is changed in
///   place: the cost follows the number of boxes that moved, and of changes.
/// - moved far: *refitted*. The tree's bounds are computed again and joined as from scratch.
/// - jumped: from scratch.
///
/// Every choice is made from counts, never from clocks, so the same frames give the same list.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>

#include "broadphase/methods/blocks/followed_blocks.hpp"
#include "broadphase/methods/blocks/joined_blocks.hpp"

namespace bvlab {

template <class T, class Contact>
class Blocks {
 public:
  using Scalar = T;
  static constexpr std::string_view name = "blocks";
  static constexpr std::string_view description =
      "our own: blocks of sixteen neighbours joined by vector comparisons, then followed as they "
      "move";

  explicit Blocks(const MethodSettings& settings)
      : settings_(settings), joined_(settings), followed_(settings, joined_, pairs_, last_frame_) {}
  // Its parts refer to each other.
  Blocks(const Blocks&) = delete;
  Blocks& operator=(const Blocks&) = delete;

  std::span<const Pair> overlapping(Boxes<T> boxes) {
    pairs_.begin_frame();
    if (settings_.coherence == Coherence::off || !advance(boxes)) from_scratch(boxes);
    count_ = boxes.size();
    return pairs_.all.view();
  }

  PairChanges changes() const { return {pairs_.began.view(), pairs_.ended.view()}; }

  /// What the last frame was answered by.
  std::string_view reason() const { return reason_; }
  /// Into how many classes of size and shape boxes were last sorted.
  std::uint32_t classes() const { return joined_.order().classes(); }

  std::size_t bytes() const {
    return joined_.bytes() + followed_.bytes() + pairs_.bytes() + last_frame_.bytes();
  }

 private:
  void from_scratch(Boxes<T> boxes) {
    joined_.from_scratch(boxes, pairs_);
    followed_.stop();
    last_frame_.forget();
    reason_ = "from scratch: no earlier frame to use, or boxes jumped";
  }

  /// Brings the answer of the last frame up to this one; false where from scratch is better.
  bool advance(Boxes<T> boxes) {
    if (count_ == 0 || boxes.empty()) return false;
    const bool followed = followed_.active(), resized = boxes.size() != count_;
    if (resized && (!followed || 8 * distance(boxes.size(), count_) > boxes.size() + 64))
      return false;
    if (!resized && last_frame_.same(boxes)) return kept();
    if (followed && (resized || followed_.goes_on())) {
      if (!followed_.follow(boxes)) return false;
      return compared();
    }
    if (!followed && waiting_ > 0) {
      --waiting_;
      return false;
    }
    const Motion motion = sample(boxes);
    if (2 * motion.jumped > motion.seen) return in_vain();
    if (motion.moved == 0 && !followed && unmoved(boxes)) {
      last_frame_.remember(boxes);
      return kept();
    }
    const int horizon = best_horizon(motion);
    if (horizon == 0) return refit(boxes) || in_vain();
    wait_ = 0;
    if (followed) {
      if (!followed_.begin_again(boxes, horizon)) return false;
    } else {
      followed_.begin(boxes, horizon);
    }
    reason_ = "followed: new candidates for the frames to come";
    return true;
  }
  static std::size_t distance(std::size_t a, std::size_t b) { return a < b ? b - a : a - b; }

  bool kept() {
    reason_ = "kept: nothing moved";
    return true;
  }
  bool compared() {
    reason_ = followed_.compared_few() ? "followed: few moved, only theirs are compared"
                                       : "followed: candidates are compared";
    return true;
  }
  bool refit(Boxes<T> boxes) {
    if (!joined_.refit(boxes, pairs_)) return false;
    followed_.stop();
    last_frame_.forget();
    reason_ = "refitted: boxes move too far to be followed";
    return true;
  }

  /// Looking at how boxes moved costs something, too: the more often it led to nothing, the longer
  /// it is left alone, up to seven frames.
  bool in_vain() {
    waiting_ = wait_ = std::min(7, 2 * wait_ + 1);
    return false;
  }

  /// How a sample of the boxes moved since the last frame, beside how large they are.
  struct Motion {
    double extent[3] = {}, step[3] = {};  ///< sums, without those that jumped
    std::size_t seen = 0, jumped = 0, moved = 0;
  };

  Motion sample(Boxes<T> boxes) const {
    Motion motion;
    const BlockTree<T>& tree = joined_.tree();
    const std::uint32_t stride = std::max<std::uint32_t>(1, tree.leaves() / 32);
    for (std::uint32_t k = 0; k < tree.leaves(); k += stride)
      for (std::uint32_t slot = k * block_width; slot < (k + 1) * block_width; ++slot) {
        const std::uint32_t id = tree.ids(0)[slot];
        if (id == no_box || id >= boxes.size()) continue;
        const Row<T> now = row_of(boxes[id]), was = followed_.last_row(slot);
        ++motion.seen;
        motion.moved += !same(now, was);
        if (joined_.jumped(now, was)) {
          ++motion.jumped;
          continue;
        }
        for (int axis = 0; axis < 3; ++axis) {
          motion.extent[axis] += static_cast<double>(now.hi[axis] - now.lo[axis]);
          const double low = static_cast<double>(was.lo[axis] - now.lo[axis]),
                       high = static_cast<double>(now.hi[axis] - was.hi[axis]);
          motion.step[axis] += followed_.steady() ? std::max(low, 0.0) + std::max(high, 0.0)
                                                  : std::abs(low) + std::abs(high);
        }
      }
    return motion;
  }
  bool unmoved(Boxes<T> boxes) const {
    const BlockTree<T>& tree = joined_.tree();
    for (std::uint32_t slot = 0; slot < tree.slots(); ++slot)
      if (const std::uint32_t id = tree.ids(0)[slot];
          id != no_box && !same(row_of(boxes[id]), followed_.last_row(slot)))
        return false;
    return true;
  }

  /// For how many frames fat boxes are best made; 0 where starting over costs less.
  int best_horizon(const Motion& motion) const {
    using Cost = BlockCosts;
    const double n = static_cast<double>(count_), k = static_cast<double>(pairs_.all.size());
    const double join = Cost::visit * static_cast<double>(joined_.fresh_visits());
    double best = 0.9 * (Cost::sort * n + join + Cost::pair * k);
    int horizon = 0;
    for (int frames = 1; frames <= followed_.longest(); frames *= 2) {
      double growth = 1;
      for (int axis = 0; axis < 3; ++axis)
        if (motion.extent[axis] > 0)
          growth *= 1 + (frames + 0.5) * motion.step[axis] / motion.extent[axis];
      const double candidates = growth * k;
      const double cost =
          Cost::look * n + Cost::test * candidates +
          (Cost::fat_box * n + (1 + growth) / 2 * join + Cost::candidate * candidates) / frames;
      if (cost < best) best = cost, horizon = frames;
    }
    return horizon;
  }

  MethodSettings settings_;
  std::size_t count_ = 0;  ///< boxes of the last frame
  std::string_view reason_;
  ReportedPairs pairs_;
  LastFrame<T> last_frame_;
  JoinedBlocks<T, Contact> joined_;
  FollowedBlocks<T, Contact> followed_;
  int wait_ = 0, waiting_ = 0;  ///< frames to start over without asking
};

}  // namespace bvlab
