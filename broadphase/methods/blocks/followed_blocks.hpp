// SPDX-License-Identifier: BSD-3-Clause
/// Updates the list of pairs while boxes move steadily. Each box gets a *fat box* that encloses it
/// for some frames (the *horizon*) if it keeps its present motion. Pairs whose fat boxes overlap
/// are the candidates, as in a Verlet list (BibTeX: verlet1967computer), but each face of a fat box
/// moves outward only if that is its direction of motion, so that the width grows by about a
/// quarter of what a margin all around adds. While every box is inside its fat box, only candidates
/// can overlap. A box that leaves it gets a wider one, and a box that jumps or is new gets another
/// slot.
///
/// Once too many boxes have left their fat boxes before the horizon, since they change direction
/// often or jitter, all boxes get margins all around instead, for good. Margins have no fixed
/// horizon: they are used until a sample of the boxes has used half of them. If no sample uses half
/// of its margin for long, the narrowest margins take over.
///
/// A frame reads every box once and compares all candidates. The next candidates are found in
/// parts over several frames (NextCandidates). Only a frame that begins without them takes longer
/// than starting over.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "broadphase/methods/blocks/joined_blocks.hpp"
#include "broadphase/methods/blocks/next_candidates.hpp"
#include "broadphase/structures/candidate_pairs.hpp"
#include "hierarchies/geometry/large_vector.hpp"

namespace bvlab {

template <class T, class Contact>
class FollowedBlocks {
 public:
  /// `joined`: its tree holds the fat boxes while this is active; `pairs`: the list that is
  /// written. Both must outlive this object.
  FollowedBlocks(const MethodSettings& settings, JoinedBlocks<T, Contact>& joined,
                 ReportedPairs& pairs)
      : settings_(settings), joined_(joined), tree_(joined.tree()), pairs_(pairs) {}

  bool active() const { return active_; }
  void stop() {
    active_ = false;
    next_.abandon();
  }

  /// Whether the candidates are valid for another frame.
  bool candidates_valid() const { return !must_rebuild_ && (age_ < horizon_ || !steady_); }
  /// Whether slots have piled up, as where the number of boxes changes in every frame.
  bool overgrown() const { return tree_.slots() > 2 * count_ + 1024; }
  /// The number of frames in a row, up to the last, in which fewer than one box in eight moved.
  int few_moved() const { return few_moved_; }
  /// Whether boxes keep their motion well enough for one-sided fat boxes: as is expected before it
  /// begins, until they once did not.
  bool steady() const { return steady_; }
  void expect(bool steady) { steady_ = steady && was_steady_; }
  /// The shortest and the longest horizon, in frames.
  static constexpr int shortest = 8;
  int longest() const { return longest_; }
  /// The present horizon, and the number of candidates when it began.
  int horizon() const { return horizon_; }
  double candidates() const { return static_cast<double>(candidates_at_first_); }
  /// The number of frames over which the next candidates are found.
  int time_to_find() const { return std::min(horizon_, 2 * shortest) / 2; }

  /// Whether it is time to choose a horizon for the next candidates.
  bool time_to_prepare() const {
    if (next_.begun()) return false;
    if (too_many_candidates_) return true;
    if (steady_) return age_ == horizon_ - time_to_find();
    return horizon_ > shortest && age_ > 0 && age_ % 4 == 0 && (nearly_still() || half_used());
  }
  /// Whether boxes barely move: the shortest horizon is enough.
  bool nearly_still() const { return !steady_ && !margins_exceeded_ && age_ >= 2 * horizon_; }
  /// Starts to find the next candidates, a part in each frame; finds none where `horizon` is 0.
  void prepare(int horizon) {
    if (horizon == 0) {
      must_rebuild_ |= too_many_candidates_;
      return;
    }
    next_.begin(horizon, time_to_find());
    pending_insertions_.clear();
    slots_changed_ = false;
    takes_over_at_ = age_ + time_to_find();
    next_ahead_ = nearly_still() ? 0 : shortest;
  }

