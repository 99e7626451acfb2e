// SPDX-License-Identifier: BSD-3-Clause
/// The plane sweeps of koziara2005bounding (section 3.3): a plane moves along z; a box that it
/// enters queries a store of the rectangles in the plane for overlaps and is inserted; a box that
/// it leaves is removed. O(n log n) to sort the ends, plus the cost of the store. With coherence
/// the sorted ends are kept and repaired by insertion sort.
#pragma once

#include "broadphase/structures/pair_list.hpp"
#include "broadphase/structures/rectangle_store.hpp"
#include "broadphase/structures/sorted_ends.hpp"

namespace bvlab {

template <class T, class Contact, RectangleStore Store>
class Sweep {
 public:
  using Scalar = T;

  explicit Sweep(const MethodSettings& settings) : ends_(settings.coherence, settings.sort) {}

  std::span<const Pair> overlapping(Boxes<T> boxes) {
    pairs_.clear();
    if (boxes.empty()) return pairs_.view();
    const auto n = static_cast<std::uint32_t>(boxes.size());
    // Lower ends are 0 .. n-1, upper ends n .. 2n-1.
    const auto ends =
        ends_(2 * n, [&](std::uint32_t k) { return k < n ? boxes[k].lo[2] : boxes[k - n].hi[2]; });
    store_.prepare(boxes);
    for (std::size_t first = 0, last; first < ends.size(); first = last) {
      for (last = first; last < ends.size() && ends[last].key == ends[first].key; ++last)
        if (ends[last].id < n) enter(boxes, ends[last].id);
      // Touching boxes overlap: at equal keys, all boxes that start come before all that end.
      for (std::size_t k = first; k < last; ++k)
        if (ends[k].id >= n) store_.remove(ends[k].id - n);
    }
    return pairs_.view();
  }

 private:
  void enter(Boxes<T> boxes, std::uint32_t k) {
    store_.overlapping(k, [&](std::uint32_t other) {
      if (std::is_same_v<Contact, Closed> || overlap<Contact>(boxes[k], boxes[other]))
        pairs_.push(ordered(k, other));
    });
    store_.insert(k);
  }

  SortedEnds<T> ends_;
  Store store_;
  PairList pairs_;
};

template <class T>
using HashedLists = BucketGrid<T, ListBuckets<T>, true, true>;
template <class T>
using HashedTrees = BucketGrid<T, TreeBuckets<T, 0>, true, true>;
template <class T>
using OneTree = BucketGrid<T, TreeBuckets<T, 0>, false, false>;
template <class T>
using HashedStrips = BucketGrid<T, TreeBuckets<T, 1>, true, false>;

template <class T, class Contact>
struct Sweep1 : Sweep<T, Contact, HashedLists<T>> {
  static constexpr std::string_view name = "sweep1";
  static constexpr std::string_view description =
      "plane sweep over a two-dimensional hash of lists";
  using Sweep<T, Contact, HashedLists<T>>::Sweep;
};
template <class T, class Contact>
struct Sweep2 : Sweep<T, Contact, HashedTrees<T>> {
  static constexpr std::string_view name = "sweep2";
  static constexpr std::string_view description =
      "plane sweep over a two-dimensional hash of priority search trees along x";
  using Sweep<T, Contact, HashedTrees<T>>::Sweep;
};
template <class T, class Contact>
struct Sweep3 : Sweep<T, Contact, OneTree<T>> {
  static constexpr std::string_view name = "sweep3";
  static constexpr std::string_view description = "plane sweep over a priority search tree along x";
  using Sweep<T, Contact, OneTree<T>>::Sweep;
};
template <class T, class Contact>
struct Sweep4 : Sweep<T, Contact, HashedStrips<T>> {
  static constexpr std::string_view name = "sweep4";
  static constexpr std::string_view description =
      "plane sweep over a hash along x of priority search trees along y";
  using Sweep<T, Contact, HashedStrips<T>>::Sweep;
};

}  // namespace bvlab
