// SPDX-License-Identifier: BSD-3-Clause
/// Updates the list of pairs while few boxes move, at a cost in proportion to the changes. The tree
/// holds the current boxes. Each box that moved queries it once, with the box that encloses its old
/// and new place, and is compared with every leaf found, in both places: lanes in which the two
/// answers differ are pairs that began or ended. The list is changed in place, and bounds above
/// moved boxes are refitted. A box that jumped or is new gets a new slot, where no box was before.
///
/// O(log n + k) per moved box, while leaves are as tight as after sorting; another 1 ns per box to
/// find out which ones moved, unless the caller passes them.
#pragma once

#include <algorithm>
#include <vector>

#include "broadphase/methods/blocks/joined_blocks.hpp"
#include "broadphase/structures/pair_places.hpp"

namespace bvlab {

template <class T, class Contact>
class ChangedBlocks {
 public:
  /// `joined`: holds the tree of the boxes; `pairs`: the list to change. Both must outlive this
  /// object.
  ChangedBlocks(JoinedBlocks<T, Contact>& joined, ReportedPairs& pairs)
      : joined_(joined), tree_(joined.tree()), pairs_(pairs) {}

  bool active() const { return active_; }
  void stop() { active_ = placed_ = false; }

  /// Starts from the tree and list of the last frame, which had `boxes` boxes.
  void begin(std::size_t boxes) {
    count_ = boxes;
    index_slots();
    placed_ = false, active_ = true;
    leaves_per_query_when_sorted_ = 0, leaves_found_ = queries_ = 0;
  }

  /// The box with index `id` as it was in the last frame.
  Box<T> last(std::uint32_t id) const {
    return tree_.leaf(slots_[id] / block_width).box(static_cast<int>(slots_[id] % block_width));
  }

  /// Expected cost per moved box in units of BlockCosts; 0 where none was measured.
  double expected_cost() const { return expected_cost_; }
  /// Lowers the expected cost, so that an old measurement does not hold for ever.
  void decay_expected_cost() { expected_cost_ *= 0.9; }

  /// Updates the list to `boxes`, which may differ from the last frame in the boxes of `moved`, in
  /// new ones and in those that are gone. Returns false, and becomes inactive, where that would
  /// cost more than `affordable`; the tree must then be built anew.
  bool update(Boxes<T> boxes, std::span<const std::uint32_t> moved, double affordable) {
    inserted_.clear(), emptied_.clear(), was_.clear(), touched_.clear();
    moved_count_ = 0;
    for (std::size_t id = boxes.size(); id < count_; ++id)
      clear_slot_of(static_cast<std::uint32_t>(id));
    const std::size_t staying = std::min(boxes.size(), count_);
    for (const std::uint32_t id : moved)
      if (id < staying && slots_[id] != no_slot) move(id, boxes[id]);
    for (std::size_t id = count_; id < boxes.size(); ++id)
      inserted_.push_back(static_cast<std::uint32_t>(id));
    if (100 * inserted_.size() > boxes.size() + 3200) return stop(), false;
    if (!inserted_.empty()) insert_in_new_slots(boxes);
    order_touched();
    if (!find_changes(affordable)) return stop(), false;
    if (!emptied_.empty()) pairs_.cancel_out();
    apply(boxes.size());
    refit_touched();
    count_ = boxes.size();
    sorted_ = sort_pays();
    if (sorted_) sort(boxes);
    return true;
  }

  /// Whether the last update ended with a new spatial order.
  bool sorted() const { return sorted_; }

 private:
  static constexpr std::uint32_t no_slot = 0xffffffffu;

  void index_slots() {
    slots_.resize(count_);
    const std::uint32_t* ids = tree_.ids(0);
    for (std::uint32_t slot = 0; slot < tree_.slots(); ++slot)
      if (ids[slot] != no_box) slots_[ids[slot]] = slot;
    changed_.assign(tree_.leaves(), 0);
    was_at_.resize(tree_.leaves());
  }