  /// Whether boxes left the shortest margins: longer ones are worth more than they cost.
  bool margins_exceeded() const { return !steady_ && margins_exceeded_; }

  /// The last frame's box in this slot.
  Row<T> last_row(std::uint32_t slot) const {
    if (active_) return candidates_.rows()[slot];
    return row_of(tree_.leaf(slot / block_width).box(static_cast<int>(slot % block_width)));
  }

  /// Makes fat boxes for `horizon` frames, finds their candidates and lists all pairs.
  void begin(Boxes<T> boxes, int horizon) { begin(boxes, horizon, settings_.changes); }

  /// The same while already active. Where changes are reported, the old candidates, valid for one
  /// frame more, yield the changes before new ones are found; comparing two whole lists would cost
  /// more. False where too many boxes left their fat boxes.
  bool begin_again(Boxes<T> boxes, int horizon) {
    if (settings_.changes != Changes::reported) return begin(boxes, horizon), true;
    auto& rows = candidates_.rows();
    last_rows_ = rows;
    const bool followed = follow(boxes);
    // Where slots changed, or the next candidates took over in an order of their own, the rows of
    // the last frame no longer fit: next time.
    if (!inserted_.empty() || !emptied_.empty() || (followed && took_over_)) return followed;
    std::swap(rows, last_rows_);
    // Where too many left their fat boxes, the list is still that of the last frame.
    begin(boxes, horizon, followed ? Changes::unreported : Changes::reported);
    return true;
  }

  /// Updates the list for one frame; false where too many boxes left their fat boxes.
  bool follow(Boxes<T> boxes) {
    if (next_.begun() && !next_.ready()) prepare_a_part(boxes);
    escaped_.clear(), inserted_.clear(), emptied_.clear();
    moved_count_ = 0;
    for (std::size_t id = boxes.size(); id < count_; ++id) clear_slot(slots_[id]);
    const std::size_t staying = std::min(boxes.size(), count_);
    scan(boxes, staying);
    for (std::size_t id = count_; id < boxes.size(); ++id)
      inserted_.push_back(static_cast<std::uint32_t>(id));
    // One escape costs about as much as starting over does for 32 boxes, an insertion 100.
    if (32 * escaped_.size() + 100 * inserted_.size() > boxes.size() + 3200) {
      if (inserted_.size() < escaped_.size()) degrade_prediction();
      return false;
    }
    widen_escaped();
    if (!inserted_.empty()) insert_in_new_slots(boxes);
    few_moved_ = few_of(boxes.size()) ? few_moved_ + 1 : 0;
    write_candidates();
    for (const std::uint32_t slot : emptied_) tree_.ids(0)[slot] = no_box;
    // A pair that ended in one slot and began in another, where its box went, did not change.
    if (settings_.changes == Changes::reported && !emptied_.empty()) pairs_.cancel_out();
    if (next_.begun()) note_slot_changes(boxes.size());
    count_ = boxes.size();
    ++age_;
    too_many_candidates_ = candidates_.size() > 2 * candidates_at_first_ + boxes.size();
    must_rebuild_ = candidates_.size() > 4 * candidates_at_first_ + 2 * boxes.size() ||
                    tree_.slots() > boxes.size() + boxes.size() / 8 + 64;
    took_over_ = next_.ready() && age_ >= takes_over_at_;
    if (took_over_) take_over_next(boxes);
    return true;
  }

  /// Whether the next candidates took over at the end of the last frame.
  bool took_over() const { return took_over_; }

  /// Stops following, and leaves the boxes of the last frame in the tree.
  void stop_with_boxes() {
    for (std::uint32_t slot = 0; slot < tree_.slots(); ++slot)
      tree_.leaf(slot / block_width)
          .put(static_cast<int>(slot % block_width), box_of(candidates_.rows()[slot]));
    tree_.refit_all();
    stop();
  }

