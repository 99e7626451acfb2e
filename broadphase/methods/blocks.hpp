// SPDX-License-Identifier: BSD-3-Clause
/// Our own method. From scratch it sorts boxes into spatial order, packs sixteen to a block, and
/// joins the tree of blocks with itself by vector comparisons: O(n) to sort and O(n + k) to join
/// where boxes are alike (JoinedBlocks).
///
/// With coherence, the work depends on what moved since the last frame:
///
/// - nothing moved: the boxes are compared with the last frame's, and the list is kept.
/// - a few moved: the tree is queried for the pairs that *change*, and the list is changed in place
///   (ChangedBlocks). A caller who knows which boxes moved passes them (`update`); others are read
///   only when this begins and when the tree is sorted anew.
/// - moved a little: boxes are *followed* within fat boxes (FollowedBlocks). A frame reads every
///   box once and compares each candidate, in under two nanoseconds in the cache. Fat boxes
///   last for the number of frames that costs least, including the search for the next candidates.
///   Two steps of a sample of the boxes tell before the first such frame whether they keep their
///   motion, and another sample how many candidates there will be.
/// - jumped, moved far, or so many overlap that starting over costs less: from scratch.
///
/// Every choice depends on counts, never on clocks, so the same frames give the same list.
///
/// A frame that begins to follow takes two to four times as long as one from scratch. After the
/// first two, it is begun only where followed frames have saved as much since: at most one in 17
/// frames begins. All others are meant to cost no more than starting over.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>

