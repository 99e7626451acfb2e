// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "broadphase/settings.hpp"
#include "broadphase/structures/block_tree.hpp"
#include "broadphase/structures/pair_list.hpp"
#include "broadphase/structures/spatial_order.hpp"

namespace bvlab {

template <class T, class Contact>
class Blocks {
 public:
  using Scalar = T;
  static constexpr std::string_view name = "blocks";
  static constexpr std::string_view description =
      "blocks of sixteen neighbours, joined by vector comparisons";
  explicit Blocks(const Settings&) {}

  std::span<const Pair> overlapping(Boxes<T> boxes) {
    tree_.build(order_(boxes), boxes);
    pairs_.clear();
    tree_.join([&](std::uint32_t a, std::uint32_t b) {
      Pair* out = pairs_.room_for(block_width * block_width + block_width);
      const Loaded<T> right(tree_.leaf(b));
      if (a == b) {
        const Block<T>& left = tree_.leaf(a);
        const std::uint32_t* ids = tree_.ids(a);
        for (int row = 0; row < block_width - 1; ++row)
          out = write_pairs(
              out, ids[row], ids,
              right.template overlapping<Contact>(left.box(row)) & (all_lanes << (row + 1)));
      } else {
        Lanes rows = overlapping_lanes<Closed>(tree_.leaf(a), tree_.reach(b)),
              columns = right.template overlapping<Closed>(tree_.reach(a));
        if (std::popcount(rows) <= std::popcount(columns))
          out = cross(out, a, b, right, rows);
        else
          out = cross(out, b, a, Loaded<T>(tree_.leaf(a)), columns);
      }
      pairs_.end_at(out);
    });
    return pairs_.view();
  }

 public:
  Pair* cross(Pair* out, std::uint32_t a, std::uint32_t b, const Loaded<T>& right, Lanes rows) {
    const Block<T>& left = tree_.leaf(a);
    const std::uint32_t* left_ids = tree_.ids(a);
    const std::uint32_t* right_ids = tree_.ids(b);
    for (; rows; rows &= rows - 1) {
      const int row = std::countr_zero(rows);
      out = write_pairs(out, left_ids[row], right_ids,
                        right.template overlapping<Contact>(left.box(row)));
    }
    return out;
  }
  SpatialOrder<T> order_;
  BlockTree<T> tree_;
  PairList pairs_;
};

}  // namespace bvlab