  /// Encloses the box for `frames` more frames if it keeps its motion; in unsteady motion, a margin
  /// all around. Correctness does not depend on the prediction.
  Row<T> fat_box_of(const Row<T>& now, const Row<T>& was, int frames) const {
    if (joined_.jumped(now, was)) return now;
    const Four<T> zero{}, low = now.lo - was.lo, high = now.hi - was.hi;
    const Four<T> far = most<T>(absolute<T>(low), absolute<T>(high));
    Row<T> fat;
    if (steady_) {
      const T ahead = static_cast<T>(frames);
      // A quarter of a step more covers accumulated rounding.
      fat = {now.lo + least<T>(low * ahead, zero) - far / 4,
             now.hi + most<T>(high * ahead, zero) + far / 4};
    } else {
      const T widest = std::max({far[0], far[1], far[2]}) * (static_cast<T>(frames) + T(0.25));
      fat = {now.lo - widest, now.hi + widest};
    }
    constexpr T limit = std::numeric_limits<T>::max();
    return {most<T>(fat.lo, zero - limit), least<T>(fat.hi, zero + limit)};
  }

 private:
  /// The slots that a thread takes at once: whole blocks of leaves.
  static constexpr std::uint32_t slots_a_stretch = 4 * block_width * block_width;

  // ---- fat boxes and candidates -------------------------------------------------------------

  void begin(Boxes<T> boxes, int horizon, Changes changes) {
    const bool compare = changes == Changes::reported;
    if (compare) pairs_.keep_before();
    next_.abandon();
    sort_if_due(boxes);
    auto& rows = candidates_.rows();
    const std::uint32_t slots = tree_.slots();
    if (!active_) {
      rows.resize(slots);
      for (std::uint32_t slot = 0; slot < slots; ++slot) rows[slot] = last_row(slot);
    }
    slots_.resize(boxes.size());
    fat_boxes_.resize(slots);
    constexpr std::uint32_t stretch = slots_a_stretch;
    joined_.shares().threads().share(
        (slots + stretch - 1) / stretch, [&](std::size_t k, std::size_t) {
          const auto first = static_cast<std::uint32_t>(k) * stretch;
          make_fat_boxes(boxes, horizon, first, std::min(slots - first, stretch) + first);
        });
    tree_.refit_above();
    candidates_.clear();
    const std::uint32_t* ids = tree_.ids(0);
    visits_ = joined_.template join_into<Closed>(
        candidates_.list(),
        [ids](Pair* out, std::uint32_t slot, std::uint32_t leaf, LaneMask lanes) {
          const std::uint32_t first = leaf * block_width;
          return write_pairs_by_id(out, slot, ids[slot], first, ids + first, lanes);
        });
    if (sorted_) visits_when_sorted_ = visits_, sorted_ = false;
    candidates_at_first_ = candidates_.size();
    count_ = boxes.size();
    active_ = true;
    horizon_ = horizon, age_ = 0;
    must_rebuild_ = too_many_candidates_ = false;
    few_moved_ = 0;
    write_candidates();
    if (compare) pairs_.compare_with_kept();
  }

  /// For slots `first` to `last`: whole blocks of leaves, so no two threads write the same bounds.
  void make_fat_boxes(Boxes<T> boxes, int horizon, std::uint32_t first, std::uint32_t last) {
    auto& rows = candidates_.rows();
    for (std::uint32_t slot = first; slot < last; ++slot) {
      const std::uint32_t id = tree_.ids(0)[slot];
      Box<T> fat = nowhere<T>();
      if (id == no_box) {
        rows[slot] = nowhere_row<T>();
      } else {
        const Row<T> now = row_of(boxes[id]);
        const Row<T> expected = fat_box_of(now, rows[slot], horizon);
        fat_boxes_[slot].lo = expected.lo, fat_boxes_[slot].hi = expected.hi;
        fat = box_of(expected);
        rows[slot].lo = now.lo, rows[slot].hi = now.hi;
        slots_[id] = slot;
      }
      tree_.leaf(slot / block_width).put(static_cast<int>(slot % block_width), fat);
    }
    for (std::uint32_t k = first / block_width; k < last / block_width; ++k)
      tree_.set_leaf_bounds(k, bounds(tree_.leaf(k)));
  }

