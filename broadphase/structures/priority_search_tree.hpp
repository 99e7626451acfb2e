// SPDX-License-Identifier: BSD-3-Clause
/// Priority search trees over intervals that are inserted and removed (BibTeX:
/// mccreight1985priority): a search tree over the lower ends of all possible intervals, and a heap
/// on upper ends: each interval is on the path to its own leaf, and none is below one that ends
/// earlier. Insert and remove O(log n), query O(log n + found). Several trees share their arrays.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace bvlab {

template <class T>
struct Interval {
  T lo, hi;
};

template <class T>
class PrioritySearchTrees {
 public:
  /// A seat is a place for one rectangle in one tree (rectangle_store.hpp). Tree b may hold the
  /// seats [starts[b], starts[b + 1]); interval(seat) gives a seat's interval.
  template <class IntervalOf>
  void prepare(std::span<const std::uint32_t> starts, IntervalOf&& interval) {
    const std::uint32_t seats = starts.back();
    intervals_.resize(seats);
    for (std::uint32_t seat = 0; seat < seats; ++seat) intervals_[seat] = interval(seat);
    order_.resize(seats);
    rank_.resize(seats);
    roots_.resize(starts.size());
    starts_.assign(starts.begin(), starts.end());
    std::uint32_t nodes = 0;
    for (std::size_t b = 0; b + 1 < starts.size(); ++b) {
      for (std::uint32_t s = starts[b]; s < starts[b + 1]; ++s) order_[s] = s;
      std::sort(order_.begin() + starts[b], order_.begin() + starts[b + 1],
                [&](std::uint32_t x, std::uint32_t y) {
                  return intervals_[x].lo != intervals_[y].lo ? intervals_[x].lo < intervals_[y].lo
                                                              : x < y;
                });
      for (std::uint32_t s = starts[b]; s < starts[b + 1]; ++s) rank_[order_[s]] = s - starts[b];
      roots_[b] = nodes;
      nodes += 2 * leaves(static_cast<std::uint32_t>(b));
    }
    held_.assign(nodes, none);
  }

  void insert(std::uint32_t tree, std::uint32_t seat) {
    std::uint32_t* node = &held_[roots_[tree]];
    std::uint32_t half = leaves(tree), at = 1, first = 0;
    while (node[at] != none) {
      if (intervals_[seat].hi > intervals_[node[at]].hi) std::swap(seat, node[at]);
      half /= 2;
      const bool right = rank_[seat] >= first + half;
      first += right ? half : 0;
      at = 2 * at + right;
    }
    node[at] = seat;
  }

  /// The seat must be in the tree.
  void remove(std::uint32_t tree, std::uint32_t seat) {
    std::uint32_t* node = &held_[roots_[tree]];
    const std::uint32_t size = leaves(tree);
    std::uint32_t half = size, at = 1, first = 0;
    while (node[at] != seat) {
      half /= 2;
      const bool right = rank_[seat] >= first + half;
      first += right ? half : 0;
      at = 2 * at + right;
    }
    // The child that ends later moves up into the gap.
    for (; at < size;) {
      const std::uint32_t left = node[2 * at], right = node[2 * at + 1];
      if (left == none && right == none) break;
      const bool up_right =
          left == none || (right != none && intervals_[right].hi > intervals_[left].hi);
      node[at] = up_right ? right : left;
      at = 2 * at + up_right;
    }
    node[at] = none;
  }

  /// Calls visit(seat) for every inserted interval that overlaps `query`, both closed.
  template <class Visit>
  void find(std::uint32_t tree, Interval<T> query, Visit&& visit) const {
    if (starts_[tree] != starts_[tree + 1]) find_below(tree, 1, 0, leaves(tree), query, visit);
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;

  std::uint32_t leaves(std::uint32_t tree) const {
    const std::uint32_t count = starts_[tree + 1] - starts_[tree];
    return count ? std::bit_ceil(count) : 0;
  }
  template <class Visit>
  void find_below(std::uint32_t tree, std::uint32_t at, std::uint32_t first, std::uint32_t size,
                  Interval<T> query, Visit& visit) const {
    const std::uint32_t seat = held_[roots_[tree] + at];
    if (seat == none || intervals_[seat].hi < query.lo) return;  // none below ends later
    if (intervals_[seat].lo <= query.hi) visit(seat);
    if (size == 1) return;
    size /= 2;
    find_below(tree, 2 * at, first, size, query, visit);
    const std::uint32_t middle = starts_[tree] + first + size;
    if (middle < starts_[tree + 1] && intervals_[order_[middle]].lo <= query.hi)
      find_below(tree, 2 * at + 1, first + size, size, query, visit);
  }

  std::vector<Interval<T>> intervals_;       // per seat
  std::vector<std::uint32_t> rank_, order_;  // by lower end within the seat's tree, and back
  std::vector<std::uint32_t> starts_, roots_,
      held_;  // per tree; per node, the seat stored there
};

}  // namespace bvlab
