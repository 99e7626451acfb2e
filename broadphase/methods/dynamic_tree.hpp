// SPDX-License-Identifier: BSD-3-Clause
/// A binary tree of fat boxes, into which boxes are inserted one by one where they enlarge it least
/// (BibTeX: catto2019dynamic). A fat box is a tenth of its box wider on each side; a box that
/// leaves it is removed and inserted again. Then every box queries the tree: O(n log n + k) a frame
/// where the tree is balanced, which only the cost rule aims at.
#pragma once

#include <vector>

#include "broadphase/settings.hpp"
#include "broadphase/structures/block.hpp"
#include "broadphase/structures/pair_list.hpp"

namespace bvlab {

template <class T, class Contact>
class DynamicTree {
 public:
  using Scalar = T;
  static constexpr std::string_view name = "dynamic-tree";
  static constexpr std::string_view description =
      "binary tree of fattened boxes, re-inserted when they escape";

  explicit DynamicTree(const MethodSettings& settings) : coherence_(settings.coherence) {}

  std::span<const Pair> overlapping(Boxes<T> boxes) {
    pairs_.clear();
    if (coherence_ == Coherence::off) nodes_.clear(), free_.clear(), leaf_.clear(), root_ = none;
    while (leaf_.size() > boxes.size()) {
      take_out(leaf_.back());
      free_.push_back(leaf_.back());
      leaf_.pop_back();
    }
    for (std::uint32_t k = 0; k < leaf_.size(); ++k)
      if (!inside(boxes[k], nodes_[leaf_[k]].box)) {
        take_out(leaf_[k]);
        nodes_[leaf_[k]].box = fat(boxes[k]);
        put_in(leaf_[k]);
      }
    for (auto k = static_cast<std::uint32_t>(leaf_.size()); k < boxes.size(); ++k) {
      const std::uint32_t node = make_node();
      nodes_[node] = {fat(boxes[k]), none, none, k};  // parent, right; left holds its box index
      leaf_.push_back(node);
      put_in(node);
    }
    for (std::uint32_t k = 0; k < boxes.size(); ++k) query(boxes, k);
    return pairs_.view();
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;
  struct Node {
    Box<T> box;
    std::uint32_t parent = none, right = none;
    std::uint32_t left = none;  ///< of a leaf, whose right is none: the index of its box
  };
  bool is_leaf(std::uint32_t node) const { return nodes_[node].right == none; }

  static Box<T> fat(Box<T> box) {
    for (int axis = 0; axis < 3; ++axis) {
      const T margin = (box.hi[axis] / 2 - box.lo[axis] / 2) / 5;
      box.lo[axis] -= margin, box.hi[axis] += margin;
    }
    return box;
  }
  static bool inside(const Box<T>& a, const Box<T>& b) {
    return a.lo[0] >= b.lo[0] && a.lo[1] >= b.lo[1] && a.lo[2] >= b.lo[2] && a.hi[0] <= b.hi[0] &&
           a.hi[1] <= b.hi[1] && a.hi[2] <= b.hi[2];
  }
  /// Half the surface area, a measure of the expected cost of visiting a node.
  static double area(const Box<T>& b) {
    double e[3];
    for (int axis = 0; axis < 3; ++axis)
      e[axis] = static_cast<double>(b.hi[axis]) - static_cast<double>(b.lo[axis]);
    return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
  }

  std::uint32_t make_node() {
    if (free_.empty()) {
      nodes_.emplace_back();
      return static_cast<std::uint32_t>(nodes_.size() - 1);
    }
    const std::uint32_t node = free_.back();
    free_.pop_back();
    return node;
  }

  void put_in(std::uint32_t leaf) {
    nodes_[leaf].parent = none;
    if (root_ == none) {
      root_ = leaf;
      return;
    }
    const Box<T> box = nodes_[leaf].box;
    std::uint32_t at = root_;
    while (!is_leaf(at)) {  // stop here, or into the child that grows less
      const Node& node = nodes_[at];
      const double here = area(enclosing(node.box, box));
      const double pushed = 2 * (here - area(node.box));
      const auto cost = [&](std::uint32_t child) {
        const double grown = area(enclosing(nodes_[child].box, box));
        return pushed + (is_leaf(child) ? grown : grown - area(nodes_[child].box));
      };
      const double left = cost(node.left), right = cost(node.right);
      if (2 * here < left && 2 * here < right) break;
      at = left < right ? node.left : node.right;
    }
    const std::uint32_t branch = make_node(), parent = nodes_[at].parent;
    nodes_[branch] = {enclosing(nodes_[at].box, box), parent, leaf, at};
    replace_child(parent, at, branch);
    nodes_[at].parent = nodes_[leaf].parent = branch;
    refit(parent);
  }
  void take_out(std::uint32_t leaf) {
    const std::uint32_t branch = nodes_[leaf].parent;
    if (branch == none) {
      root_ = none;
      return;
    }
    const std::uint32_t sibling =
        nodes_[branch].left == leaf ? nodes_[branch].right : nodes_[branch].left;
    const std::uint32_t parent = nodes_[branch].parent;
    replace_child(parent, branch, sibling);
    nodes_[sibling].parent = parent;
    free_.push_back(branch);
    refit(parent);
  }
  void replace_child(std::uint32_t parent, std::uint32_t old, std::uint32_t child) {
    if (parent == none)
      root_ = child;
    else
      (nodes_[parent].left == old ? nodes_[parent].left : nodes_[parent].right) = child;
  }
  void refit(std::uint32_t node) {
    for (; node != none; node = nodes_[node].parent) {
      const Box<T> box = enclosing(nodes_[nodes_[node].left].box, nodes_[nodes_[node].right].box);
      if (box == nodes_[node].box) return;
      nodes_[node].box = box;
    }
  }

  void query(Boxes<T> boxes, std::uint32_t k) {
    stack_.assign(1, root_);
    while (!stack_.empty()) {
      const std::uint32_t at = stack_.back();
      stack_.pop_back();
      if (!overlap<Closed>(nodes_[at].box, boxes[k])) continue;
      if (!is_leaf(at)) {
        stack_.push_back(nodes_[at].left);
        stack_.push_back(nodes_[at].right);
      } else if (const std::uint32_t other = nodes_[at].left;
                 other > k && overlap<Contact>(boxes[other], boxes[k])) {
        pairs_.push({k, other});
      }
    }
  }

  Coherence coherence_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> free_, leaf_, stack_;
  std::uint32_t root_ = none;
  PairList pairs_;
};

}  // namespace bvlab