  bool sort_due(std::size_t boxes) const {
    return joined_.sorting_frees_a_leaf(boxes) || 3 * visits_ >= 4 * visits_when_sorted_;
  }
  /// Sorts anew once the old order costs a third more or leaves too many slots empty.
  void sort_if_due(Boxes<T> boxes) {
    if (!active_) {
      sorted_ = true;
      return;
    }
    if (!sort_due(boxes.size())) return;
    const auto order = joined_.order()(boxes, joined_.shares().threads());
    auto& rows = candidates_.rows();
    spare_.resize((order.size() + block_width - 1) / block_width * block_width);
    for (std::size_t k = 0; k < order.size(); ++k) spare_[k] = rows[slots_[order[k].id]];
    std::swap(rows, spare_);
    joined_.build(order, boxes);
    sorted_ = true;
  }

  /// Does this frame's part of finding the next candidates.
  void prepare_a_part(Boxes<T> boxes) {
    const int ahead = std::min(next_ahead_, takes_over_at_ - age_) + next_.horizon();
    next_.advance(
        joined_,
        [&](BlockTree<T>& tree) {
          sorted_next_ = sort_due(boxes.size());
          if (!sorted_next_) {
            tree.resize_leaves(tree_.leaves());
            std::copy_n(tree_.ids(0), tree_.slots(), tree.ids(0));
            return;
          }
          const auto order = joined_.order()(boxes, joined_.shares().threads());
          tree.resize_leaves(0);
          tree.resize_leaves(
              static_cast<std::uint32_t>((order.size() + block_width - 1) / block_width));
          for (std::size_t k = 0; k < order.size(); ++k) tree.ids(0)[k] = order[k].id;
        },
        [&](std::uint32_t slot, std::uint32_t id) {
          if (id >= boxes.size()) return nowhere_row<T>();
          const std::uint32_t at = sorted_next_ ? slots_[id] : slot;
          return fat_box_of(row_of(boxes[id]), candidates_.rows()[at], ahead);
        },
        [&](std::uint32_t id) {
          if (id >= boxes.size()) return;
          __builtin_prefetch(&boxes[id]);
          if (sorted_next_) __builtin_prefetch(&candidates_.rows()[slots_[id]]);
        });
  }
  /// Notes boxes that are new, gone or in another slot since the search for the next candidates
  /// began. Where they are many, that search is abandoned.
  void note_slot_changes(std::size_t boxes) {
    slots_changed_ |= !inserted_.empty() || !emptied_.empty();
    pending_insertions_.insert(pending_insertions_.end(), inserted_.begin(), inserted_.end());
    if (100 * pending_insertions_.size() > boxes + 3200) next_.abandon();
  }
  /// Replaces the candidates in use by the next ones.
  void take_over_next(Boxes<T> boxes) {
    std::swap(tree_, next_.tree());
    std::swap(fat_boxes_, next_.fat_boxes());
    if (slots_changed_) clear_outdated_slots();
    if (sorted_next_ || slots_changed_) take_over_order();
    candidates_.clear();
    std::swap(candidates_.list(), next_.candidates());
    if (!pending_insertions_.empty()) {
      std::swap(inserted_, pending_insertions_);
      insert_in_new_slots(boxes);
    }
    visits_ = next_.visits();
    if (sorted_next_) visits_when_sorted_ = visits_;
    candidates_at_first_ = candidates_.size();
    horizon_ = next_.horizon(), age_ = 0;
    must_rebuild_ = too_many_candidates_ = false;
    next_.abandon();
    if (settings_.changes == Changes::reported) know_which_overlap();
  }
  /// Removes boxes that are gone, or about to get other slots, from the tree that takes over.
  void clear_outdated_slots() {
    std::sort(pending_insertions_.begin(), pending_insertions_.end());
    pending_insertions_.erase(std::unique(pending_insertions_.begin(), pending_insertions_.end()),
                              pending_insertions_.end());
    for (std::uint32_t slot = 0; slot < tree_.slots(); ++slot) {
      std::uint32_t& id = tree_.ids(0)[slot];
      if (id == no_box || (id < count_ && !std::binary_search(pending_insertions_.begin(),
                                                              pending_insertions_.end(), id)))
        continue;
      id = no_box;
      tree_.leaf(slot / block_width).put(static_cast<int>(slot % block_width), nowhere<T>());
    }
  }
  /// Brings the rows into the tree's order.
  void take_over_order() {
    auto& rows = candidates_.rows();
    const std::uint32_t slots = tree_.slots();
    const std::uint32_t* const ids = tree_.ids(0);
    spare_.resize(slots);
    for (std::uint32_t slot = 0; slot < slots; ++slot) {
      if (slot + ahead < slots && ids[slot + ahead] != no_box)
        __builtin_prefetch(&rows[slots_[ids[slot + ahead]]]);
      const std::uint32_t id = ids[slot];
      if (id == no_box) {
        spare_[slot] = nowhere_row<T>();
        continue;
      }
      spare_[slot] = rows[slots_[id]];
      slots_[id] = slot;
    }
    std::swap(rows, spare_);
  }
  /// Finds which of the new candidates overlap. Boxes that are outside their new fat boxes already,
  /// which only the next frame would notice otherwise, get wider ones first.
  void know_which_overlap() {
    escaped_.clear();
    const auto& rows = candidates_.rows();
    for (std::uint32_t slot = 0; slot < tree_.slots(); ++slot)
      if (tree_.ids(0)[slot] != no_box && !inside(rows[slot], fat_boxes_[slot]))
        escaped_.push_back({slot, rows[slot]});
    widen_escaped();
    write_candidates();
  }

