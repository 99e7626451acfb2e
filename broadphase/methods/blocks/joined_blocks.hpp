// SPDX-License-Identifier: BSD-3-Clause
/// Finds all pairs from scratch: boxes are sorted into blocks of sixteen neighbours, and the tree
/// of blocks is joined with itself.
#pragma once

#include <algorithm>

#include "broadphase/settings.hpp"
#include "broadphase/structures/block_tree.hpp"
#include "broadphase/structures/leaf_join.hpp"
#include "broadphase/structures/pair_shares.hpp"
#include "broadphase/structures/reported_pairs.hpp"
#include "broadphase/structures/row.hpp"
#include "broadphase/structures/spatial_order.hpp"

namespace bvlab {

/// Costs of the parts of a frame, in nanoseconds as measured once; only their ratios matter. Some
/// costs are higher where the data exceed the cache.
struct BlockCosts {
  /// Few boxes move where it is at most one in this many.
  static constexpr std::size_t few_times = 8;

  static constexpr double sort = 12;      ///< sort a box into spatial order
  static constexpr double visit = 36;     ///< visit a pair of leaves in the join
  static constexpr double pair = 1.3;     ///< write an overlapping pair
  static constexpr double report = 12;    ///< find whether a pair began or ended, by sorting
  static constexpr double read = 8;       ///< read a box that is followed
  static constexpr double fat_box = 10;   ///< make a fat box
  static constexpr double candidate = 3;  ///< write a candidate
  static constexpr double moved = 120;    ///< update the tree for a moved box
  static constexpr double leaf = 20;      ///< compare a moved box with a leaf

  /// Compare a candidate, of so many in all.
  static double test(double candidates) { return 16 * candidates < 3 * near ? 2.2 : 3.7; }
  /// Insert or erase a pair, in a list of so many.
  static double change(double pairs) {
    return 16 * pairs < 2 * near ? 60 : 16 * pairs < 32 * near ? 200 : 700;
  }

 private:
  static constexpr double near = 1 << 20;  ///< bytes in the cache of a processor
};

template <class T, class Contact>
class JoinedBlocks {
 public:
  explicit JoinedBlocks(const MethodSettings& settings)
      : settings_(settings), shares_(settings.threads) {}

  BlockTree<T>& tree() { return tree_; }
  const BlockTree<T>& tree() const { return tree_; }
  const SpatialOrder<T>& order() const { return order_; }
  SpatialOrder<T>& order() { return order_; }
  PairShares& shares() { return shares_; }

  /// The number of pairs of leaves visited by the last join from scratch.
  std::size_t visits() const { return visits_; }

  /// Whether a box moved farther in a frame than half a leaf, and so has other neighbours now.
  bool jumped(const Row<T>& now, const Row<T>& was) const {
    return !(static_cast<double>(largest_change(now, was)) <= leaf_extent_ / 2);
  }

  /// Builds the tree over the boxes in this order.
  void build(std::span<const Keyed<std::uint32_t>> order, Boxes<T> boxes) {
    tree_.build(order, boxes, shares_.threads());
    leaf_extent_ = tree_.mean_leaf_extent();
  }

  void from_scratch(Boxes<T> boxes, ReportedPairs& pairs) {
    build(order_(boxes, shares_.threads()), boxes);
    write_all_pairs(pairs);
  }

  /// Appends the pairs of boxes that overlap in the sense of `Sense`, by `write` as in LeafJoin,
  /// and returns the number of pairs of leaves visited. Threads write lists of their own, which are
  /// concatenated in the order that one thread would give.
  template <class Sense, class Write>
  std::size_t join_into(PairList& list, const Write& write) {
    std::size_t visits = 0;
    if (shares_.threads().count() == 1 || tree_.leaves() < leaves_worth_sharing) {
      LeafJoin<T, Sense, Write> join(tree_, list, write);
      tree_.join([&](std::uint32_t a, std::uint32_t first, LaneMask lanes) {
        visits += static_cast<std::size_t>(std::popcount(lanes));
        join.add(a, first, lanes);
      });
      join.flush();
      return visits;
    }
    tree_.join_parts(parts_);
    return join_parts_into<Sense>(tree_, parts_, list, write);
  }
  using Part = typename BlockTree<T>::Part;
  /// The same for some parts of a tree's join; pairs are appended to the list.
  template <class Sense, class Write>
  std::size_t join_parts_into(const BlockTree<T>& tree, std::span<const Part> parts, PairList& list,
                              const Write& write) {
    const auto join_some = [&](std::span<const Part> some, PairList& to) {
      LeafJoin<T, Sense, Write> join(tree, to, write);
      std::size_t count = 0;
      for (const Part& part : some)
        tree.join(part, [&](std::uint32_t a, std::uint32_t first, LaneMask lanes) {
          count += static_cast<std::size_t>(std::popcount(lanes));
          join.add(a, first, lanes);
        });
      join.flush();
      return count;
    };
    if (shares_.threads().count() == 1) return join_some(parts, list);
    std::vector<std::size_t> visited(shares_.threads().count() * 64);
    shares_(list, visited.size(), [&](std::size_t share, std::size_t of, PairList& to) {
      const std::size_t first = parts.size() * share / of;
      visited[share] = join_some(parts.subspan(first, parts.size() * (share + 1) / of - first), to);
    });
    std::size_t visits = 0;
    for (const std::size_t count : visited) visits += count;
    return visits;
  }

  /// Whether sorting these boxes would free at least one leaf.
  bool sorting_frees_a_leaf(std::size_t boxes) const {
    return tree_.slots() >= boxes + block_width;
  }

 private:
  /// Below this, waking a thread takes longer than the join.
  static constexpr std::uint32_t leaves_worth_sharing = 200;

  /// Joins the tree with itself, and writes the list of all pairs.
  void write_all_pairs(ReportedPairs& pairs) {
    const bool compare = settings_.changes == Changes::reported;
    if (compare) pairs.keep_before();
    PairList& list = pairs.all;
    list.clear();
    const std::uint32_t* ids = tree_.ids(0);
    visits_ = join_into<Contact>(
        list, [ids](Pair* out, std::uint32_t slot, std::uint32_t leaf, LaneMask lanes) {
          return write_pairs(out, ids[slot], ids + std::size_t{leaf} * block_width, lanes);
        });
    if (compare) pairs.compare_with_kept();
  }
  MethodSettings settings_;
  SpatialOrder<T> order_;
  BlockTree<T> tree_;
  PairShares shares_;
  std::vector<Part> parts_;
  double leaf_extent_ = 0;  ///< mean, after sorting
  std::size_t visits_ = 0;
};

}  // namespace bvlab
