// SPDX-License-Identifier: BSD-3-Clause
/// Incremental sweep and prune on three axes (BibTeX: cohen1995icollide): the ends of all boxes are
/// kept sorted on every axis and repaired by insertion sort; each swap of a lower with an upper end
/// marks a pair that may begin or that ends. O(n + swaps) a frame; a frame may need O(n^2) swaps,
/// so beyond 64 swaps a box everything is sorted and swept again.
#pragma once

#include "broadphase/methods/sort_and_sweep.hpp"
#include "broadphase/structures/pair_slots.hpp"

namespace bvlab {

template <class T, class Contact>
class Sap {
 public:
  using Scalar = T;
  static constexpr std::string_view name = "sap";
  static constexpr std::string_view description =
      "incremental sweep and prune on three axes, pairs kept";

  explicit Sap(const MethodSettings& settings)
      : coherence_(settings.coherence), fresh_(MethodSettings{.coherence = Coherence::off}) {}

  std::span<const Pair> overlapping(Boxes<T> boxes) {
    const bool keep = coherence_ == Coherence::on && count_ == boxes.size() && count_ > 0;
    if (!keep || !repaired(boxes)) start_over(boxes);
    count_ = boxes.size();
    if constexpr (std::is_same_v<Contact, Closed>) return pairs_.view();
    filtered_.clear();
    for (const Pair& pair : pairs_.view())
      if (overlap<Contact>(boxes[pair.i], boxes[pair.j])) filtered_.push(pair);
    return filtered_.view();
  }

 private:
  /// A box's end on an axis; `what` is twice its index, plus one for the upper end. Of equal keys
  /// lower ends come first, so that touching boxes overlap.
  struct End {
    decltype(sort_key(T{})) key;
    std::uint32_t what;
    friend bool operator<(const End& a, const End& b) {
      return a.key != b.key ? a.key < b.key : (a.what & 1) < (b.what & 1);
    }
  };
  static auto key(const Box<T>& box, int axis, std::uint32_t what) {
    return sort_key(what & 1 ? box.hi[axis] : box.lo[axis]);
  }

  void start_over(Boxes<T> boxes) {
    for (int axis = 0; axis < 3; ++axis) {
      auto& ends = ends_[axis];
      ends.resize(2 * boxes.size());
      for (std::uint32_t k = 0; k < ends.size(); ++k) ends[k] = {key(boxes[k / 2], axis, k), k};
      std::sort(ends.begin(), ends.end());
    }
    slots_.clear();
    pairs_.clear();
    for (const Pair& pair : fresh_.overlapping(boxes)) begin(pair);
  }

  bool repaired(Boxes<T> boxes) {
    std::size_t swaps_left = 64 * boxes.size();
    for (int axis = 0; axis < 3; ++axis) {
      auto& ends = ends_[axis];
      for (End& end : ends) end.key = key(boxes[end.what / 2], axis, end.what);
      for (std::size_t k = 1; k < ends.size(); ++k) {
        if (!(ends[k] < ends[k - 1])) continue;
        const End end = ends[k];
        std::size_t hole = k;
        for (; hole > 0 && end < ends[hole - 1]; --hole) {
          if (swaps_left-- == 0) return false;
          const End& passed = ends[hole - 1];
          ends[hole] = passed;
          if ((end.what & 1) == (passed.what & 1) || end.what / 2 == passed.what / 2) continue;
          const std::uint32_t a = end.what / 2, b = passed.what / 2;
          if (end.what & 1)
            finish(ordered(a, b));
          else if (overlap<Closed>(boxes[a], boxes[b]))
            begin(ordered(a, b));
        }
        ends[hole] = end;
      }
    }
    return true;
  }

  void begin(Pair pair) {
    if (slots_.find(pair) != PairSlots::none) return;
    slots_.put(pair, static_cast<std::uint32_t>(pairs_.size()));
    pairs_.push(pair);
  }
  void finish(Pair pair) {
    const std::uint32_t slot = slots_.find(pair);
    if (slot == PairSlots::none) return;
    slots_.erase(pair);
    const Pair last = pairs_[pairs_.size() - 1];
    pairs_.resize_down(pairs_.size() - 1);
    if (slot == pairs_.size()) return;
    pairs_[slot] = last;
    slots_.put(last, slot);
  }

  Coherence coherence_;
  SortAndSweep<T, Closed> fresh_;
  std::size_t count_ = 0;
  std::vector<End> ends_[3];
  PairSlots slots_;
  PairList pairs_, filtered_;
};

}  // namespace bvlab
