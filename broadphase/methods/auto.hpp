// SPDX-License-Identifier: BSD-3-Clause
/// Picks a method from what it sees. Few boxes are swept along one axis, where sorting three axes
/// and keeping blocks would cost more than comparing. All others go to `blocks`, which itself
/// chooses, from how far boxes moved, jumped and spread, between keeping, listing, refitting and
/// starting over.
#pragma once

#include <string>

#include "broadphase/methods/blocks.hpp"
#include "broadphase/methods/sort_and_sweep.hpp"

namespace bvlab {

template <class T, class Contact>
class Auto {
 public:
  using Scalar = T;
  static constexpr std::string_view name = "auto";
  static constexpr std::string_view description =
      "picks a method from number, overlap, sizes and motion, and says why";

  explicit Auto(const MethodSettings& settings)
      : settings_(settings), blocks_(settings), sweep_(settings) {}

  std::span<const Pair> overlapping(Boxes<T> boxes) {
    const bool small = boxes.size() <= few && settings_.changes == Changes::unreported;
    if (small) {
      reason_ = "sort-and-sweep: few boxes";
      return sweep_.overlapping(boxes);
    }
    const auto pairs = blocks_.overlapping(boxes);
    reason_ = "blocks: ";
    reason_ += blocks_.reason();
    return pairs;
  }
  PairChanges changes() const { return blocks_.changes(); }
  const std::string& reason() const { return reason_; }

 private:
  static constexpr std::size_t few = 1000;  ///< measured: where the two cost the same from scratch

  MethodSettings settings_;
  Blocks<T, Contact> blocks_;
  SortAndSweep<T, Contact> sweep_;
  std::string reason_;
};

}  // namespace bvlab
