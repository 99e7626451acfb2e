// SPDX-License-Identifier: BSD-3-Clause
/// Picks a method by the number of boxes. Up to 64 are swept along one axis, which costs less than
/// sorting them into spatial order, unless changes are to be reported. More go to `blocks`, which
/// makes its own choices: how many size classes to sort into, from the spread of sizes; whether to
/// keep the list, change it in place, follow the boxes (and for how many frames) or start over,
/// from overlap and motion.
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
      "sweep for up to 64 boxes, else blocks, which chooses from overlap, sizes and motion; says "
      "why";

  explicit Auto(const MethodSettings& settings)
      : settings_(settings), blocks_(settings), sweep_(settings) {}

  std::span<const Pair> overlapping(Boxes<T> boxes) {
    return note(boxes, choose(boxes) ? sweep_.overlapping(boxes) : blocks_.overlapping(boxes));
  }
  /// As `overlapping`, where only the boxes in `moved` moved (see Blocks::update).
  std::span<const Pair> update(Boxes<T> boxes, std::span<const std::uint32_t> moved) {
    // `blocks` has not seen the frames that were answered by the sweep.
    const bool seen = !small_;
    if (choose(boxes)) return note(boxes, sweep_.overlapping(boxes));
    return note(boxes, seen ? blocks_.update(boxes, moved) : blocks_.overlapping(boxes));
  }
  PairChanges changes() const { return blocks_.changes(); }
  /// Which method answered the last frame, and the figures it was chosen by.
  std::string reason() const {
    if (small_) return "sort-and-sweep: " + std::to_string(count_) + " boxes are few";
    const std::size_t tenths = count_ ? 10 * found_ / count_ : 0;
    return "blocks: " + std::to_string(count_) + " boxes, " + std::to_string(tenths / 10) + "." +
           std::to_string(tenths % 10) + " pairs a box, sizes in " +
           std::to_string(blocks_.classes()) +
           (blocks_.classes() == 1 ? " class; " : " classes; ") + std::string(blocks_.reason());
  }

 private:
  /// Whether the boxes are few enough for the sweep, which cannot report changes.
  bool choose(Boxes<T> boxes) {
    return small_ = boxes.size() <= few && settings_.changes == Changes::unreported;
  }
  std::span<const Pair> note(Boxes<T> boxes, std::span<const Pair> pairs) {
    count_ = boxes.size(), found_ = pairs.size();
    return pairs;
  }

  /// The measured break-even of the two methods, both with coherence and without.
  static constexpr std::size_t few = 64;

  MethodSettings settings_;
  Blocks<T, Contact> blocks_;
  SortAndSweep<T, Contact> sweep_;
  bool small_ = false;
  std::size_t count_ = 0, found_ = 0;
};

}  // namespace bvlab