  // ---- what moved ---------------------------------------------------------------------------

  void move(std::uint32_t id, const Box<T>& now) {
    const Box<T> was = last(id);
    if (was == now) return;
    if (joined_.jumped(row_of(now), row_of(was))) {
      clear_slot_of(id);
      inserted_.push_back(id);
      return;
    }
    change(slots_[id], now);
  }
  void clear_slot_of(std::uint32_t id) {
    change(slots_[id], nowhere<T>());
    emptied_.push_back(slots_[id]);
    slots_[id] = no_slot;
  }
  /// Writes the new box to the tree, where bounds then enclose both. Keeps a copy of the leaf as it
  /// was in the last frame.
  void change(std::uint32_t slot, const Box<T>& now) {
    const std::uint32_t leaf = slot / block_width;
    if (changed_[leaf] == 0) {
      was_at_[leaf] = static_cast<std::uint32_t>(was_.size());
      was_.push_back(tree_.leaf(leaf));
      touched_.push_back(leaf);
    }
    ++moved_count_;
    const int lane = static_cast<int>(slot % block_width);
    changed_[leaf] |= static_cast<std::uint16_t>(1u << lane);
    tree_.leaf(leaf).put(lane, now);
    if (now.lo[0] <= now.hi[0]) tree_.widen_above(leaf, now);
  }

  /// Puts boxes that jumped or are new into leaves of their own, in spatial order.
  void insert_in_new_slots(Boxes<T> boxes) {
    new_boxes_.clear();
    for (const std::uint32_t id : inserted_) new_boxes_.push_back(boxes[id]);
    const auto order = insertion_order_(new_boxes_, joined_.shares().threads());
    const std::uint32_t first = tree_.add_slots(order.size());
    changed_.resize(tree_.leaves(), 0);
    was_at_.resize(tree_.leaves());
    slots_.resize(std::max(slots_.size(), boxes.size()));
    for (std::size_t k = 0; k < order.size(); ++k) {
      const std::uint32_t id = inserted_[order[k].id];
      const std::uint32_t slot = first + static_cast<std::uint32_t>(k);
      tree_.ids(0)[slot] = id;
      slots_[id] = slot;
      change(slot, boxes[id]);
    }
  }

  /// Sorts the touched leaves, so that neighbours in memory are visited together.
  void order_touched() {
    if (64 * touched_.size() < changed_.size()) return std::sort(touched_.begin(), touched_.end());
    touched_.clear();
    for (std::uint32_t leaf = 0; leaf < changed_.size(); ++leaf)
      if (changed_[leaf] != 0) touched_.push_back(leaf);
  }

  // ---- which pairs change -------------------------------------------------------------------

  /// A batch of moved boxes and the leaves that their queries found.
  struct QueryBatch {
    std::vector<std::uint32_t> slots;
    std::vector<Box<T>> both;  ///< encloses the old and the new box of each
    typename BlockTree<T>::Finds finds;
    PairList began, ended;
    std::size_t leaves_found;
  };