  // ---- one frame ----------------------------------------------------------------------------

  /// Reads every box, in the order of slots; notes those that moved or left their fat boxes.
  void scan(Boxes<T> boxes, std::size_t staying) {
    const std::uint32_t slots = tree_.slots();
    Threads& threads = joined_.shares().threads();
    const bool shared = threads.count() > 1 && slots >= 2 * slots_a_stretch;
    // A frame that fits the cache is prefetched in order, a larger one box by box.
    const bool as_needed = shared || boxes.size_bytes() > (1u << 20);
    if (!as_needed)
      for (std::size_t byte = 0; byte < boxes.size_bytes(); byte += 64)
        __builtin_prefetch(reinterpret_cast<const char*>(boxes.data()) + byte, 0, 2);
    const std::uint32_t stretch = shared ? slots_a_stretch : std::max(slots, 1u);
    scans_.resize((slots + stretch - 1) / stretch);
    threads.share(scans_.size(), [&](std::size_t k, std::size_t) {
      const auto first = static_cast<std::uint32_t>(k) * stretch;
      scan_slots(boxes, staying, first, std::min(slots - first, stretch) + first, as_needed,
                 scans_[k]);
    });
    for (const SlotScan& scan : scans_) {
      moved_count_ += scan.moved;
      for (const auto& [slot, was] : scan.escaped) leave_fat_box(slot, was);
    }
  }
  struct Escaped {
    std::uint32_t slot;
    Row<T> was;
  };
  /// What one thread found in a range of slots.
  struct SlotScan {
    std::size_t moved;
    std::vector<Escaped> escaped;  ///< whose boxes left their fat boxes
  };
  void scan_slots(Boxes<T> boxes, std::size_t staying, std::uint32_t first, std::uint32_t last,
                  bool as_needed, SlotScan& scan) {
    const std::uint32_t* ids = tree_.ids(0);
    Row<T>* const rows = candidates_.rows().data();
    const Row<T>* const fat_boxes = fat_boxes_.data();
    std::size_t moved = 0;
    const std::size_t too_many = boxes.size() + 3200;
    scan.escaped.clear();
    for (std::uint32_t slot = first; slot < last; ++slot) {
      if (as_needed && slot + ahead < last && ids[slot + ahead] < staying)
        __builtin_prefetch(&boxes[ids[slot + ahead]]);
      if (ids[slot] >= staying) continue;
      const Row<T> was = rows[slot], now = row_of(boxes[ids[slot]]);
      // Copy the halves one by one: as a whole they would go through memory.
      rows[slot].lo = now.lo, rows[slot].hi = now.hi;
      moved += !same(now, was);
      if (!inside(now, fat_boxes[slot])) [[unlikely]] {
        scan.escaped.push_back({slot, was});
        if (32 * scan.escaped.size() > too_many) break;
      }
    }
    scan.moved = moved;
  }
  static constexpr std::uint32_t ahead = 16;  ///< slots between a prefetch and its use

