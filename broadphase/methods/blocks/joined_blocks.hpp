// SPDX-License-Identifier: BSD-3-Clause
/// What `blocks` does without coherence, and with the order alone: boxes sorted into blocks of
/// sixteen neighbours, the tree of blocks joined with itself into all pairs; or the tree refitted
/// in the order of an earlier frame and joined again.
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

/// What the parts of a frame cost, in units of a nanosecond or so, as measured once; what counts is
/// their ratios.
struct BlockCosts {
  static constexpr double sort = 12;      ///< a box into spatial order
  static constexpr double visit = 36;     ///< a pair of leaves in the join
  static constexpr double pair = 1.3;     ///< an overlapping pair, written
  static constexpr double look = 4.5;     ///< a box, followed
  static constexpr double test = 1.8;     ///< a candidate, compared
  static constexpr double fat_box = 10;   ///< a fat box, made
  static constexpr double candidate = 3;  ///< a candidate, written
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

  /// Pairs of leaves that the join right after the last sort visited.
  std::size_t fresh_visits() const { return fresh_visits_; }

  /// Whether a box went farther in a frame than half a leaf: its neighbours are others now.
  bool jumped(const Row<T>& now, const Row<T>& was) const {
    return !(static_cast<double>(largest_change(now, was)) <= leaf_extent_ / 2);
  }

  /// Builds the tree of the boxes in this order.
  void build(std::span<const Keyed<std::uint32_t>> order, Boxes<T> boxes) {
    tree_.build(order, boxes, shares_.threads());
    leaf_extent_ = tree_.mean_leaf_extent();
  }

  void from_scratch(Boxes<T> boxes, ReportedPairs& pairs) {
    build(order_(boxes, shares_.threads()), boxes);
    write_all_pairs(pairs);
    fresh_visits_ = visits_;
  }

  /// Joins the tree again with the leaves' bounds as they are; false where a new order costs less
  /// than what boxes, spread since the last one, are going to add to the join.
  bool refit(Boxes<T> boxes, ReportedPairs& pairs) {
    const double spread = static_cast<double>(visits_) - static_cast<double>(fresh_visits_);
    if (holey(boxes.size()) || BlockCosts::visit * (spread + spreading_) >
                                   BlockCosts::sort * static_cast<double>(boxes.size())) {
      spreading_ *= 0.9;  // to be tried again some time
      return false;
    }
    for (std::uint32_t k = 0; k < tree_.leaves(); ++k) {
      gather(tree_.leaf(k), tree_.ids(k), boxes);
      tree_.set_leaf_bounds(k, bounds(tree_.leaf(k)));
    }
    tree_.refit_above();
    const std::size_t before = visits_;
    write_all_pairs(pairs);
    spreading_ = std::max(0.0, static_cast<double>(visits_) - static_cast<double>(before));
    return true;
  }

  /// Writes the pairs of boxes that overlap in the sense of `Sense` to the list by `write`, as
  /// LeafJoin does, and says how many pairs of leaves were visited. Threads have lists of their
  /// own, which are put together in the order of one.
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
    std::vector<std::size_t> visited(shares_.threads().count() * 64);
    shares_(list, visited.size(), [&](std::size_t share, std::size_t of, PairList& to) {
      LeafJoin<T, Sense, Write> join(tree_, to, write);
      std::size_t count = 0;
      for (std::size_t k = parts_.size() * share / of; k < parts_.size() * (share + 1) / of; ++k)
        tree_.join(parts_[k], [&](std::uint32_t a, std::uint32_t first, LaneMask lanes) {
          count += static_cast<std::size_t>(std::popcount(lanes));
          join.add(a, first, lanes);
        });
      join.flush();
      visited[share] = count;
    });
    for (const std::size_t count : visited) visits += count;
    return visits;
  }

  /// Whether slots are empty that sorting these boxes would fill.
  bool holey(std::size_t boxes) const { return tree_.slots() >= boxes + block_width; }

  std::size_t bytes() const { return tree_.bytes() + order_.bytes() + shares_.bytes(); }

 private:
  /// Below this a thread takes longer to wake than the join does.
  static constexpr std::uint32_t leaves_worth_sharing = 200;

  /// Joins the tree with itself into the list of pairs.
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
  std::vector<typename BlockTree<T>::Part> parts_;
  double leaf_extent_ = 0;  ///< mean, after sorting
  std::size_t visits_ = 0, fresh_visits_ = 0;
  double spreading_ = 0;  ///< visits that the last refit added
};

}  // namespace bvlab
