// SPDX-License-Identifier: BSD-3-Clause
/// The candidates that follow those in use, found a part in each frame while these are still good:
/// a frame that makes all of them at once takes twice as long as one from scratch. First an order;
/// then, in three parts, fat boxes for the frames until they take over and those after; then, in
/// eight, the join.
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
  /// For how many frames they are going to be good.
  int horizon() const { return horizon_; }
  void abandon() { stage_ = 0; }
  /// `frames`: that it may take.
  void begin(int horizon, int frames) {
    stage_ = 1, horizon_ = horizon;
    frames_ = frames, frame_ = 0;
  }

  /// The next frame's parts of the work, whatever they are. `order()`: the indices of the boxes in
  /// their slots, sixteen to a leaf; `fat_box(slot, id)`: where that box may go until they end;
  /// `fetch(id)`: is going to be asked that.
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

  /// Has the memory come that it will need for about so many.
  void reserve(std::uint32_t leaves, std::size_t candidates) {
    tree_.resize_leaves(leaves);
    fat_boxes_.resize(tree_.slots());
    // The join asks for some room beyond what it is going to need.
    candidates_.clear();
    candidates_.room_for(candidates + candidates / 8 + 16 * 256);
  }

  BlockTree<T>& tree() { return tree_; }
  LargeVector<Row<T>>& fat_boxes() { return fat_boxes_; }
  PairList& candidates() { return candidates_; }
  /// Pairs of leaves that the join visited.
  std::size_t visits() const { return visits_; }

  std::size_t bytes() const {
    return tree_.bytes() + fat_boxes_.capacity() * sizeof(Row<T>) +
           candidates_.capacity() * sizeof(Pair);
  }

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
