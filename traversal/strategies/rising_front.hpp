// SPDX-License-Identifier: BSD-3-Clause
/// A front that can also be raised: the entries that are all the children of one pair are replaced
/// by that pair where it is apart (ehmann2001accurate).
///
/// Law: whatever is raised, the front remains a partition into pairs that recursion makes.
/// Recursion reaches a pair in one way only: it descends the larger node first, and a child that is
/// larger than its parent is descended next. So the last descent was at the parent with the smaller
/// `least` (Hierarchy::Above). The siblings of an entry are the pairs with the other children of
/// that parent; a table finds their slots.
///
/// Siblings that are all in the front are proposed in the run after the last of them was added, and
/// after j failures in the next run whose number is divisible by 2^j, j up to `most_failures`. A
/// raised pair is proposed with its own siblings in the same run, so that a front can rise all the
/// way at once. An entry that lacks a sibling costs nothing: it is idle until that one is added.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "traversal/front.hpp"

namespace bvlab {

/// Entries of a front that are all the children of one pair, proposed to be replaced by it.
struct Siblings {
  NodePair parent;
  std::uint32_t slot;           ///< of the entry that represents them
  std::uint32_t others, count;  ///< the slots of the others, in Proposals::slots
  bool raised = false;
  bool kept = false;  ///< raised, and its parent was not raised
};
struct Proposals {
  std::vector<Siblings> all;
  std::vector<std::uint32_t> slots;  ///< the first `used` are in use
  std::uint32_t used = 0;

  void clear() { all.clear(), used = 0; }
  std::span<const std::uint32_t> others_of(const Siblings& siblings) const {
    return {slots.data() + siblings.others, siblings.count};
  }
  /// Room for `count` slots; they are kept when `used` is increased.
  std::uint32_t* room(std::uint32_t count) {
    const std::size_t needed = std::size_t{used} + count;
    if (slots.size() < needed) slots.resize(2 * needed);
    return slots.data() + used;
  }
};

/// The slot of each entry of a front: a hash table with linear probing, at most half full.
class SlotTable {
 public:
  static constexpr std::uint32_t nowhere = static_cast<std::uint32_t>(-1);
  using Entries = std::vector<NodePair>;

  void clear() { std::fill(slots_.begin(), slots_.end(), nowhere); }

  std::uint32_t find(const NodePair& pair, const Entries& entries) const {
    return slots_[index_of(pair, entries)];
  }

  /// Records that an entry is in `slot`. If the entry was in another slot before, that is
  /// overwritten. If its pair is to change, it must be erased before.
  void set(std::size_t slot, const Entries& entries) {
    if (2 * entries.size() > slots_.size()) grow(entries);
    slots_[index_of(entries[slot], entries)] = static_cast<std::uint32_t>(slot);
  }

  void erase(const NodePair& pair, const Entries& entries) {
    std::size_t hole = index_of(pair, entries);
    slots_[hole] = nowhere;
    // Entries that were displaced from their home by the erased one move up.
    for (std::size_t i = next(hole); slots_[i] != nowhere; i = next(i))
      if (behind(home(entries[slots_[i]]), i) >= behind(hole, i)) {
        slots_[hole] = slots_[i];
        slots_[i] = nowhere;
        hole = i;
      }
  }

 private:
  std::size_t mask() const { return slots_.size() - 1; }
  std::size_t next(std::size_t i) const { return (i + 1) & mask(); }
  std::size_t behind(std::size_t from, std::size_t to) const { return (to - from) & mask(); }
  std::size_t home(const NodePair& pair) const {
    return ((std::uint64_t{pair.a} << 32 | pair.b) * 0x9e3779b97f4a7c15u) >> 32 & mask();
  }

  /// The index at which the pair is, or where it belongs.
  std::size_t index_of(const NodePair& pair, const Entries& entries) const {
    std::size_t i = home(pair);
    while (slots_[i] != nowhere && !(entries[slots_[i]] == pair)) i = next(i);
    return i;
  }

