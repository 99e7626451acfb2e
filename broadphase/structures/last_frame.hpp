// SPDX-License-Identifier: BSD-3-Clause
/// A copy of the last frame's boxes, kept to find the boxes that moved.
#pragma once

#include <algorithm>
#include <cstring>
#include <vector>

#include "broadphase/box.hpp"
#include "hierarchies/geometry/large_vector.hpp"

namespace bvlab {

template <class T>
class LastFrame {
 public:
  bool known() const { return known_; }
  void forget() { known_ = false; }
  void remember(Boxes<T> boxes) {
    boxes_.assign(boxes.begin(), boxes.end());
    known_ = true;
  }

  /// Appends the indices of boxes that differ from the last frame's to `moved`, and updates the
  /// copy; new boxes are copied but not listed. Stops early once more than `most` are found; then
  /// the copy is incomplete, and to be forgotten.
  void find_moved(Boxes<T> boxes, std::size_t most, std::vector<std::uint32_t>& moved) {
    const std::size_t staying = std::min(boxes.size(), boxes_.size());
    std::size_t first = 0;
    for (; first + group <= staying && moved.size() <= most; first += group)
      if (differ<group>(boxes.data() + first, boxes_.data() + first))
        take_over_one_by_one(boxes, first, first + group, moved);
    if (moved.size() > most) return;
    take_over_one_by_one(boxes, first, staying, moved);
    take_over_from(boxes, staying);
  }
  /// Updates the copy where the caller knows which boxes moved.
  void take_over(Boxes<T> boxes, std::span<const std::uint32_t> moved) {
    const std::size_t staying = std::min(boxes.size(), boxes_.size());
    for (const std::uint32_t id : moved)
      if (id < staying) boxes_[id] = boxes[id];
    take_over_from(boxes, staying);
  }

 private:
  static constexpr std::size_t group = 8;  ///< boxes compared between two branches

  /// Whether any bit of `Count` boxes differs; branch-free, in the widest registers there are.
  template <std::size_t Count>
  static bool differ(const Box<T>* a, const Box<T>* b) {
    // Aligned as a float: clang accepts no alignment that depends on T.
    typedef std::uint64_t Word __attribute__((may_alias, aligned(alignof(float))));
    const auto *x = reinterpret_cast<const Word*>(a), *y = reinterpret_cast<const Word*>(b);
    std::uint64_t any = 0;
    for (std::size_t k = 0; k < Count * sizeof(Box<T>) / sizeof(Word); ++k) any |= x[k] ^ y[k];
    return any != 0;
  }
  void take_over_one_by_one(Boxes<T> boxes, std::size_t first, std::size_t last,
                            std::vector<std::uint32_t>& moved) {
    for (std::size_t id = first; id < last; ++id) {
      if (!differ<1>(&boxes[id], &boxes_[id])) continue;
      boxes_[id] = boxes[id];
      moved.push_back(static_cast<std::uint32_t>(id));
    }
  }
  void take_over_from(Boxes<T> boxes, std::size_t first) {
    boxes_.resize(boxes.size());
    std::copy(boxes.begin() + static_cast<std::ptrdiff_t>(first), boxes.end(),
              boxes_.begin() + static_cast<std::ptrdiff_t>(first));
  }

  LargeVector<Box<T>> boxes_;
  bool known_ = false;
};

}  // namespace bvlab
