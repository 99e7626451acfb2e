// SPDX-License-Identifier: BSD-3-Clause
/// The position of each pair in a list: a hash table with linear probing and backward-shift
/// deletion, so that it holds no tombstones. O(1) expected.
#pragma once

#include <bit>
#include <vector>

#include "broadphase/box.hpp"

namespace bvlab {

class PairSlots {
 public:
  static constexpr std::uint32_t none = 0xffffffffu;

  std::size_t size() const { return size_; }

  void clear() {
    if (size_) std::fill(cells_.begin(), cells_.end(), Cell{});
    size_ = 0;
  }
  std::uint32_t find(Pair pair) const {
    if (size_ == 0) return none;
    return cells_[place(pair)].slot;
  }
  void put(Pair pair, std::uint32_t slot) {
    if (2 * (size_ + 1) > cells_.size()) grow();
    Cell& cell = cells_[place(pair)];
    size_ += cell.slot == none;
    cell = {pair, slot};
  }
  void erase(Pair pair) {
    if (size_ == 0) return;
    std::size_t gap = place(pair);
    if (cells_[gap].slot == none) return;
    --size_;
    // Move entries that a collision pushed past the gap back into it.
    for (std::size_t k = next(gap); cells_[k].slot != none; k = next(k)) {
      const std::size_t wanted = home(cells_[k].pair);
      if (((k - wanted) & mask()) < ((k - gap) & mask())) continue;
      cells_[gap] = cells_[k];
      gap = k;
    }
    cells_[gap] = Cell{};
  }

 private:
  struct Cell {
    Pair pair{0, 0};
    std::uint32_t slot = none;
  };
  std::size_t mask() const { return cells_.size() - 1; }
  std::size_t next(std::size_t k) const { return (k + 1) & mask(); }
  std::size_t home(Pair pair) const {  // multiplicative hashing: bits of a product
    const std::uint64_t key = std::uint64_t{pair.i} << 32 | pair.j;
    return static_cast<std::size_t>((key * 0x9e3779b97f4a7c15u) >> 32) & mask();
  }
  /// The pair's cell, or the free cell where it would be put.
  std::size_t place(Pair pair) const {
    std::size_t k = home(pair);
    while (cells_[k].slot != none && cells_[k].pair != pair) k = next(k);
    return k;
  }
  void grow() {
    std::vector<Cell> old(cells_.empty() ? 64 : 2 * cells_.size());
    std::swap(old, cells_);
    size_ = 0;
    for (const Cell& cell : old)
      if (cell.slot != none) put(cell.pair, cell.slot);
  }

  std::vector<Cell> cells_;
  std::size_t size_ = 0;
};

}  // namespace bvlab