  void leave_fat_box(std::uint32_t slot, const Row<T>& was) {
    if (!joined_.jumped(candidates_.rows()[slot], was)) {
      escaped_.push_back({slot, was});
      return;
    }
    inserted_.push_back(tree_.ids(0)[slot]);
    clear_slot(slot);
  }
  /// Empties the slot. Its pairs end with this frame; its candidates remain but never overlap.
  void clear_slot(std::uint32_t slot) {
    candidates_.rows()[slot] = nowhere_row<T>();
    tree_.leaf(slot / block_width).put(static_cast<int>(slot % block_width), nowhere<T>());
    emptied_.push_back(slot);
  }

  /// Whether few of the frame's boxes moved.
  bool few_of(std::size_t boxes) const { return BlockCosts::few_times * moved_count_ < boxes; }

  /// Where few boxes move, one that leaves its fat box may have started just now and rest again in
  /// the next frame. Where most move, it is expected to move until the horizon.
  static constexpr int after_an_escape = 2;
  void widen_escaped() {
    const int frames = few_of(count_) ? std::min(horizon_, after_an_escape)
                                      : std::max(steady_ ? 1 : shortest / 2, horizon_ - age_);
    for (const auto& [slot, was] : escaped_) {
      const Row<T> now = candidates_.rows()[slot], next = fat_box_of(now, was, frames);
      Row<T>& fat = fat_boxes_[slot];
      const Box<T> old = box_of(fat);
      fat = {least<T>(least<T>(fat.lo, next.lo), now.lo),
             most<T>(most<T>(fat.hi, next.hi), now.hi)};
      enter(slot, old);
    }
  }
  /// Keeps the candidates complete: adds the pairs that the new fat box of this slot overlaps and
  /// the old one did not.
  void enter(std::uint32_t slot, const Box<T>& old) {
    const Box<T> fat = box_of(fat_boxes_[slot]);
    const std::uint32_t* ids = tree_.ids(0);
    tree_.widen(slot, fat);
    tree_.find(fat, [&](std::uint32_t k) {
      const Block<T>& block = tree_.leaf(k);
      LaneMask lanes =
          overlapping_lanes<Closed>(block, fat) & ~overlapping_lanes<Closed>(block, old);
      for (; lanes; lanes &= lanes - 1) {
        const std::uint32_t other = k * block_width + std::countr_zero(lanes);
        if (other != slot) candidates_.add(slot, ids[slot], other, ids[other]);
      }
    });
  }

  /// Puts boxes that jumped or are new into slots of their own, in spatial order.
  void insert_in_new_slots(Boxes<T> boxes) {
    std::erase_if(inserted_, [&](std::uint32_t id) { return id >= boxes.size(); });
    new_boxes_.clear();
    for (const std::uint32_t id : inserted_) new_boxes_.push_back(boxes[id]);
    const auto order = insertion_order_(new_boxes_, joined_.shares().threads());
    const std::uint32_t first = tree_.add_slots(order.size());
    // Never fewer: the search for the next candidates reads a slot of a box that comes back.
    slots_.resize(std::max(slots_.size(), boxes.size()));
    auto& rows = candidates_.rows();
    rows.resize(tree_.slots(), nowhere_row<T>());
    fat_boxes_.resize(tree_.slots());
    for (std::size_t k = 0; k < order.size(); ++k) {
      const std::uint32_t id = inserted_[order[k].id];
      const std::uint32_t slot = first + static_cast<std::uint32_t>(k);
      tree_.ids(0)[slot] = id;
      slots_[id] = slot;
      rows[slot] = fat_boxes_[slot] = row_of(boxes[id]);
      enter(slot, nowhere<T>());
    }
    moved_count_ += order.size();
  }

