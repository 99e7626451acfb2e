// SPDX-License-Identifier: BSD-3-Clause
/// The difference of two lists of pairs, both ways, by radix sort of both: O(k). For methods that
/// do not track changes as they go.
#pragma once

#include <algorithm>

#include "broadphase/settings.hpp"
#include "broadphase/structures/pair_list.hpp"
#include "hierarchies/geometry/radix_sort.hpp"

namespace bvlab {

class PairDifference {
 public:
  /// Fills `began` with the pairs in `now` but not in `before`, `ended` with the opposite. The
  /// lists may be those that `before` and `now` are views of.
  void operator()(std::span<const Pair> before, std::span<const Pair> now, PairList& began,
                  PairList& ended) {
    sort(before, old_);
    sort(now, new_);
    began.clear();
    ended.clear();
    std::size_t a = 0, b = 0;
    while (a < old_.size() || b < new_.size()) {
      if (b == new_.size() || (a < old_.size() && old_[a].key < new_[b].key))
        ended.push(pair(old_[a++]));
      else if (a == old_.size() || new_[b].key < old_[a].key)
        began.push(pair(new_[b++]));
      else
        ++a, ++b;
    }
  }

 private:
  using Item = Keyed<std::uint64_t>;
  static Pair pair(const Item& item) {
    return {static_cast<std::uint32_t>(item.key >> 32), static_cast<std::uint32_t>(item.key)};
  }
  void sort(std::span<const Pair> pairs, std::vector<Item>& items) {
    items.clear();
    for (const Pair& p : pairs) items.push_back({std::uint64_t{p.i} << 32 | p.j, 0});
    radix_sort(items, spare_);
  }

  std::vector<Item> old_, new_, spare_;
};

}  // namespace bvlab
