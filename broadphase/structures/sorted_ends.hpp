// SPDX-License-Identifier: BSD-3-Clause
/// Items in the order of one coordinate. Without coherence they are sorted from scratch, by radix
/// or by comparison (see Sort). With coherence the order of the last frame is repaired by insertion
/// sort, O(n + swaps) (BibTeX: cohen1995icollide), which is given up for a sort once swaps exceed
/// sixteen an item.
#pragma once

#include <algorithm>
#include <vector>

#include "broadphase/settings.hpp"
#include "hierarchies/geometry/radix_sort.hpp"

namespace bvlab {

template <class T>
class SortedEnds {
 public:
  using Key = decltype(sort_key(T{}));
  using Item = Keyed<Key>;

  SortedEnds(Coherence coherence, Sort sort) : coherence_(coherence), sort_(sort) {}

  /// Sorts 0 .. count-1 by `coordinate(k)`. Equal ones keep their order or, after a sort by
  /// comparison, are ordered by number.
  template <class Coordinate>
  std::span<const Item> operator()(std::uint32_t count, Coordinate&& coordinate) {
    const bool repair = coherence_ == Coherence::on && items_.size() == count;
    if (!repair) {
      items_.resize(count);
      for (std::uint32_t k = 0; k < count; ++k) items_[k].id = k;
    }
    for (auto& item : items_) item.key = sort_key(coordinate(item.id));
    if (!repair || !repaired()) sort();
    return items_;
  }

 private:
  void sort() {
    if (sort_ == Sort::radix) return radix_sort(items_, spare_);
    std::sort(items_.begin(), items_.end(), [](const Item& a, const Item& b) {
      return a.key < b.key || (a.key == b.key && a.id < b.id);
    });
  }

  /// Insertion sort; false, with a permutation of the items, after sixteen swaps an item.
  bool repaired() {
    std::size_t swaps_left = 16 * items_.size();
    for (std::size_t k = 1; k < items_.size(); ++k) {
      if (items_[k - 1].key <= items_[k].key) continue;
      const Item item = items_[k];
      std::size_t hole = k;
      for (; hole > 0 && items_[hole - 1].key > item.key; --hole) {
        items_[hole] = items_[hole - 1];
        if (swaps_left-- == 0) {
          items_[hole - 1] = item;
          return false;
        }
      }
      items_[hole] = item;
    }
    return true;
  }

  Coherence coherence_;
  Sort sort_;
  std::vector<Item> items_, spare_;
};

}  // namespace bvlab
