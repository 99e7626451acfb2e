// SPDX-License-Identifier: BSD-3-Clause
/// Dynamic rectangle intersection, the problem that a plane sweep along z reduces to: insert and
/// remove rectangles, and report those that overlap a given one. No optimal structure is known; the
/// four substitutes of koziara2005bounding (section 3.3) are compositions of a bucket grid over x
/// and y, over x alone, or none, with a list or a priority search tree in each bucket.
#pragma once

#include <concepts>

#include "broadphase/structures/priority_search_tree.hpp"
#include "broadphase/structures/voxels.hpp"

namespace bvlab {

template <class T>
using Rectangle = Box<T>;  ///< its x and y; z does not matter

template <class T>
bool rectangles_overlap(const Rectangle<T>& a, const Rectangle<T>& b) {
  return a.lo[0] <= b.hi[0] && b.lo[0] <= a.hi[0] && a.lo[1] <= b.hi[1] && b.lo[1] <= a.hi[1];
}

/// All rectangles are known beforehand (`prepare`) and inserted and removed by index. A query
/// reports each inserted rectangle that overlaps (closed) once.
template <class S>
concept RectangleStore = requires(S store, Boxes<typename S::Scalar> all, std::uint32_t k) {
  store.prepare(all);
  store.insert(k);
  store.remove(k);
  store.overlapping(k, [](std::uint32_t) {});
};

/// Buckets whose members are linked lists. Query O(members).
template <class T>
class ListBuckets {
 public:
  void prepare(Boxes<T>, std::span<const std::uint32_t> starts, std::span<const std::uint32_t>) {
    first_.assign(starts.size() - 1, none);
    next_.resize(starts.back());
    before_.resize(starts.back());
  }
  /// `seat` numbers one membership of a rectangle in a bucket.
  void insert(std::uint32_t bucket, std::uint32_t seat) {
    next_[seat] = first_[bucket];
    before_[seat] = none;
    if (first_[bucket] != none) before_[first_[bucket]] = seat;
    first_[bucket] = seat;
  }
  void remove(std::uint32_t bucket, std::uint32_t seat) {
    if (next_[seat] != none) before_[next_[seat]] = before_[seat];
    (before_[seat] == none ? first_[bucket] : next_[before_[seat]]) = next_[seat];
  }
  template <class Visit>
  void find(std::uint32_t bucket, const Rectangle<T>&, Visit&& visit) const {
    for (std::uint32_t seat = first_[bucket]; seat != none; seat = next_[seat]) visit(seat);
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;
  std::vector<std::uint32_t> first_, next_, before_;
};

/// Buckets that are priority search trees along one axis. Query O(log members + those that overlap
/// on that axis).
template <class T, int Axis>
class TreeBuckets {
 public:
  void prepare(Boxes<T> all, std::span<const std::uint32_t> starts,
               std::span<const std::uint32_t> members) {
    trees_.prepare(starts, [&](std::uint32_t seat) {
      return Interval<T>{all[members[seat]].lo[Axis], all[members[seat]].hi[Axis]};
    });
  }
  void insert(std::uint32_t bucket, std::uint32_t seat) { trees_.insert(bucket, seat); }
  void remove(std::uint32_t bucket, std::uint32_t seat) { trees_.remove(bucket, seat); }
  template <class Visit>
  void find(std::uint32_t bucket, const Rectangle<T>& r, Visit&& visit) const {
    trees_.find(bucket, Interval<T>{r.lo[Axis], r.hi[Axis]}, visit);
  }

 private:
  PrioritySearchTrees<T> trees_;
};

/// A hash table of buckets over the grid cells of the axes that are cut. A pair is reported only in
/// the bucket of the cell of the componentwise maximum of the two lower corners, and a rectangle is
/// in a bucket at most once, so no pair is reported twice.
template <class T, class Buckets, bool CutX, bool CutY>
class BucketGrid {
 public:
  using Scalar = T;

