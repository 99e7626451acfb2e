// SPDX-License-Identifier: BSD-3-Clause
/// A uniform grid: every box is listed in each cell that it overlaps, and the boxes of a cell are
/// compared sixteen at a time. A pair is reported once, in the cell of the componentwise maximum of
/// the two lower corners. O(n + k) where boxes are alike and spread out; else cells grow.
#pragma once

#include <vector>

#include "broadphase/settings.hpp"
#include "broadphase/structures/block.hpp"
#include "broadphase/structures/pair_list.hpp"
#include "broadphase/structures/voxels.hpp"

namespace bvlab {

template <class T, class Contact>
class Grid {
 public:
  using Scalar = T;
  static constexpr std::string_view name = "grid";
  static constexpr std::string_view description =
      "uniform grid, cells compared with vector comparisons";

  explicit Grid(const MethodSettings&) {}

  std::span<const Pair> overlapping(Boxes<T> boxes) {
    pairs_.clear();
    if (boxes.empty()) return pairs_.view();
    voxels_ = Voxels<T>(boxes, {true, true, true});
    // A table with many more entries than boxes would be mostly empty, so cells share entries.
    bits_ = std::bit_width(boxes.size());
    fill(boxes);
    for (std::size_t c = 0; c + 1 < starts_.size(); ++c)
      if (starts_[c + 1] - starts_[c] > 1) compare(boxes, static_cast<std::uint32_t>(c));
    return pairs_.view();
  }

 private:
  template <class Visit>
  void for_cells(const Box<T>& box, Visit&& visit) {
    const CellRange r = voxels_.range(box);
    mine_.clear();
    for (auto z = r.first[2]; z <= r.last[2]; ++z)
      for (auto y = r.first[1]; y <= r.last[1]; ++y)
        for (auto x = r.first[0]; x <= r.last[0]; ++x) mine_.push_back(place(x, y, z));
    if (mine_.size() > 1) {
      std::sort(mine_.begin(), mine_.end());
      mine_.erase(std::unique(mine_.begin(), mine_.end()), mine_.end());
    }
    for (const std::uint32_t cell : mine_) visit(cell);
  }
  /// The cell's table entry: row by row, modulo 2^bits.
  std::uint32_t place(std::int64_t x, std::int64_t y, std::int64_t z) const {
    const auto row = static_cast<std::uint64_t>(z) * static_cast<std::uint64_t>(voxels_.count(1)) +
                     static_cast<std::uint64_t>(y);
    const auto at =
        row * static_cast<std::uint64_t>(voxels_.count(0)) + static_cast<std::uint64_t>(x);
    return static_cast<std::uint32_t>(at & ((std::uint64_t{1} << bits_) - 1));
  }
  void fill(Boxes<T> boxes) {
    starts_.assign((std::size_t{1} << bits_) + 1, 0);
    for (const Box<T>& box : boxes) for_cells(box, [&](std::uint32_t c) { ++starts_[c + 1]; });
    for (std::size_t c = 1; c < starts_.size(); ++c) starts_[c] += starts_[c - 1];
    next_.assign(starts_.begin(), starts_.end() - 1);
    members_.resize(starts_.back());
    for (std::uint32_t k = 0; k < boxes.size(); ++k)
      for_cells(boxes[k], [&](std::uint32_t c) { members_[next_[c]++] = k; });
  }
  void compare(Boxes<T> boxes, std::uint32_t cell) {
    const std::uint32_t first = starts_[cell], last = starts_[cell + 1];
    Block<T> block;
    for (std::uint32_t s = first; s < last; s += block_width) {
      const int held = static_cast<int>(std::min<std::uint32_t>(block_width, last - s));
      for (int lane = 0; lane < block_width; ++lane)
        block.put(lane, lane < held ? boxes[members_[s + lane]] : nowhere<T>());
      for (std::uint32_t t = first; t < s + held; ++t) {
        const Box<T>& box = boxes[members_[t]];
        LaneMask found = overlapping_lanes<Contact>(block, box);
        if (t >= s) found &= all_lanes & (all_lanes << (t - s + 1));
        for (; found; found &= found - 1) {
          const std::uint32_t other = members_[s + std::countr_zero(found)];
          if (meeting_place(box, boxes[other]) == cell) pairs_.push(ordered(members_[t], other));
        }
      }
    }
  }
  std::uint32_t meeting_place(const Box<T>& a, const Box<T>& b) const {
    std::int32_t cell[3];
    for (int axis = 0; axis < 3; ++axis)
      cell[axis] = voxels_.cell(axis, std::max(a.lo[axis], b.lo[axis]));
    return place(cell[0], cell[1], cell[2]);
  }

  Voxels<T> voxels_;
  int bits_ = 1;
  std::vector<std::uint32_t> starts_, next_, members_, mine_;
  PairList pairs_;
};

}  // namespace bvlab
