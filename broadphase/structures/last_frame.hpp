// SPDX-License-Identifier: BSD-3-Clause
/// A copy of the boxes of the last frame, where it pays to have one.
#pragma once

#include <algorithm>
#include <cstring>

#include "broadphase/box.hpp"
#include "hierarchies/geometry/large_vector.hpp"

namespace bvlab {

template <class T>
class LastFrame {
 public:
  static constexpr std::size_t stretch = 64;  ///< boxes compared before looking at the outcome

  bool known() const { return known_; }
  void forget() { known_ = false; }
  void remember(Boxes<T> boxes) {
    boxes_.assign(boxes.begin(), boxes.end());
    known_ = true;
  }
  Box<T>& operator[](std::size_t id) { return boxes_[id]; }

  /// Whether `count` boxes from the one with index `first` on are bit for bit the last frame's.
  bool same(Boxes<T> boxes, std::size_t first, std::size_t count) const {
    return std::memcmp(boxes.data() + first, boxes_.data() + first, count * sizeof(Box<T>)) == 0;
  }
  /// Whether all are, as far as that is known.
  bool same(Boxes<T> boxes) const {
    if (!known_) return false;
    for (std::size_t first = 0; first < boxes.size(); first += stretch)
      if (!same(boxes, first, std::min(stretch, boxes.size() - first))) return false;
    return true;
  }

  std::size_t bytes() const { return boxes_.capacity() * sizeof(Box<T>); }

 private:
  LargeVector<Box<T>> boxes_;
  bool known_ = false;
};

}  // namespace bvlab
