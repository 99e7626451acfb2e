// SPDX-License-Identifier: BSD-3-Clause
/// Sort and sweep along one axis: boxes are sorted by their lower ends, and each is compared,
/// sixteen at a time, with those that start before it ends. O(n) to sort and O(n m) comparisons, m
/// the boxes that overlap one on the axis (BibTeX: baraff1992thesis, terdiman2018boxpruning). With
/// coherence the order is repaired.
#pragma once

#include <vector>

#include "broadphase/structures/block.hpp"
#include "broadphase/structures/pair_list.hpp"
#include "broadphase/structures/sorted_ends.hpp"
#include "hierarchies/geometry/scalar.hpp"

namespace bvlab {

template <class T, class Contact>
class SortAndSweep {
 public:
  using Scalar = T;
  static constexpr std::string_view name = "sort-and-sweep";
  static constexpr std::string_view description =
      "sorted along one axis, swept with vector comparisons";

  explicit SortAndSweep(const MethodSettings& settings)
      : coherence_(settings.coherence), sorted_(settings.coherence, settings.sort) {}

  std::span<const Pair> overlapping(Boxes<T> boxes) {
    if (coherence_ == Coherence::off || boxes.size() != count_) axis_ = sparsest_axis(boxes);
    count_ = boxes.size();
    copy_in_order(boxes);
    pairs_.clear();
    for (std::size_t k = 0; k < boxes.size(); ++k) sweep_from(k);
    return pairs_.view();
  }

 private:
  /// The axis on which the boxes' extents are the smallest share of their range.
  static int sparsest_axis(Boxes<T> boxes) {
    int best = 0;
    double best_cover = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      double lo = std::numeric_limits<double>::infinity(), hi = -lo, sum = 0;
      for (const auto& box : boxes) {
        lo = std::min<double>(lo, box.lo[axis]), hi = std::max<double>(hi, box.hi[axis]);
        sum += static_cast<double>(box.hi[axis]) - static_cast<double>(box.lo[axis]);
      }
      const double cover = hi > lo ? sum / (hi - lo) : std::numeric_limits<double>::max();
      if (cover < best_cover) best = axis, best_cover = cover;
    }
    return best;
  }

  void copy_in_order(Boxes<T> boxes) {
    const auto order = sorted_(static_cast<std::uint32_t>(boxes.size()),
                               [&](std::uint32_t k) { return boxes[k].lo[axis_]; });
    // One block of sentinels after the last box ends every sweep.
    const std::size_t padded = order.size() + block_width;
    for (int axis = 0; axis < 3; ++axis) lo_[axis].resize(padded), hi_[axis].resize(padded);
    ids_.resize(padded);
    const auto put = [&](std::size_t at, const Box<T>& box) {
      for (int k = 0; k < 3; ++k) {
        const int axis = (axis_ + k) % 3;
        lo_[k][at] = box.lo[axis], hi_[k][at] = box.hi[axis];
      }
    };
    for (std::size_t k = 0; k < order.size(); ++k)
      put(k, boxes[order[k].id]), ids_[k] = order[k].id;
    for (std::size_t k = order.size(); k < padded; ++k) put(k, nowhere<T>());
  }

  void sweep_from(std::size_t k) {
    using V = stdx::native_simd<T>;
    constexpr int width = std::min(static_cast<int>(V::size()), block_width);
    const T end = hi_[0][k];
    for (std::size_t first = k + 1; lo_[0][first] <= end; first += block_width) {
      LaneMask found = 0;
      for (int part = 0; part < block_width; part += width) {
        const auto load = [&](const std::vector<T>& values) {
          return V(values.data() + first + part, stdx::element_aligned);
        };
        auto mask = Contact::reaches(V(end), load(lo_[0]));
        // For closed boxes this follows from the order; half-open ones may end where both start.
        if constexpr (!std::is_same_v<Contact, Closed>)
          mask = mask && Contact::reaches(load(hi_[0]), V(lo_[0][k]));
        for (int axis = 1; axis < 3; ++axis) {
          mask = mask && Contact::reaches(V(hi_[axis][k]), load(lo_[axis]));
          mask = mask && Contact::reaches(load(hi_[axis]), V(lo_[axis][k]));
        }
        found |= static_cast<LaneMask>(bits(mask)) << part;
      }
      if (found)
        pairs_.set_end(
            write_pairs(pairs_.reserve(block_width), ids_[k], ids_.data() + first, found));
      if (first + 2 * block_width > lo_[0].size()) break;
    }
  }

  Coherence coherence_;
  SortedEnds<T> sorted_;
  std::size_t count_ = 0;
  int axis_ = 0;  ///< the axis swept along; the others follow in turn
  std::vector<T> lo_[3], hi_[3];
  std::vector<std::uint32_t> ids_;
  PairList pairs_;
};

}  // namespace bvlab
