// SPDX-License-Identifier: BSD-3-Clause
/// The sweeps of koziara2005bounding (section 3.3): a plane goes through the boxes along z; whoever
/// enters asks a store of the rectangles that are in for those it overlaps, and leaves it again at
/// its other end. O(n log n) for the ends, and what the store costs. With coherence the sorted ends
/// are kept and repaired by insertion sort.
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
      // Whoever ends where another starts touches it, so all that start come before all that end.
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
