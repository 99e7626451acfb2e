// SPDX-License-Identifier: BSD-3-Clause
/// The front of two wide trees. It has two kinds of entries. A step has the lanes that it opened,
/// and the least gap of the others. A pair whose triangles were tested has their gap, once that has
/// been measured; it is a triangle and a leaf (kernel siblings) or two leaves (kernel mixed). Each
/// gap is kept with the sphere at which it was measured (measured_gaps.hpp).
///
/// Law: every pair of triangles lies below an unopened lane of exactly one entry, or in one entry
/// of triangles.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "traversal/measured_gaps.hpp"
#include "traversal/node_pair.hpp"

namespace bvlab {

class WideFront {
 public:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  struct Entry {
    NodePair pair;          ///< of a step, or of tested triangles
    std::uint16_t opened;   ///< the opened lanes of a step
    std::uint8_t triangle;  ///< 1 for a pair of tested triangles
    std::uint8_t rest;      ///< its gap is measured again in the test that makes this 0
  };

  std::size_t size() const { return entries_.size(); }
  bool is_complete() const { return complete_at_ > 0; }
  void clear() { entries_.clear(), gaps_.clear(), complete_at_ = 0; }
  void complete() { complete_at_ = entries_.size(); }
  /// Whether the front is so much longer than when it was complete that it should be rebuilt.
  bool overgrown() const { return entries_.size() > 2 * complete_at_ + 16; }

  Entry& operator[](std::size_t i) { return entries_[i]; }
  /// Adds an entry whose gap is not known; returns its index.
  std::size_t add(const Entry& entry) {
    entries_.push_back(entry);
    gaps_.add();
    return entries_.size() - 1;
  }
  MeasuredGaps& gaps() { return gaps_; }
  const MeasuredGaps& gaps() const { return gaps_; }

 private:
  std::vector<Entry> entries_;
  MeasuredGaps gaps_;
  std::size_t complete_at_ = 0;
};

/// Pauses of the front: traversals without one after a front that wore out.
class FrontPause {
 public:
  /// Counts one traversal; returns whether it may keep a front.
  bool over() { return remaining_ == 0 || (--remaining_, false); }
  /// Called when a front was retested: one that wore out starts a pause, longer each time.
  void begin(bool worn) {
    if (worn) remaining_ = next_;
    next_ = worn ? std::min(4 * next_, longest) : shortest;
  }

 private:
  static constexpr int shortest = 16, longest = 256;
  int remaining_ = 0, next_ = shortest;
};

}  // namespace bvlab
