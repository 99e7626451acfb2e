// SPDX-License-Identifier: BSD-3-Clause
/// Compares the boxes of pairs of leaves, some hundred pairs at a time, in three long loops: which
/// boxes of the first leaf overlap the second leaf's bounds; which of the two leaves has fewer such
/// boxes; each of these with all sixteen of the other leaf. A loop per pair of leaves would have
/// three rounds on average and often none, so that its branches would be mispredicted.
#pragma once

#include <bit>
#include <cstdint>

#include "broadphase/structures/block_tree.hpp"
#include "broadphase/structures/pair_list.hpp"

namespace bvlab {

/// `Write`: write(out, slot, leaf, lanes) writes an entry for the box in `slot` and each box in
/// `lanes` of `leaf`, and returns the end of what it wrote, as `write_pairs` does.
template <class T, class Contact, class Write>
class LeafJoin {
 public:
  /// Appends the pairs found to `list`.
  LeafJoin(const BlockTree<T>& tree, PairList& list, Write write)
      : tree_(tree), list_(list), write_(write) {}

  /// Adds the pairs of leaf `a` with leaf `first` + lane for every lane of `lanes`, none of them
  /// earlier than `a`.
  void add(std::uint32_t a, std::uint32_t first, LaneMask lanes) {
    count_ += write_lanes(b_ + count_, a_ + count_, first, a, lanes);
    if (count_ > most - block_width) flush();
  }
  /// Compares all pairs of leaves added since the last flush.
  void flush() {
    if (count_ == 0) return;
    const std::uint32_t done = a_[count_ - 1];
    std::size_t reach = 0;
    for (std::size_t k = 0; k < count_; ++k) {
      const std::uint32_t a = a_[k], b = b_[k];
      a_[reach] = a, b_[reach] = b;
      rows_of_a_[reach] = reaching(a, b);
      reach += rows_of_a_[reach] != 0;
    }
    std::size_t rows = 0;
    for (std::size_t k = 0; k < reach; ++k) {
      const std::uint32_t a = a_[k], b = b_[k];
      const LaneMask of_a = rows_of_a_[k], of_b = reaching(b, a);
      const bool swap = std::popcount(of_b) < std::popcount(of_a);
      rows += write_lanes(slots_ + rows, others_ + rows, (swap ? b : a) * block_width, swap ? a : b,
                          swap ? of_b : of_a);
      if (rows > most_rows - block_width) compare(rows, done), rows = 0;
    }
    compare(rows, done);
    count_ = 0;
  }

 private:
  static constexpr std::size_t most = 256, most_rows = 128;

  /// The boxes of leaf `a` that overlap the bounds of leaf `b`.
  LaneMask reaching(std::uint32_t a, std::uint32_t b) const {
    return overlapping_lanes<Closed>(tree_.leaf(a), tree_.leaf_bounds(b));
  }

  void compare(std::size_t rows, std::uint32_t done) {
    Pair* out = list_.reserve((rows + 1) * block_width, done, tree_.leaves());
    for (std::size_t k = 0; k < rows; ++k) {
      const std::uint32_t slot = slots_[k], other = others_[k];
      const std::uint32_t leaf = slot / block_width, lane = slot % block_width;
      const LaneMask found = overlapping_lanes<Contact>(
          tree_.leaf(other), tree_.leaf(leaf).box(static_cast<int>(lane)));
      // Within one leaf, a box is compared with the boxes after it.
      const LaneMask behind = leaf == other ? all_lanes & (all_lanes << (lane + 1)) : all_lanes;
      out = write_(out, slot, other, found & behind);
    }
    list_.set_end(out);
  }

  const BlockTree<T>& tree_;
  PairList& list_;
  Write write_;
  std::size_t count_ = 0;
  std::uint32_t a_[most], b_[most];  ///< pairs of leaves
  LaneMask rows_of_a_[most];
  std::uint32_t slots_[most_rows], others_[most_rows];  ///< a box, and the leaf that it overlaps
};

}  // namespace bvlab
