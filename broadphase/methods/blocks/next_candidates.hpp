// SPDX-License-Identifier: BSD-3-Clause
/// Finds the candidates for the next horizon in parts, one to three in each frame while the present
/// ones are still valid, since a frame that found all at once would take twice as long as one from
/// scratch. The stages: one for the spatial order; three for fat boxes that hold from the takeover
/// to the end of the next horizon; eight for the join.
#pragma once

#include <span>
#include <vector>

#include "broadphase/methods/blocks/joined_blocks.hpp"

namespace bvlab {

template <class T, class Contact>
class NextCandidates {
 public:
  bool begun() const { return stage_ != 0; }
  bool ready() const { return stage_ > stages; }
  /// The horizon of the candidates being found, in frames.
  int horizon() const { return horizon_; }
  void abandon() { stage_ = 0; }
  /// Starts a search for `horizon` frames, spread over `frames` frames.
  void begin(int horizon, int frames) {
    stage_ = 1, horizon_ = horizon;
    frames_ = frames, frame_ = 0;
  }

  /// Does the stages due in this frame. `order(tree)` writes the indices of the boxes to their
  /// slots, sixteen to a leaf; `fat_box(slot, id)` returns the box's fat box; `fetch(id)`
  /// prefetches what that call will read.
  template <class Order, class FatBox, class Fetch>
  void advance(JoinedBlocks<T, Contact>& joined, const Order& order, const FatBox& fat_box,
               const Fetch& fetch) {
    ++frame_;
    for (; stage_ <= stages * frame_ / frames_; ++stage_)
      if (stage_ == 1)
        order(tree_);
      else if (stage_ <= 1 + fat_parts)
        make_fat_boxes(joined, static_cast<std::uint32_t>(stage_) - 2, fat_box, fetch);
      else
        join(joined, static_cast<std::size_t>(stage_ - 2 - fat_parts));
  }

  BlockTree<T>& tree() { return tree_; }
  LargeVector<Row<T>>& fat_boxes() { return fat_boxes_; }
  PairList& candidates() { return candidates_; }
  /// The number of pairs of leaves visited by the join.
  std::size_t visits() const { return visits_; }

 private:
  static constexpr int fat_parts = 3, joins = 8, stages = 1 + fat_parts + joins;
  static constexpr std::uint32_t stretch =
      16 * block_width;                       ///< leaves that a thread takes at once
  static constexpr std::uint32_t ahead = 16;  ///< slots between a prefetch and its use

  template <class FatBox, class Fetch>
  void make_fat_boxes(JoinedBlocks<T, Contact>& joined, std::uint32_t part, const FatBox& fat_box,
                      const Fetch& fetch) {
    fat_boxes_.resize(tree_.slots());
    const std::uint32_t all = (tree_.leaves() + stretch - 1) / stretch;
    const std::uint32_t begin = all * part / fat_parts, end = all * (part + 1) / fat_parts;
    joined.shares().threads().share(end - begin, [&](std::size_t k, std::size_t) {
      const auto first = (begin + static_cast<std::uint32_t>(k)) * stretch;
      for (std::uint32_t leaf = first; leaf < std::min(first + stretch, tree_.leaves()); ++leaf) {
        for (std::uint32_t slot = leaf * block_width; slot < (leaf + 1) * block_width; ++slot) {
          if (const std::uint32_t later = slot + ahead;
              later < tree_.slots() && tree_.ids(0)[later] != no_box)
            fetch(tree_.ids(0)[later]);
          const std::uint32_t id = tree_.ids(0)[slot];
          const int lane = static_cast<int>(slot % block_width);
          Row<T>& fat = fat_boxes_[slot];
          fat = id == no_box ? nowhere_row<T>() : fat_box(slot, id);
          tree_.leaf(leaf).put(lane, box_of(fat));
        }
        tree_.set_leaf_bounds(leaf, bounds(tree_.leaf(leaf)));
      }
    });
    if (part + 1 < fat_parts) return;
    tree_.refit_above();
    tree_.join_parts(parts_);
    candidates_.clear();
    visits_ = 0;
  }
  void join(JoinedBlocks<T, Contact>& joined, std::size_t part) {
    const std::size_t first = parts_.size() * part / joins,
                      last = parts_.size() * (part + 1) / joins;
    const std::uint32_t* const ids = tree_.ids(0);
    visits_ += joined.template join_parts_into<Closed>(
        tree_, std::span(parts_).subspan(first, last - first), candidates_,
        [ids](Pair* out, std::uint32_t slot, std::uint32_t leaf, LaneMask lanes) {
          const std::uint32_t first_slot = leaf * block_width;
          return write_pairs_by_id(out, slot, ids[slot], first_slot, ids + first_slot, lanes);
        });
  }

  int stage_ = 0, horizon_ = 0, frames_ = 0, frame_ = 0;
  BlockTree<T> tree_;  ///< of the fat boxes
  LargeVector<Row<T>> fat_boxes_;
  PairList candidates_;
  std::vector<typename BlockTree<T>::Part> parts_;
  std::size_t visits_ = 0;
};

}  // namespace bvlab