  /// Fills `began` and `ended`. False where a first part of the work, or all of it, turns out to
  /// cost more than `affordable`.
  bool find_changes(double affordable) {
    constexpr std::size_t some = 32;  // leaves
    const std::size_t all = touched_.size(), parts = (all + some - 1) / some;
    Threads& threads = joined_.shares().threads();
    batches_.resize(threads.count() == 1 ? std::min<std::size_t>(parts, 1) : parts);
    std::size_t leaves_found = 0;
    const auto cost = [&](double share) {
      return BlockCosts::moved * static_cast<double>(moved_count_) +
             (BlockCosts::leaf * static_cast<double>(leaves_found) +
              BlockCosts::change(static_cast<double>(pairs_.all.size())) *
                  static_cast<double>(pairs_.began.size() + pairs_.ended.size())) /
                 share;
    };
    const auto query_part = [&](std::size_t part, QueryBatch& batch, PairList& began,
                                PairList& ended) {
      query_range(part * some, std::min(part * some + some, all), batch, began, ended);
    };
    const auto query_parts = [&](std::size_t first, std::size_t last) {
      if (threads.count() == 1 || last - first < 8) {
        for (std::size_t part = first; part < last; ++part) {
          query_part(part, batches_[0], pairs_.began, pairs_.ended);
          leaves_found += batches_[0].leaves_found;
        }
        return;
      }
      // Each part writes lists of its own, so that the order does not depend on threads.
      threads.share(last - first, [&](std::size_t k, std::size_t) {
        QueryBatch& batch = batches_[first + k];
        batch.began.clear(), batch.ended.clear();
        query_part(first + k, batch, batch.began, batch.ended);
      });
      for (std::size_t part = first; part < last; ++part) {
        leaves_found += batches_[part].leaves_found;
        pairs_.began.append(batches_[part].began.view());
        pairs_.ended.append(batches_[part].ended.view());
      }
    };
    const std::size_t few = std::min(parts, parts / 16 + 1);
    query_parts(0, few);
    const double done = static_cast<double>(std::min(few * some, all));
    // Refusing discards the index of pairs, so while there is one a partial estimate may be twice
    // as high.
    if (all > 0 && cost(done / static_cast<double>(all)) > (placed_ ? 2 : 1) * affordable)
      return refused(cost(done / static_cast<double>(all)));
    query_parts(few, parts);
    if (cost(1) > affordable) return refused(cost(1));
    leaves_found_ += leaves_found, queries_ += moved_count_;
    return true;
  }
  bool refused(double cost) {
    expected_cost_ = cost / static_cast<double>(std::max<std::size_t>(moved_count_, 1));
    return false;
  }
  /// Compares the moved boxes of touched leaves `first` to `last` with all boxes.
  void query_range(std::size_t first, std::size_t last, QueryBatch& batch, PairList& began,
                   PairList& ended) const {
    batch.slots.clear(), batch.both.clear();
    for (std::size_t k = first; k < last; ++k)
      for (LaneMask moved = changed_[touched_[k]]; moved; moved &= moved - 1) {
        const std::uint32_t slot = touched_[k] * block_width + std::countr_zero(moved);
        batch.slots.push_back(slot);
        batch.both.push_back(enclosing(now(slot), was(slot)));
      }
    tree_.find(batch.both, batch.finds);
    batch.leaves_found = batch.finds.count;
    // Keep only leaves that hold a box near this one, or a box that moved.
    std::uint32_t* const leaves = batch.finds.leaves.data();
    std::uint32_t* const boxes = batch.finds.boxes.data();
    std::size_t near = 0;
    for (std::size_t k = 0; k < batch.leaves_found; ++k) {
      const std::uint32_t leaf = leaves[k], box = boxes[k];
      if (k + ahead < batch.leaves_found) tree_.fetch(leaves[k + ahead]);
      leaves[near] = leaf, boxes[near] = box;
      near += (overlapping_lanes<Closed>(tree_.leaf(leaf), batch.both[box]) | changed_[leaf]) != 0;
    }
    for (std::size_t k = 0; k < near; ++k) compare(batch.slots[boxes[k]], leaves[k], began, ended);
  }
  static constexpr std::size_t ahead = 6;  ///< leaves between a prefetch and its use
  Box<T> now(std::uint32_t slot) const {
    return tree_.leaf(slot / block_width).box(static_cast<int>(slot % block_width));
  }
  Box<T> was(std::uint32_t slot) const {
    return was_[was_at_[slot / block_width]].box(static_cast<int>(slot % block_width));
  }
  /// Compares a moved box with all boxes of a leaf, before and after.
  void compare(std::uint32_t slot, std::uint32_t leaf, PairList& began, PairList& ended) const {
    const LaneMask also = changed_[leaf];
    const Block<T>& block = tree_.leaf(leaf);
    const Block<T>& before = also ? was_[was_at_[leaf]] : block;
    const LaneMask on = overlapping_lanes<Contact>(block, now(slot)),
                   off = overlapping_lanes<Contact>(before, was(slot));
    // Of two boxes that moved, the one in the earlier slot reports the pair.
    const LaneMask told = leaf < slot / block_width ? also
                          : leaf == slot / block_width
                              ? also & ((LaneMask{2} << slot % block_width) - 1)
                              : 0;
    const std::uint32_t id = tree_.ids(0)[slot];
    for (LaneMask lanes = (on ^ off) & ~told; lanes; lanes &= lanes - 1) {
      const int lane = std::countr_zero(lanes);
      (on >> lane & 1 ? began : ended).push(ordered(id, tree_.ids(leaf)[lane]));
    }
  }

