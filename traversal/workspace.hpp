// SPDX-License-Identifier: BSD-3-Clause
/// Buffers that are reused from one traversal to the next, for all pairs of bodies.
#pragma once

#include <any>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "traversal/node_pair.hpp"
#include "traversal/queries/candidate.hpp"

namespace bvlab {

/// A stack of pairs waiting to be tested: `reserve` once, then `push` without a check.
class OpenPairs {
 public:
  void clear() { size_ = 0; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  /// Makes room for this number of further entries.
  void reserve(std::size_t more) {
    if (pairs_.size() < size_ + more) pairs_.resize(2 * (size_ + more));
  }
  void push(const NodePair& pair) {
    pairs_[size_++] = static_cast<std::uint64_t>(pair.b) << 32 | pair.a;
  }
  NodePair pop() {
    const std::uint64_t pair = pairs_[--size_];
    return {static_cast<std::uint32_t>(pair), static_cast<std::uint32_t>(pair >> 32)};
  }

 private:
  // Each pair is written and read as one word: a read that spans two writes waits until both have
  // reached the cache, and with them all volumes posed before.
  std::vector<std::uint64_t> pairs_;
  std::size_t size_ = 0;
};

struct Workspace {
  OpenPairs open;
  std::vector<Candidate> pending;

  /// Scratch space: one object per type T, in the state in which it was last left; valid until the
  /// next traversal with this workspace.
  template <class T>
  T& scratch() {
    for (std::any& each : rooms)
      if (T* found = std::any_cast<T>(&each)) return *found;
    return rooms.emplace_back().emplace<T>();
  }
  std::deque<std::any> rooms;
};

}  // namespace bvlab