#include "broadphase/methods/blocks/changed_blocks.hpp"
#include "broadphase/methods/blocks/followed_blocks.hpp"
#include "broadphase/methods/blocks/joined_blocks.hpp"
#include "broadphase/structures/last_frame.hpp"
#include "broadphase/structures/sampled_steps.hpp"

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
      : settings_(settings),
        joined_(settings),
        changed_(joined_, pairs_),
        followed_(settings, joined_, pairs_) {}
  // Not copyable: its parts refer to each other.
  Blocks(const Blocks&) = delete;
  Blocks& operator=(const Blocks&) = delete;

  std::span<const Pair> overlapping(Boxes<T> boxes) { return next_frame(boxes, nullptr); }

  /// As `overlapping`, where only the boxes in `moved` and new ones differ from the last frame;
  /// where these are few, hardly any other box is read. Duplicates and boxes that did not move are
  /// allowed.
  std::span<const Pair> update(Boxes<T> boxes, std::span<const std::uint32_t> moved) {
    return next_frame(boxes, &moved);
  }

  PairChanges changes() const {
    if (settings_.changes == Changes::unreported) return {};
    return {pairs_.began.view(), pairs_.ended.view()};
  }

  /// Why the last frame was answered as it was, for people to read.
  std::string_view reason() const { return reason_; }
  /// The number of classes of size and shape in the last spatial order.
  std::uint32_t classes() const { return joined_.order().classes(); }

 private:
  using Moved = std::span<const std::uint32_t>;

  /// How far a sample of the boxes moved since the last frame, and how large they are.
  struct Motion {
    double extent[3] = {}, step[3] = {};  ///< sums, without those that jumped
    double widest = 0;                    ///< the largest step of them
    std::size_t seen = 0, jumped = 0, moved = 0;
  };

  /// `told`: the indices of the boxes that moved, or null where that is unknown.
  std::span<const Pair> next_frame(Boxes<T> boxes, const Moved* told) {
    pairs_.begin_frame();
    const bool coherent = settings_.coherence == Coherence::on;
    if (!coherent || !advance(boxes, told)) from_scratch(boxes);
    if (changed_.active())
      steps_.forget();  // nor are all boxes read
    else if (coherent)
      steps_.take(boxes);
    count_ = boxes.size();
    return pairs_.all.view();
  }

  void from_scratch(Boxes<T> boxes) {
    balance_ = std::min(balance_ + saved_by_waiting, most_saved);
    stop();
    joined_.from_scratch(boxes, pairs_);
    reason_ = "from scratch: no earlier frame to use, boxes jumped, or too many pairs change";
  }
  /// Stops and forgets everything but the tree and the list.
  void stop() {
    changed_.stop(), followed_.stop();
    last_frame_.forget();
  }

  /// Updates the list to this frame; false where starting from scratch costs less.
  bool advance(Boxes<T> boxes, const Moved* told) {
    if (count_ == 0 || boxes.empty()) return false;
    if (8 * distance(boxes.size(), count_) > boxes.size() + 64) return false;
    if (followed_.active()) return follow(boxes);
    if (changed_.active()) return change(boxes, told);
    if (waiting_ > 0) {
      --waiting_;
      return false;
    }
    // Here the tree holds the boxes of the last frame.
    const Motion motion = sample(boxes);
    if (many_jumped(motion)) return start_over_and_wait();
    if (BlockCosts::few_times * motion.moved <= motion.seen) return begin_to_change(boxes, motion);
    if (boxes.size() != count_) return false;
    const std::optional<bool> steady = steps_.steady(boxes);
    if (!steady) return false;
    followed_.expect(*steady);
    return follow_anew(boxes, *steady ? motion : sample(boxes));
  }
  static std::size_t distance(std::size_t a, std::size_t b) { return a < b ? b - a : a - b; }

  // ---- a few move ---------------------------------------------------------------------------

  bool begin_to_change(Boxes<T> boxes, const Motion& motion) {
    const double moved = static_cast<double>(motion.moved * boxes.size()) /
                         static_cast<double>(std::max<std::size_t>(motion.seen, 1));
    if (changed_.expected_cost() * moved > affordable())
      return changed_.decay_expected_cost(), start_over_and_wait();
    changed_.begin(count_);
    return change(boxes, nullptr);
  }
  bool change(Boxes<T> boxes, const Moved* told) {
    if (told) {
      if (last_frame_.known()) last_frame_.take_over(boxes, *told);
      return change_moved(boxes, *told);
    }
    moved_.clear();
    if (last_frame_.known()) {
      last_frame_.find_moved(boxes, boxes.size() / BlockCosts::few_times, moved_);
    } else {
      for (std::uint32_t id = 0; id < std::min(boxes.size(), count_); ++id)
        if (!(boxes[id] == changed_.last(id))) moved_.push_back(id);
      last_frame_.remember(boxes);
    }
    return change_moved(boxes, moved_);
  }
  bool change_moved(Boxes<T> boxes, Moved moved) {
    if (moved.empty() && boxes.size() == count_) {
      reason_ = "kept: nothing moved";
      return true;
    }
    if (BlockCosts::few_times * moved.size() > boxes.size()) {
      changed_.stop(), last_frame_.forget();
      return boxes.size() == count_ && follow_anew(boxes, sample(boxes));
    }
    if (!changed_.update(boxes, moved, affordable())) return start_over_and_wait();
    wait_ = 0;
    reason_ = changed_.sorted() ? "changed: few moved, only they were queried; sorted anew"
                                : "changed: few moved, only they were queried";
    return true;
  }

  /// The most that an update may cost to be preferred to starting over.
  double affordable() const { return 0.7 * cost_of_starting_over(); }
  double cost_of_starting_over() const {
    using Cost = BlockCosts;
    const double pair = Cost::pair + (settings_.changes == Changes::reported ? Cost::report : 0);
    return Cost::sort * static_cast<double>(count_) +
           Cost::visit * static_cast<double>(joined_.visits()) +
           pair * static_cast<double>(pairs_.all.size());
  }

  // ---- most move ----------------------------------------------------------------------------

  bool follow(Boxes<T> boxes) {
    if (boxes.size() != count_ && followed_.overgrown()) return false;
    if (boxes.size() != count_ || followed_.candidates_valid()) {
      if (boxes.size() == count_ && followed_.time_to_prepare())
        followed_.prepare(
            followed_.nearly_still()
                ? followed_.shortest
                : best_horizon(sample(boxes),
                               {followed_.candidates(), static_cast<double>(followed_.horizon())},
                               followed_.time_to_find()));
      if (!followed_.follow(boxes)) return false;
      balance_ = std::min(balance_ + saved_by_following, most_saved);
      reason_ = followed_.took_over() ? "followed: candidates are compared, the next took over"
                                      : "followed: candidates are compared";
      if (followed_.few_moved() > 1) {
        followed_.stop_with_boxes();
        changed_.begin(boxes.size());
      }
      return true;
    }
    const Motion motion = sample(boxes);
    return many_jumped(motion) ? start_over_and_wait() : follow_anew(boxes, motion);
  }
  bool follow_anew(Boxes<T> boxes, const Motion& motion) {
    if (many_jumped(motion)) return start_over_and_wait();
    if (balance_ < 0) return start_over_and_wait();
    // At least as many candidates as the pairs suggest; a sample costs time, too.
    const Candidates fewest{static_cast<double>(pairs_.all.size()), -0.5};
    const int horizon = best_horizon(motion, fewest) == 0
                            ? 0
                            : best_horizon(motion, sample_candidates(boxes, motion));
    if (horizon == 0) return start_over_and_wait();
    balance_ -= cost_of_beginning;
    wait_ = 0;
    if (followed_.active()) {
      if (!followed_.begin_again(boxes, horizon)) return false;
    } else {
      followed_.begin(boxes, horizon);
    }
    reason_ = "followed: new candidates for the frames to come";
    return true;
  }
  /// Sampling the motion costs time, too: each time it leads to nothing, the number of frames until
  /// the next sample grows, up to seven.
  bool start_over_and_wait() {
    waiting_ = wait_ = std::min(7, 2 * wait_ + 1);
    return false;
  }

  /// Boxes that jumped lie in the wrong leaves; up to this many barely affect the tree.
  bool many_jumped(const Motion& motion) const {
    const double share = static_cast<double>(motion.jumped) /
                         static_cast<double>(std::max<std::size_t>(motion.seen, 1));
    return share * static_cast<double>(count_) > static_cast<double>(count_) / 100 + 32;
  }

  Motion sample(Boxes<T> boxes) const {
    Motion motion;
    joined_.tree().sample(16, [&](std::uint32_t slot, std::uint32_t id) {
      if (id >= boxes.size()) return;
      const Row<T> now = row_of(boxes[id]), was = followed_.last_row(slot);
      ++motion.seen;
      motion.moved += !same(now, was);
      if (joined_.jumped(now, was)) {
        ++motion.jumped;
        return;
      }
      const auto widest = static_cast<double>(largest_change(now, was));
      motion.widest = std::max(motion.widest, widest);
      for (int axis = 0; axis < 3; ++axis) {
        motion.extent[axis] += static_cast<double>(now.hi[axis] - now.lo[axis]);
        const double low = static_cast<double>(was.lo[axis] - now.lo[axis]),
                     high = static_cast<double>(now.hi[axis] - was.hi[axis]);
        motion.step[axis] +=
            followed_.steady() ? std::max(low, 0.0) + std::max(high, 0.0) : 2 * widest;
      }
    });
    return motion;
  }
  /// So many candidates for fat boxes of so many frames; -0.5: the boxes themselves.
  struct Candidates {
    double count, frames;
  };
  /// About how many candidates the shortest horizon would have, from a sample of the boxes.
  Candidates sample_candidates(Boxes<T> boxes, const Motion& motion) const {
    const BlockTree<T>& tree = joined_.tree();
    constexpr int frames = FollowedBlocks<T, Contact>::shortest;
    const auto fat_box = [&](std::uint32_t slot) {
      return followed_.fat_box_of(row_of(boxes[tree.ids(0)[slot]]), followed_.last_row(slot),
                                  frames);
    };
    const T reach = static_cast<T>(motion.widest * frames);
    std::size_t seen = 0, found = 0;
    tree.sample(4, [&](std::uint32_t slot, std::uint32_t) {
      ++seen;
      const Row<T> fat = fat_box(slot);
      const Box<T> around = box_of(Row<T>{fat.lo - reach, fat.hi + reach});
      tree.find(around, [&](std::uint32_t leaf) {
        for (LaneMask lanes = overlapping_lanes<Closed>(tree.leaf(leaf), around); lanes;
             lanes &= lanes - 1) {
          const std::uint32_t other = leaf * block_width + std::countr_zero(lanes);
          found += other != slot && overlap<Closed>(fat, fat_box(other));
        }
      });
    });
    return {static_cast<double>(found * count_) /
                static_cast<double>(std::max<std::size_t>(2 * seen, 1)),
            frames};
  }

  /// The best horizon in frames; 0 where starting over costs less. `ahead`: the number of frames in
  /// which its candidates are found; each of these frames must cost less than starting over.
  int best_horizon(const Motion& motion, const Candidates& known, int ahead = 0) const {
    using Cost = BlockCosts;
    const double n = static_cast<double>(count_);
    const double join = Cost::visit * static_cast<double>(joined_.visits());
    // How much larger fat boxes are than boxes.
    const auto growth = [&](double frames) {
      double product = 1;
      for (int axis = 0; axis < 3; ++axis)
        if (motion.extent[axis] > 0)
          product *= 1 + (frames + 0.5) * motion.step[axis] / motion.extent[axis];
      return product;
    };
    double best = 0.8 * cost_of_starting_over();
    int horizon = 0;
    const double most = best;
    const int shortest = followed_.shortest;
    for (int frames = shortest; frames <= followed_.longest(); frames *= 2) {
      const double larger = growth(frames + ahead),
                   candidates = known.count * larger / growth(known.frames);
      const double follow = Cost::read * n + Cost::test(candidates) * candidates,
                   begin =
                       Cost::fat_box * n + (1 + larger) / 2 * join + Cost::candidate * candidates,
                   cost = follow + begin / frames;
      if (ahead > 0 && follow + begin / ahead > cost_of_starting_over()) continue;
      // The shortest horizon leaves no frames to prepare the next candidates in, so any longer one
      // that is affordable is preferred.
      const bool any_longer = followed_.margins_exceeded() && horizon == shortest;
      if (cost < (any_longer ? most : best)) best = cost, horizon = frames;
    }
    return horizon;
  }

  MethodSettings settings_;
  std::size_t count_ = 0;  ///< boxes of the last frame
  std::string_view reason_;
  ReportedPairs pairs_;
  LastFrame<T> last_frame_;
  JoinedBlocks<T, Contact> joined_;
  ChangedBlocks<T, Contact> changed_;
  FollowedBlocks<T, Contact> followed_;
  std::vector<std::uint32_t> moved_;
  int wait_ = 0;     ///< length of the last pause, in frames that start over without sampling
  int waiting_ = 0;  ///< frames left of it
  SampledSteps<T> steps_;
  /// What following has saved, less what its beginnings cost, in frames from scratch. A frame that
  /// is followed counts for an eighth, a quarter of what it saves, so that beginnings are rare; and
  /// since motion changes, waiting pays one back in 128 frames.
  static constexpr double cost_of_beginning = 2, saved_by_following = 0.125,
                          saved_by_waiting = 1.0 / 64, most_saved = 4;
  double balance_ = cost_of_beginning;
};

}  // namespace bvlab