  /// Changes the list in place.
  void apply(std::size_t boxes) {
    // The index of places is built in the first frame even if unneeded: no later one is slow.
    if (placed_ && pairs_.began.empty() && pairs_.ended.empty()) return;
    const std::span<const std::uint32_t> order(tree_.ids(0), tree_.slots());
    if (!placed_ || places_.sparse(pairs_.all))
      places_.build(pairs_.all, std::max(boxes, count_), order);
    placed_ = true;
    places_.resize(std::max(boxes, count_));
    places_.erase(pairs_.ended.view(), pairs_.all);
    places_.insert(pairs_.began.view(), pairs_.all);
  }

  /// Refits the bounds of touched leaves and clears all marks.
  void refit_touched() {
    for (const std::uint32_t slot : emptied_) tree_.ids(0)[slot] = no_box;
    for (const std::uint32_t leaf : touched_) changed_[leaf] = 0;
    tree_.refit(touched_);
  }

  // ---- order --------------------------------------------------------------------------------

  /// Whether many slots are empty, or queries have found so many more leaves than those right after
  /// sorting that sorting anew would have cost no more.
  bool sort_pays() {
    if (tree_.slots() > count_ + count_ / 8 + 64) return true;
    const double leaves_found = static_cast<double>(leaves_found_),
                 queries = static_cast<double>(queries_);
    if (leaves_per_query_when_sorted_ == 0) {
      if (4 * queries_ < count_ + 2048) return false;
      leaves_per_query_when_sorted_ = leaves_found / queries;
      leaves_found_ = queries_ = 0;
      return false;
    }
    return BlockCosts::leaf * (leaves_found - leaves_per_query_when_sorted_ * queries) >
           BlockCosts::sort * static_cast<double>(count_);
  }
  /// Sorts the boxes anew; the list is unchanged.
  void sort(Boxes<T> boxes) {
    joined_.build(joined_.order()(boxes, joined_.shares().threads()), boxes);
    index_slots();
    leaves_per_query_when_sorted_ = 0, leaves_found_ = queries_ = 0;
  }

  JoinedBlocks<T, Contact>& joined_;
  BlockTree<T>& tree_;
  ReportedPairs& pairs_;
  PairPlaces places_;
  bool active_ = false, placed_ = false, sorted_ = false;
  std::size_t count_ = 0;             ///< boxes of the last frame
  LargeVector<std::uint32_t> slots_;  ///< of each box

  LargeVector<std::uint16_t> changed_;  ///< of each leaf: the lanes in which boxes moved
  LargeVector<std::uint32_t> was_at_;   ///< of each touched leaf: its index in `was_`
  std::vector<Block<T>> was_;           ///< leaves as they were in the last frame
  std::vector<std::uint32_t> touched_;  ///< leaves where boxes moved
  std::size_t moved_count_ = 0;
  std::vector<QueryBatch> batches_;
  std::size_t leaves_found_ = 0, queries_ = 0;  ///< since the tree was sorted
  double leaves_per_query_when_sorted_ = 0;     ///< right after sorting; 0: unknown
  double expected_cost_ = 0;

  std::vector<std::uint32_t> inserted_, emptied_;
  std::vector<Box<T>> new_boxes_;
  SpatialOrder<T> insertion_order_;
};

}  // namespace bvlab
