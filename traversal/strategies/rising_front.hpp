// SPDX-License-Identifier: BSD-3-Clause
/// A front that can also rise: two entries that are the children of one pair are replaced by it
/// where it needs no further look (ehmann2001accurate).
///
/// Law: whatever is raised, the front stays a partition, of pairs that recursion makes. A pair
/// comes about in one way: larger nodes are descended before smaller ones, and a child that is
/// larger than its parent right after it; so the parent that was descended last is that of the two
/// with the smaller `least_above`. The sibling is the pair with the other child, found by a table.
///
/// Two siblings in the front (a sibling pair) are tried in the run after the second one came into
/// it, and after j times in vain in the next run whose number 2^j divides, j up to `most_failures`.
/// A pair just raised is tried with its sibling in the same run, so that a front can rise all the
/// way at once. An entry whose sibling is not there costs nothing: it is idle until that comes.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <tuple>
#include <vector>

#include "traversal/front.hpp"

namespace bvlab {

/// Two siblings in a front, by their slots.
struct SiblingPair {
  NodePair parent;
  std::uint32_t first, second;
  bool raised = false;
  bool stays = false;  // raised, and its parent was not
};

/// Where in a front an entry is: open addressing, linear, at most half full.
class SlotTable {
 public:
  static constexpr std::uint32_t nowhere = static_cast<std::uint32_t>(-1);
  using Entries = std::vector<NodePair>;

  void clear() { std::fill(slots_.begin(), slots_.end(), nowhere); }

  std::uint32_t find(const NodePair& pair, const Entries& entries) const {
    return slots_[place_of(pair, entries)];
  }

  /// The entry in `slot` is there now. Of an entry that was in another slot before only the pair
  /// may have stayed the same; one whose pair is to change is erased before it does.
  void set(std::size_t slot, const Entries& entries) {
    if (2 * entries.size() > slots_.size()) grow(entries);
    slots_[place_of(entries[slot], entries)] = static_cast<std::uint32_t>(slot);
  }