  void grow(const Entries& entries) {
    std::vector<std::uint32_t> old(std::bit_ceil(4 * entries.size()), nowhere);
    old.swap(slots_);
    for (const std::uint32_t slot : old)
      if (slot != nowhere) slots_[index_of(entries[slot], entries)] = slot;
  }

  std::vector<std::uint32_t> slots_;
};

class RisingFront : public Front {
 public:
  void restart() {
    Front::restart();
    failures_.assign(1, idle);
    table_.clear();
    table_.set(0, entries_);
  }

  void clear() {
    Front::clear();
    failures_.clear();
    table_.clear();
  }

  void restart_below_roots() {
    clear();
    Front::restart_below_roots();
  }
  /// A run has ended whose one entry, the roots, was apart.
  void pass_by() { ++run_; }

  void open(std::size_t slot) {
    table_.erase(entries_[slot], entries_);
    Front::open(slot);
  }

  std::size_t add(const NodePair& pair, EntryState = EntryState::not_yet, double = 0) {
    const std::size_t slot = Front::add(pair);
    failures_.resize(size());
    failures_[slot] = 0;
    table_.set(slot, entries_);
    return slot;
  }

  void finish(std::size_t witness, bool) {
    if (witness != Outcome::none) set_witness(witness);
  }

  void set_witness(std::size_t slot) {
    // The table finds entries by their pairs, so they leave it before they are exchanged.
    if (slot != 0) table_.erase(entries_[0], entries_), table_.erase(entries_[slot], entries_);
    Front::set_witness(slot);
    std::swap(failures_[0], failures_[slot]);
    if (slot != 0) table_.set(slot, entries_), table_.set(0, entries_);
  }

  /// Parents are tried after the witness, if it did not decide the query, and before all other
  /// entries. What was raised has been tested.
  template <class Traversal>
  bool sweep(Traversal& traversal) {
    if (enters_below_roots(traversal)) {
      pass_by();
      return false;
    }
    if (witnessed() && traversal.test_entry(0)) return true;
    const std::size_t raised = rise(traversal), first = witnessed();
    return traversal.test_entries(size() - raised - first,
                                  [first](std::size_t i) { return first + i; });
  }

  /// Proposes the siblings that are due. Called once in each run whose witness did not decide the
  /// query.
  template <class H>
  void propose(const H& a, const H& b, Proposals& proposals) {
    proposals.clear();
    const auto due = static_cast<unsigned>(std::countr_zero(++run_));
    for (std::size_t slot = 0; slot < size(); ++slot)
      if (failures_[slot] <= due) {
        if (!add_siblings_of(slot, a, b, proposals)) {
          failures_[slot] = idle;
        } else {
          for (const auto other : proposals.others_of(proposals.all.back()))
            failures_[other] = idle;
        }
      }
  }

  /// The parent of proposals.all[i] is apart: it replaces its children, and is proposed with its
  /// siblings.
  template <class H>
  void raise(const H& a, const H& b, Proposals& proposals, std::size_t i) {
    proposals.all[i].raised = true;
    const Siblings siblings = proposals.all[i];
    const std::uint32_t first = siblings.slot;
    table_.erase(entries_[first], entries_);
    for (const auto slot : proposals.others_of(siblings)) {
      table_.erase(entries_[slot], entries_);
      failures_[slot] = gone;
    }
    entries_[first] = siblings.parent;
    table_.set(first, entries_);
    failures_[first] = fresh;
    add_siblings_of(first, a, b, proposals);
  }

  /// The parent of proposals.all[i] is not apart.
  void refuse(const Proposals& proposals, std::size_t i) {
    auto& failures = failures_[proposals.all[i].slot];
    if (failures < most_failures) ++failures;
  }

