// SPDX-License-Identifier: BSD-3-Clause
/// HASH2 (koziara2005bounding): voxels of the boxes' average size, hashed. Boxes are sorted along
/// x, distributed to buckets in that order, and scanned. A pair is reported once, in the voxel of
/// the componentwise maximum of the two lower corners. O(n + k) for boxes that are alike and spread
/// out, O(n^2) for crowded ones. Boxes migrate between buckets, so coherence has no effect.
#pragma once

#include "broadphase/settings.hpp"
#include "broadphase/structures/pair_list.hpp"
#include "broadphase/structures/sorted_ends.hpp"
#include "broadphase/structures/voxels.hpp"

namespace bvlab {

template <class T, class Contact>
class Hash {
 public:
  using Scalar = T;
  static constexpr std::string_view name = "hash";
  static constexpr std::string_view description =
      "hashed voxels of average size, each scanned along x";

  explicit Hash(const MethodSettings& settings) : sorted_(Coherence::off, settings.sort) {}

  std::span<const Pair> overlapping(Boxes<T> boxes) {
    pairs_.clear();
    if (boxes.empty()) return pairs_.view();
    fill(boxes);
    for (std::size_t b = 0; b + 1 < starts_.size(); ++b) scan(boxes, static_cast<std::uint32_t>(b));
    return pairs_.view();
  }

 private:
  void fill(Boxes<T> boxes) {
    voxels_ = Voxels<T>(boxes, {true, true, true});
    bits_ = std::bit_width(boxes.size());
    const auto order = sorted_(static_cast<std::uint32_t>(boxes.size()),
                               [&](std::uint32_t k) { return boxes[k].lo[0]; });
    starts_.assign((std::size_t{1} << bits_) + 1, 0);
    for (const auto& item : order)
      for_buckets(boxes[item.id], [&](std::uint32_t b) { ++starts_[b + 1]; });
    for (std::size_t b = 1; b < starts_.size(); ++b) starts_[b] += starts_[b - 1];
    fill_.assign(starts_.begin(), starts_.end() - 1);
    members_.resize(starts_.back());
    for (const auto& item : order)
      for_buckets(boxes[item.id], [&](std::uint32_t b) { members_[fill_[b]++] = item.id; });
  }
  template <class Visit>
  void for_buckets(const Box<T>& box, Visit&& visit) {
    const CellRange r = voxels_.range(box);
    mine_.clear();
    for (auto x = r.first[0]; x <= r.last[0]; ++x)
      for (auto y = r.first[1]; y <= r.last[1]; ++y)
        for (auto z = r.first[2]; z <= r.last[2]; ++z) mine_.push_back(cell_bucket(x, y, z, bits_));
    if (mine_.size() > 1) {
      std::sort(mine_.begin(), mine_.end());
      mine_.erase(std::unique(mine_.begin(), mine_.end()), mine_.end());
    }
    for (const std::uint32_t bucket : mine_) visit(bucket);
  }
  void scan(Boxes<T> boxes, std::uint32_t bucket) {
    for (std::uint32_t s = starts_[bucket]; s < starts_[bucket + 1]; ++s) {
      const Box<T>& a = boxes[members_[s]];
      for (std::uint32_t t = s + 1; t < starts_[bucket + 1] && boxes[members_[t]].lo[0] <= a.hi[0];
           ++t) {
        const Box<T>& b = boxes[members_[t]];
        if (overlap<Contact>(a, b) && meeting_bucket(a, b) == bucket)
          pairs_.push(ordered(members_[s], members_[t]));
      }
    }
  }
  std::uint32_t meeting_bucket(const Box<T>& a, const Box<T>& b) const {
    std::int32_t cell[3];
    for (int axis = 0; axis < 3; ++axis)
      cell[axis] = voxels_.cell(axis, std::max(a.lo[axis], b.lo[axis]));
    return cell_bucket(cell[0], cell[1], cell[2], bits_);
  }

  Voxels<T> voxels_;
  int bits_ = 1;
  SortedEnds<T> sorted_;
  std::vector<std::uint32_t> starts_, fill_, members_, mine_;
  PairList pairs_;
};

}  // namespace bvlab
