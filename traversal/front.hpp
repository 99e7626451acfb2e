// SPDX-License-Identifier: BSD-3-Clause
/// The front (the talk's separation list): the pairs of nodes at which the last recursion stopped.
///
/// Law: the entries partition the product of the two bodies' leaves, so that every pair of leaves
/// lies below exactly one entry. Order is free; entry 0 is tested first.
#pragma once

#include <cstdint>
#include <vector>

namespace bvlab {

struct NodePair {
  std::uint32_t a, b;
  friend bool operator==(const NodePair&, const NodePair&) = default;
};

class Front {
 public:
  std::size_t size() const { return entries_.size(); }
  bool empty() const { return entries_.empty(); }
  const NodePair& operator[](std::size_t slot) const { return entries_[slot]; }
  const std::vector<NodePair>& entries() const { return entries_; }

  /// Starts again from the two roots.
  void restart() {
    entries_.assign(1, NodePair{0, 0});
    witnessed_ = false;
  }

  void clear() { entries_.clear(); }

  /// The entry in `slot` is about to be replaced by what it ends in: at least two calls of `add`
  /// follow for it, and the first fills its place.
  void open(std::size_t slot) { holes_.push_back(static_cast<std::uint32_t>(slot)); }

  /// Adds an entry and says in which slot.
  std::size_t add(const NodePair& pair) {
    if (holes_.empty()) {
      entries_.push_back(pair);
      return entries_.size() - 1;
    }
    const std::size_t slot = holes_.back();
    holes_.pop_back();
    entries_[slot] = pair;
    return slot;
  }

  /// Makes the entry in `slot` the first to be tested next time.
  void bring_forward(std::size_t slot) {
    std::swap(entries_[0], entries_[slot]);
    witnessed_ = true;
  }
  /// Whether entry 0 has been brought forward since the last restart.
  bool witnessed() const { return witnessed_; }

 protected:
  std::vector<NodePair> entries_;
  bool witnessed_ = false;

 private:
  std::vector<std::uint32_t> holes_;  // empty between runs
};

}  // namespace bvlab