  /// Too many boxes left their fat boxes: change from one-sided boxes to margins, or adapt these.
  void degrade_prediction() {
    if (steady_)
      steady_ = was_steady_ = age_ >= horizon_;
    else if (horizon_ == shortest)
      margins_exceeded_ = true;
    else if (age_ < horizon_)
      longest_ = std::max(shortest, longest_ / 2);
  }
  /// Whether more than an eighth of a sample of the boxes has used half of its margin: at the same
  /// speed, about as many frames are left as have passed.
  bool half_used() const {
    const auto& rows = candidates_.rows();
    std::size_t seen = 0, used = 0;
    tree_.sample(16, [&](std::uint32_t slot, std::uint32_t) {
      const Four<T> low = rows[slot].lo - fat_boxes_[slot].lo,
                    high = fat_boxes_[slot].hi - rows[slot].hi;
      bool half = false;
      for (int axis = 0; axis < 3; ++axis)
        half |= std::min(low[axis], high[axis]) < T(0.27) * (low[axis] + high[axis]);
      ++seen, used += half;
    });
    return 8 * used > seen;
  }

  void write_candidates() {
    pairs_.all.clear();
    const std::size_t count = candidates_.size();
    Threads& threads = joined_.shares().threads();
    const bool shared = threads.count() > 1 && count >= candidates_worth_sharing;
    const std::uint32_t* const ids = tree_.ids(0);
    if (settings_.changes == Changes::reported) {
      if (!shared) return candidates_.compare_all(ids, pairs_.all, pairs_.began, pairs_.ended);
      return candidates_.compare_all_shared(ids, pairs_.all, pairs_.began, pairs_.ended, threads);
    }
    if (!shared) return candidates_.compare_range(ids, pairs_.all, 0, count);
    const std::size_t shares = 8 * threads.count();
    joined_.shares()(pairs_.all, shares, [&](std::size_t share, std::size_t of, PairList& to) {
      candidates_.compare_range(ids, to, count * share / of, count * (share + 1) / of);
    });
  }
  /// Below this, waking a thread takes longer than the comparisons.
  static constexpr std::size_t candidates_worth_sharing = 4000;

  MethodSettings settings_;
  JoinedBlocks<T, Contact>& joined_;
  BlockTree<T>& tree_;  ///< holds the fat boxes while active
  ReportedPairs& pairs_;

  CandidatePairs<T, Contact> candidates_;
  LargeVector<Row<T>> fat_boxes_, spare_, last_rows_;
  LargeVector<std::uint32_t> slots_;  ///< of each box
  std::size_t count_ = 0;             ///< boxes of the last frame
  std::size_t candidates_at_first_ = 0, visits_ = 0, visits_when_sorted_ = 0;
  bool active_ = false, sorted_ = false, steady_ = true, was_steady_ = true;
  bool margins_exceeded_ = false;     ///< boxes left the shortest margins
  bool too_many_candidates_ = false;  ///< so many candidates that new ones are worth finding
  bool must_rebuild_ = false;         ///< too many candidates or empty slots to go on
  NextCandidates<T, Contact> next_;
  bool sorted_next_ = false, took_over_ = false;
  int longest_ = 64, horizon_ = 0, age_ = 0, takes_over_at_ = 0, next_ahead_ = 0;

  std::vector<Escaped> escaped_;
  std::vector<SlotScan> scans_;
  std::vector<std::uint32_t> inserted_, emptied_;
  /// Boxes inserted since the search for the next candidates began.
  std::vector<std::uint32_t> pending_insertions_;
  bool slots_changed_ = false;  ///< whether any box came, went or jumped since then
  std::size_t moved_count_ = 0;
  int few_moved_ = 0;  ///< frames in a row
  std::vector<Box<T>> new_boxes_;
  SpatialOrder<T> insertion_order_;
};

}  // namespace bvlab
