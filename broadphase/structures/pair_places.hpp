// SPDX-License-Identifier: BSD-3-Clause
/// The position of each pair in the list of all pairs, so that the list can be changed in place.
/// Each box holds the pairs in which it has the smaller index, contiguous with room to grow; a pair
/// is found by a linear search among those of its box. Built in O(pairs) by counting, without
/// hashing; a pair is inserted or erased in O(1 + pairs of its box).
///
/// Up to 14 bytes per pair and 40 per box where it has been built, about 20 and 56 after
/// insertions.
#pragma once

#include <algorithm>
#include <cstdint>

#include "broadphase/structures/pair_list.hpp"
#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/pages.hpp"

namespace bvlab {

class PairPlaces {
 public:
  /// Indexes the list. `order` lists each box at least once (entries of `boxes` or more are
  /// skipped); the pairs of boxes that are neighbours in it are neighbours in memory.
  void build(const PairList& list, std::size_t boxes, std::span<const std::uint32_t> order) {
    own_.assign(boxes, {});
    for (const Pair& pair : list.view()) ++own_[pair.i].room;
    std::size_t begin = 0;
    for (const std::uint32_t box : order) {
      if (box >= boxes) continue;
      Own& own = own_[box];
      own.begin = begin, own.room += own.room / 8 + 2;
      begin += own.room;
    }
    used_ = begin;
    if (entries_.size() < used_ + used_ / 8 + 16) resize_entries(used_ + used_ / 2 + 1024);
    // On new pages this halves the time.
    pages::bring(entries_.data(), entries_.data() + used_);
    for (std::size_t place = 0; place < list.size(); ++place) {
      Own& own = own_[list[place].i];
      put(own.begin + own.count++, list[place].j, place);
    }
  }

  /// Sets the number of boxes; new ones have no pairs.
  void resize(std::size_t boxes) { own_.resize(boxes); }

  /// Appends pairs, none of which is in the list yet.
  void insert(std::span<const Pair> pairs, PairList& list) {
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      fetch(pairs, k);
      insert(pairs[k], list);
    }
  }
  void insert(Pair pair, PairList& list) {
    Own& own = own_[pair.i];
    if (own.count == own.room) move_to_the_end(own);
    put(own.begin + own.count++, pair.j, list.size());
    list.push(pair);
  }
  /// Erases pairs that are in the list; each time the last pair moves into the gap.
  void erase(std::span<const Pair> pairs, PairList& list) {
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      fetch(pairs, k);
      if (const std::size_t left = list.size() - 1; left >= ahead) fetch(list[left - ahead + 1]);
      erase(pairs[k], list);
    }
  }
  void erase(Pair pair, PairList& list) {
    Own& own = own_[pair.i];
    const std::size_t entry = entry_of(pair), end = own.begin + --own.count;
    const std::uint32_t place = entries_[entry].place;
    entries_[entry] = entries_[end];
    const std::size_t last = list.size() - 1;
    if (place != last) {
      list[place] = list[last];
      entries_[entry_of(list[last])].place = place;
    }
    list.resize_down(last);
  }

  /// Whether so much room is unused that rebuilding is worth it.
  bool sparse(const PairList& list) const { return used_ > 2 * list.size() + 4 * own_.size(); }

 private:
  /// A pair, owned by one box: the other box, and the pair's position in the list.
  struct Entry {
    std::uint32_t other, place;
  };
  struct Own {
    std::size_t begin = 0;
    std::uint32_t count = 0, room = 0;
  };

  static constexpr std::size_t ahead = 8;  ///< pairs between a prefetch and its use
  /// Prefetches for later pairs: first the box's record, then its entries.
  void fetch(std::span<const Pair> pairs, std::size_t k) const {
    if (k + 2 * ahead < pairs.size()) __builtin_prefetch(&own_[pairs[k + 2 * ahead].i]);
    if (k + ahead < pairs.size()) fetch(pairs[k + ahead]);
  }
  void fetch(Pair pair) const {
    const Own& own = own_[pair.i];
    for (std::size_t entry = 0; entry < own.count && entry < 64; entry += 8)
      __builtin_prefetch(entries_.data() + own.begin + entry);
  }

  void put(std::size_t entry, std::uint32_t other, std::size_t place) {
    entries_[entry] = {other, static_cast<std::uint32_t>(place)};
  }
  /// Searches sixteen entries at a time, without a branch between them.
  std::size_t entry_of(Pair pair) const {
    constexpr std::size_t some = 16;
    std::size_t entry = own_[pair.i].begin;
    for (;; entry += some) {
      bool any = false;
      for (std::size_t k = 0; k < some; ++k) any |= entries_[entry + k].other == pair.j;
      if (any) break;
    }
    while (entries_[entry].other != pair.j) ++entry;
    return entry;
  }
  void move_to_the_end(Own& own) {
    const std::uint32_t room = 2 * own.room + 4;
    if (used_ + room + 16 > entries_.size()) resize_entries((used_ + room) * 5 / 4);
    std::copy_n(entries_.data() + own.begin, own.count, entries_.data() + used_);
    own.begin = used_, own.room = room;
    used_ += room;
  }
  /// A search may read up to sixteen entries past the last.
  void resize_entries(std::size_t count) { entries_.resize(count + 16); }

  LargeVector<Own> own_;
  LargeVector<Entry> entries_;
  std::size_t used_ = 0;
};

}  // namespace bvlab