  /// Moves raised entries behind all others; returns their number.
  std::size_t settle(Proposals& proposals) {
    std::size_t raised = 0;
    for (Siblings& siblings : proposals.all) {
      siblings.kept = siblings.raised && failures_[siblings.slot] == fresh &&
                      entries_[siblings.slot] == siblings.parent;
      if (!siblings.kept) continue;
      table_.erase(siblings.parent, entries_);
      failures_[siblings.slot] = gone;
      ++raised;
    }
    for (const Siblings& siblings : proposals.all)
      if (siblings.raised) {
        fill(siblings.slot);
        for (const auto slot : proposals.others_of(siblings)) fill(slot);
      }
    for (const Siblings& siblings : proposals.all)
      if (siblings.kept) add(siblings.parent);
    return raised;
  }

 private:
  /// Tries the proposed parents and, where one is apart, its parent after it. Returns how many have
  /// been raised: they come after all other entries.
  template <class Traversal>
  std::size_t rise(Traversal& traversal) {
    auto& proposals = traversal.workspace().template scratch<Proposals>();
    propose(traversal.a(), traversal.b(), proposals);
    for (std::size_t next = 0; next < proposals.all.size();) {
      const std::size_t count = std::min(Traversal::W, proposals.all.size() - next);
      std::uint64_t apart =
          traversal.culled(count, [&](std::size_t i) { return proposals.all[next + i].parent; });
      for (std::size_t i = 0; i < count; ++i, ++next, apart >>= 1)
        if (apart & 1)
          raise(traversal.a(), traversal.b(), proposals, next);
        else
          refuse(proposals, next);
    }
    const std::size_t raised = settle(proposals);
    if (!witnessed()) traversal.forget_witness();
    return raised;
  }

  /// The longest wait is 2^most_failures runs: bodies at rest, of whose entries at most half
  /// represent siblings, then cost 1/32 of a test per entry and run. Of waits from 1 to 1024 runs,
  /// on random walks, 8 and 16 are within 7 % of the best at every motion.
  static constexpr std::uint8_t most_failures = 4;
  /// Special values: never due; raised in this run; no longer an entry.
  static constexpr std::uint8_t idle = 253, fresh = 254, gone = 255;

  /// Proposes an entry with its siblings, unless one of them is not in the front. The roots have no
  /// siblings.
  template <class H>
  [[gnu::always_inline]] bool add_siblings_of(std::size_t slot, const H& a, const H& b,
                                              Proposals& proposals) const {
    const NodePair pair = entries_[slot];
    if (pair.a == 0 && pair.b == 0) return false;
    const auto &above_a = a.above(pair.a), &above_b = b.above(pair.b);
    const bool by_b = pair.a == 0 || (pair.b != 0 && !(above_b.least > above_a.least));
    const std::uint32_t own = by_b ? pair.b : pair.a;
    const auto& above = by_b ? above_b : above_a;
    std::uint32_t* to = proposals.room(above.count);
    for (std::uint32_t k = 1; k < above.count; ++k) {
      const std::uint32_t next = own + k,
                          child = next - (next < above.first + above.count ? 0 : above.count);
      *to = table_.find(by_b ? NodePair{pair.a, child} : NodePair{child, pair.b}, entries_);
      if (*to++ == SlotTable::nowhere) return false;
    }
    proposals.all.push_back({by_b ? NodePair{pair.a, above.parent} : NodePair{above.parent, pair.b},
                             static_cast<std::uint32_t>(slot), proposals.used, above.count - 1});
    proposals.used += above.count - 1;
    return true;
  }

  /// Moves the last valid entry into `slot` if that is vacant.
  void fill(std::size_t slot) {
    while (!failures_.empty() && failures_.back() == gone) drop_last();
    if (!(slot < size() && failures_[slot] == gone)) return;
    if (slot == 0) witnessed_ = false;
    table_.erase(entries_.back(), entries_);
    entries_[slot] = entries_.back();
    failures_[slot] = failures_.back();
    drop_last();
    table_.set(slot, entries_);
  }

  void drop_last() {
    if (size() == 1) witnessed_ = false;
    entries_.pop_back();
    failures_.pop_back();
  }

  std::vector<std::uint8_t> failures_;
  SlotTable table_;
  std::uint64_t run_ = 0;
};

}  // namespace bvlab