  void erase(const NodePair& pair, const Entries& entries) {
    std::size_t hole = place_of(pair, entries);
    slots_[hole] = nowhere;
    // What could not be put where it belongs moves up.
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

  /// Where it is, or where it belongs.
  std::size_t place_of(const NodePair& pair, const Entries& entries) const {
    std::size_t i = home(pair);
    while (slots_[i] != nowhere && !(entries[slots_[i]] == pair)) i = next(i);
    return i;
  }

  void grow(const Entries& entries) {
    std::vector<std::uint32_t> old(std::bit_ceil(4 * entries.size()), nowhere);
    old.swap(slots_);
    for (const std::uint32_t slot : old)
      if (slot != nowhere) slots_[place_of(entries[slot], entries)] = slot;
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

  void open(std::size_t slot) {
    table_.erase(entries_[slot], entries_);
    Front::open(slot);
  }

  std::size_t add(const NodePair& pair, Seen = Seen::not_yet, double = 0) {
    const std::size_t slot = Front::add(pair);
    failures_.resize(size());
    failures_[slot] = 0;
    table_.set(slot, entries_);
    return slot;
  }

  void finish(std::size_t witness, bool) {
    if (witness != Outcome::none) bring_forward(witness);
  }

  void bring_forward(std::size_t slot) {
    // They are found by what they are, so they leave the table before they are exchanged.
    if (slot != 0) table_.erase(entries_[0], entries_), table_.erase(entries_[slot], entries_);
    Front::bring_forward(slot);
    std::swap(failures_[0], failures_[slot]);
    if (slot != 0) table_.set(slot, entries_), table_.set(0, entries_);
  }

  /// Parents are tried when the witness has been looked at and did not settle the matter, before
  /// all other entries. What was raised has been tested.
  template <class Traversal>
  bool sweep(Traversal& traversal) {
    if (witnessed() && traversal.look_at_alone(0)) return true;
    const std::size_t raised = rise(traversal), first = witnessed();
    return traversal.look_at(size() - raised - first, [first](std::size_t i) { return first + i; });
  }

  /// The sibling pairs that are due. Each run asks once, when its witness did not settle the
  /// matter.
  template <class H>
  void propose(const H& a, const H& b, std::vector<SiblingPair>& sibling_pairs) {
    sibling_pairs.clear();
    const auto due = static_cast<unsigned>(std::countr_zero(++run_));
    for (std::size_t slot = 0; slot < size(); ++slot)
      if (failures_[slot] <= due) {
        const SiblingPair siblings = sibling_pair_of(slot, a, b);
        if (siblings.second == SlotTable::nowhere) {
          failures_[slot] = idle;
        } else {
          failures_[siblings.second] = idle;  // the first one speaks for both
          sibling_pairs.push_back(siblings);
        }
      }
  }

  /// The parent of sibling_pairs[i] is apart: replaces its children, and proposes it with its
  /// sibling.
  template <class H>
  void raise(const H& a, const H& b, std::vector<SiblingPair>& sibling_pairs, std::size_t i) {
    sibling_pairs[i].raised = true;
    const auto [parent, first, second] =
        std::tuple(sibling_pairs[i].parent, sibling_pairs[i].first, sibling_pairs[i].second);
    table_.erase(entries_[first], entries_);
    table_.erase(entries_[second], entries_);
    entries_[first] = parent;
    table_.set(first, entries_);
    failures_[first] = fresh;
    failures_[second] = gone;
    const SiblingPair next = sibling_pair_of(first, a, b);
    if (next.second != SlotTable::nowhere) sibling_pairs.push_back(next);
  }

  /// It is not.
  void refuse(const SiblingPair& siblings) {
    auto& failures = failures_[siblings.first];
    if (failures < most_failures) ++failures;
  }

  /// Puts what was raised behind all other entries, and says how many that is.
  std::size_t settle(std::vector<SiblingPair>& sibling_pairs) {
    std::size_t raised = 0;
    for (SiblingPair& siblings : sibling_pairs) {
      siblings.stays = siblings.raised && failures_[siblings.first] == fresh &&
                       entries_[siblings.first] == siblings.parent;
      if (!siblings.stays) continue;
      table_.erase(siblings.parent, entries_);
      failures_[siblings.first] = gone;
      ++raised;
    }
    for (const SiblingPair& siblings : sibling_pairs)
      if (siblings.raised) fill(siblings.first), fill(siblings.second);
    for (const SiblingPair& siblings : sibling_pairs)
      if (siblings.stays) add(siblings.parent);
    return raised;
  }

 private:
  /// Tries the parents that are proposed and, where one is apart, its parent after it. Says how
  /// many have been raised: they stand behind all other entries.
  template <class Traversal>
  std::size_t rise(Traversal& traversal) {
    auto& pairs = traversal.workspace().template room<std::vector<SiblingPair>>();
    propose(traversal.a(), traversal.b(), pairs);
    for (std::size_t next = 0; next < pairs.size();) {
      const std::size_t count = std::min(Traversal::W, pairs.size() - next);
      std::uint64_t apart =
          traversal.culled(count, [&](std::size_t i) { return pairs[next + i].parent; });
      for (std::size_t i = 0; i < count; ++i, ++next, apart >>= 1)
        if (apart & 1)
          raise(traversal.a(), traversal.b(), pairs, next);
        else
          refuse(pairs[next]);
    }
    const std::size_t raised = settle(pairs);
    if (!witnessed()) traversal.forget_witness();
    return raised;
  }

  /// The longest wait is 2^most_failures runs: for bodies at rest, whose sibling pairs are at most
  /// half their entries, 1/32 of a test for each entry and run. Of 1 to 1024 runs, on random walks,
  /// 8 and 16 are within 7 % of the best at every motion.
  static constexpr std::uint8_t most_failures = 4;
  /// Not failures: due in no run; raised in this one; not an entry any more.
  static constexpr std::uint8_t idle = 253, fresh = 254, gone = 255;

  static std::uint32_t sibling(std::uint32_t node) { return ((node + 1) ^ 1) - 1; }

  /// Of an entry, without a second one where that is not in the front; the roots never have one.
  template <class H>
  SiblingPair sibling_pair_of(std::size_t slot, const H& a, const H& b) const {
    const NodePair pair = entries_[slot];
    NodePair parent = pair, other = pair;
    const bool by_b =
        pair.a == 0 || (pair.b != 0 && !(b.least_above(pair.b) > a.least_above(pair.a)));
    if (by_b)
      parent.b = b.parent(pair.b), other.b = sibling(pair.b);
    else
      parent.a = a.parent(pair.a), other.a = sibling(pair.a);
    return {parent, static_cast<std::uint32_t>(slot), table_.find(other, entries_)};
  }

  /// Moves the last entry that there is into a slot where there is none.
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
