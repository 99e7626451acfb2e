// SPDX-License-Identifier: BSD-3-Clause
/// A linear BVH: a complete binary tree over the boxes in Morton order, fitted bottom up and
/// queried by every box (BibTeX: lauterbach2009fast). O(n) to sort, O(n log n + k) for the
/// queries. With coherence the order is kept and the tree refitted until its bounds have grown by
/// half.
#pragma once

#include "broadphase/settings.hpp"
#include "broadphase/structures/pair_list.hpp"
#include "broadphase/structures/spatial_order.hpp"

namespace bvlab {

template <class T, class Contact>
class Lbvh {
 public:
  using Scalar = T;
  static constexpr std::string_view name = "lbvh";
  static constexpr std::string_view description =
      "binary tree over the Morton order, asked box by box";

  explicit Lbvh(const MethodSettings& settings) : coherence_(settings.coherence) {}

  std::span<const Pair> overlapping(Boxes<T> boxes) {
    pairs_.clear();
    if (boxes.empty()) return pairs_.view();
    const bool keep = coherence_ == Coherence::on && ids_.size() == boxes.size();
    if (!keep) sort(boxes);
    fit(boxes);
    if (keep && spread() > 1.5 * spread_) sort(boxes), fit(boxes);
    if (!kept_spread_) spread_ = spread(), kept_spread_ = true;
    for (std::uint32_t k = 0; k < ids_.size(); ++k) query(k);
    return pairs_.view();
  }

 private:
  void sort(Boxes<T> boxes) {
    const auto order = order_(boxes);
    ids_.resize(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) ids_[k] = order[k].id;
    leaves_ = std::bit_ceil(static_cast<std::uint32_t>(order.size()));
    nodes_.assign(2 * std::size_t{leaves_}, nowhere<T>());
    kept_spread_ = false;
  }
  /// Node k has children 2k and 2k+1; leaf p of the order is node leaves_ + p.
  void fit(Boxes<T> boxes) {
    for (std::size_t p = 0; p < ids_.size(); ++p) nodes_[leaves_ + p] = boxes[ids_[p]];
    for (std::uint32_t k = leaves_ - 1; k > 0; --k)
      nodes_[k] = enclosing(nodes_[2 * k], nodes_[2 * k + 1]);
  }
  /// The sum of the extents, over all axes, of nodes a few levels above the leaves.
  double spread() const {
    double sum = 0;
    for (std::uint32_t k = std::max(1u, leaves_ / 8); k < std::max(2u, leaves_ / 4); ++k)
      for (int axis = 0; axis < 3; ++axis)
        if (nodes_[k].lo[axis] <= nodes_[k].hi[axis])
          sum += static_cast<double>(nodes_[k].hi[axis]) - static_cast<double>(nodes_[k].lo[axis]);
    return sum;
  }
  /// Reports the leaves after leaf p that overlap it, by descending into each later subtree whose
  /// bounds do.
  void query(std::uint32_t p) {
    const Box<T>& box = nodes_[leaves_ + p];
    std::uint32_t node = leaves_ + p;
    for (;;) {  // the next subtree in order: up while a right child, then across
      while (node & 1) node /= 2;
      if (node == 0) return;
      node += 1;
      descend(node, box, p);
      if ((node & (node + 1)) == 0) return;  // the last node of its level
    }
  }
  void descend(std::uint32_t node, const Box<T>& box, std::uint32_t p) {
    if (!overlap<Closed>(nodes_[node], box)) return;
    if (node < leaves_) {
      descend(2 * node, box, p);
      descend(2 * node + 1, box, p);
    } else if (std::is_same_v<Contact, Closed> || overlap<Contact>(nodes_[node], box)) {
      pairs_.push(ordered(ids_[p], ids_[node - leaves_]));
    }
  }

  Coherence coherence_;
  SpatialOrder<T> order_;
  std::vector<std::uint32_t> ids_;
  std::uint32_t leaves_ = 0;
  std::vector<Box<T>> nodes_;
  double spread_ = 0;
  bool kept_spread_ = false;
  PairList pairs_;
};

}  // namespace bvlab
