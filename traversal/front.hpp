// SPDX-License-Identifier: BSD-3-Clause
/// The front of the bounding volume test tree (BVTT), which li1998incremental calls separation
/// list: the pairs of nodes at which the last recursion stopped. Every run tests all of them, a
/// witness first.
///
/// Invariant: the entries partition the product of the two bodies' leaves, so that every pair of
/// leaves lies below exactly one entry. Their order is free; entry 0 is tested first. It grows
/// until `restart`; RisingFront, which is derived from it, also shrinks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "traversal/node_pair.hpp"
#include "traversal/tracked_front.hpp"

namespace bvlab {

class Front : public FrontDefaults {
 public:
  std::size_t size() const { return entries_.size(); }
  bool empty() const { return entries_.empty(); }
  const NodePair& operator[](std::size_t slot) const { return entries_[slot]; }
  const std::vector<NodePair>& entries() const { return entries_; }

  /// Starts again from the two roots.
  void restart() {
    clear();
    entries_.push_back({0, 0});
    witnessed_ = false;
  }

  /// Starts from the entries of another front, its witness first.
  template <class Other>
  void restart_from(const Other& front) {
    entries_ = front.entries();
    witnessed_ = false;
    if (front.witnessed()) set_witness(front.witness());
  }

  void clear() { entries_.clear(), holes_.clear(), below_roots_ = false; }

  /// Starts again from the children of the two roots, which are known to overlap.
  void restart_below_roots() {
    clear();
    below_roots_ = true, witnessed_ = false;
  }

  template <class Traversal>
  bool sweep(Traversal& traversal) {
    if (enters_below_roots(traversal)) return false;
    const std::size_t entries = size(), first = witnessed();  // added entries are not retested
    if (first > 0 && traversal.test_entry(0)) return true;
    return traversal.test_entries(entries - first, [first](std::size_t i) { return first + i; });
  }

  /// The entry in `slot` is about to be replaced by its descendants: at least two calls of `add`
  /// follow for it, and the first fills its slot.
  void open(std::size_t slot) { holes_.push_back(static_cast<std::uint32_t>(slot)); }

  /// Adds an entry and returns its slot.
  std::size_t add(const NodePair& pair, EntryState = EntryState::not_yet, double = 0) {
    if (holes_.empty()) {
      entries_.push_back(pair);
      return entries_.size() - 1;
    }
    const std::size_t slot = holes_.back();
    holes_.pop_back();
    entries_[slot] = pair;
    return slot;
  }

  void finish(std::size_t witness, bool) {
    if (witness != Outcome::none) set_witness(witness);
  }

  /// Makes the entry in `slot` the first to be tested in the next run: exchanges it with entry 0.
  void set_witness(std::size_t slot) {
    std::swap(entries_[0], entries_[slot]);
    witnessed_ = true;
  }
  /// Whether entry 0 is a witness, brought forward since the last restart.
  bool witnessed() const { return witnessed_; }

 protected:
  template <class Traversal>
  bool enters_below_roots(Traversal& traversal) {
    if (!std::exchange(below_roots_, false)) return false;
    traversal.enter({0, 0});
    return true;
  }

  std::vector<NodePair> entries_;
  bool witnessed_ = false;

 private:
  std::vector<std::uint32_t> holes_;  // empty between runs
  bool below_roots_ = false;
};

/// The most entries that the list of a pair of bodies may have before it is rebuilt, whatever its
/// cost: 16 for each node of the two hierarchies. Runs that a hit cuts short cost little, so no
/// rule by cost rebuilds the list, and yet each may lengthen it.
template <class Pair>
std::size_t longest_list(const Pair& pair) {
  return 16 * (pair.a().extent().nodes + pair.b().extent().nodes);
}

}  // namespace bvlab