  void prepare(Boxes<T> all) {
    all_ = all;
    voxels_ = Voxels<T>(all, {CutX, CutY, false});
    bits_ = CutX || CutY ? std::bit_width(all.size() | 1u) : 1;
    starts_.assign((std::size_t{1} << bits_) + 1, 0);
    seats_start_.resize(all.size() + 1);
    std::uint32_t seats = 0;
    for (std::uint32_t k = 0; k < all.size(); ++k) {
      seats_start_[k] = seats;
      for_buckets(k, [&](std::uint32_t bucket) { ++starts_[bucket + 1], ++seats; });
    }
    seats_start_.back() = seats;
    for (std::size_t b = 1; b < starts_.size(); ++b) starts_[b] += starts_[b - 1];
    fill_.assign(starts_.begin(), starts_.end() - 1);
    members_.resize(seats);
    seats_.resize(seats);
    buckets_of_.resize(seats);
    std::uint32_t at = 0;
    for (std::uint32_t k = 0; k < all.size(); ++k)
      for_buckets(k, [&](std::uint32_t bucket) {
        const std::uint32_t seat = fill_[bucket]++;
        members_[seat] = k;
        seats_[at] = seat;
        buckets_of_[at++] = bucket;
      });
    buckets_.prepare(all, starts_, members_);
  }
  void insert(std::uint32_t k) {
    for (std::uint32_t s = seats_start_[k]; s < seats_start_[k + 1]; ++s)
      buckets_.insert(buckets_of_[s], seats_[s]);
  }
  void remove(std::uint32_t k) {
    for (std::uint32_t s = seats_start_[k]; s < seats_start_[k + 1]; ++s)
      buckets_.remove(buckets_of_[s], seats_[s]);
  }
  template <class Visit>
  void overlapping(std::uint32_t k, Visit&& visit) const {
    const Rectangle<T>& mine = all_[k];
    for (std::uint32_t s = seats_start_[k]; s < seats_start_[k + 1]; ++s)
      buckets_.find(buckets_of_[s], mine, [&](std::uint32_t seat) {
        const std::uint32_t other = members_[seat];
        const Rectangle<T>& theirs = all_[other];
        if (!rectangles_overlap(mine, theirs)) return;
        if (CutX || CutY) {
          const auto x =
              CutX ? std::max(voxels_.cell(0, mine.lo[0]), voxels_.cell(0, theirs.lo[0])) : 0;
          const auto y =
              CutY ? std::max(voxels_.cell(1, mine.lo[1]), voxels_.cell(1, theirs.lo[1])) : 0;
          if (cell_bucket(x, y, 0, bits_) != buckets_of_[s]) return;
        }
        visit(other);
      });
  }

 private:
  /// Calls `visit` once for each bucket of the rectangle's cells.
  template <class Visit>
  void for_buckets(std::uint32_t k, Visit&& visit) {
    const CellRange r = voxels_.range(all_[k]);
    mine_.clear();
    for (auto x = CutX ? r.first[0] : 0; x <= (CutX ? r.last[0] : 0); ++x)
      for (auto y = CutY ? r.first[1] : 0; y <= (CutY ? r.last[1] : 0); ++y)
        mine_.push_back(CutX || CutY ? cell_bucket(x, y, 0, bits_) : 0);
    if (mine_.size() > 1) {
      std::sort(mine_.begin(), mine_.end());
      mine_.erase(std::unique(mine_.begin(), mine_.end()), mine_.end());
    }
    for (const std::uint32_t bucket : mine_) visit(bucket);
  }

  Boxes<T> all_;
  Voxels<T> voxels_;
  int bits_ = 1;
  Buckets buckets_;
  std::vector<std::uint32_t> starts_, fill_, members_, mine_;    // per bucket; per seat
  std::vector<std::uint32_t> seats_start_, seats_, buckets_of_;  // per rectangle; per seat of it
};

}  // namespace bvlab
