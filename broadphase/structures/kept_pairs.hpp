// SPDX-License-Identifier: BSD-3-Clause
/// A contiguous list of pairs that is changed in place. It is written once in segments; a pair is
/// looked for in the segment it was written in, and the few that have since moved are in a hash
/// table. Adding and removing cost O(1) and leave no hole: the last pair fills it.
#pragma once

#include "broadphase/structures/pair_list.hpp"
#include "broadphase/structures/pair_slots.hpp"

namespace bvlab {

/// Where pairs stood when the list was last written.
struct Segment {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

class KeptPairs {
 public:
  std::span<const Pair> view() const { return list_.view(); }
  std::size_t size() const { return list_.size(); }
  /// To be written anew, in segments.
  PairList& rewritten() {
    displaced_.clear();
    list_.clear();
    return list_;
  }
  /// How many pairs stand elsewhere than they were written.
  std::size_t displaced() const { return displaced_.size(); }

  void add(Pair pair) {
    displaced_.put(pair, static_cast<std::uint32_t>(list_.size()));
    list_.push(pair);
  }

  /// Takes out a pair that is in the list and was written in this segment, or added since.
  void remove(Pair pair, Segment segment) {
    std::uint32_t slot = displaced_.find(pair);
    if (slot != PairSlots::none) {
      displaced_.erase(pair);
    } else {
      slot = segment.first;
      while (list_[slot] != pair) ++slot;
    }
    const Pair last = list_[list_.size() - 1];
    list_.resize_down(list_.size() - 1);
    if (slot == list_.size()) return;
    list_[slot] = last;
    displaced_.put(last, slot);
  }

  std::size_t bytes() const { return list_.capacity() * sizeof(Pair) + displaced_.bytes(); }

 private:
  PairList list_;
  PairSlots displaced_;
};

}  // namespace bvlab
