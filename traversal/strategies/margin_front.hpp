// SPDX-License-Identifier: BSD-3-Clause
/// A front whose entries are not tested before their deadlines. A deadline is a time on the clock
/// of an approach (relative_motion_bound.hpp). Until the clock shows that time, nothing below the
/// entry can touch; or, for an entry whose triangles have been tested, no verdict can have changed.
///
/// More precisely, an entry with deadline e stands for surfaces at least e - now apart: for a query
/// with limit l it is due only if e <= now + l. Deadlines are in an array of their own and are
/// compared a register at a time: 16 entries in two or three instructions. For fronts of less than
/// some ten thousand entries that is cheaper than keeping them ordered, and nothing has to be moved
/// when a deadline changes.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "hierarchies/geometry/scalar.hpp"
#include "traversal/node_pair.hpp"

namespace bvlab {

/// A pair of triangles that share a point, at least until the deadline.
struct KnownHit {
  std::uint32_t slot;
  float deadline;
  std::uint32_t a, b;
};

/// A float slightly below x: half a unit in the last place is lost to each of two roundings; the
/// last term covers underflow. For any x: a value beyond the largest float becomes one below it,
/// since an infinite deadline would become NaN when something is subtracted from it, and would
/// never pass.
inline float just_below(double x) {
  const auto y = static_cast<float>(std::min(x, double{std::numeric_limits<float>::max()}));
  return y - std::abs(y) * 0x1p-22f - std::numeric_limits<float>::min();
}
inline float just_above(double x) { return -just_below(-x); }

class MarginFront {
 public:
  static constexpr float passed = -std::numeric_limits<float>::infinity();
  static constexpr std::uint32_t nowhere = static_cast<std::uint32_t>(-1);

  std::size_t size() const { return entries_.size(); }
  bool empty() const { return entries_.empty(); }
  const NodePair& operator[](std::size_t slot) const { return entries_[slot]; }
  const std::vector<NodePair>& entries() const { return entries_; }

  /// Starts again from the two roots.
  void restart() {
    entries_.assign(1, NodePair{0, 0});
    deadlines_.assign(1, passed);
    earliest_ = passed;
    hits_.clear();
    witness_ = nowhere;
  }

  void clear() {
    entries_.clear();
    deadlines_.clear();
    hits_.clear();
    witness_ = nowhere;
  }

  void open(std::size_t slot) { holes_.push_back(static_cast<std::uint32_t>(slot)); }

  /// Adds an entry and returns its slot. An entry whose deadline has passed is due.
  std::size_t add(const NodePair& pair, double deadline = passed) {
    std::size_t slot = entries_.size();
    if (holes_.empty()) {
      entries_.push_back(pair);
      deadlines_.push_back(passed);
    } else {
      slot = holes_.back();
      holes_.pop_back();
      entries_[slot] = pair;
    }
    expire_at(slot, deadline);
    return slot;
  }

  void expire_at(std::size_t slot, double deadline) {
    // Written so that a deadline of NaN has passed.
    deadlines_[slot] = deadline > passed ? just_below(deadline) : passed;
    earliest_ = std::min(earliest_, deadlines_[slot]);
  }

  /// Moves the deadline to an earlier time, never to a later one.
  void expire_by(std::size_t slot, double deadline) {
    const float before = deadlines_[slot];
    expire_at(slot, deadline);
    deadlines_[slot] = std::min(deadlines_[slot], before);
  }

  /// Makes the next run test entries that were collected and got no new deadline, because the
  /// traversal was cut short.
  void leave_rest() { earliest_ = passed; }

  /// A lower bound on all deadlines.
  float earliest() const { return earliest_; }

  /// Slots whose deadlines are not above `time`, in order. The caller gives them new deadlines.
  void collect(double time, std::vector<std::uint32_t>& due) {
    using Some = stdx::native_simd<float>;
    constexpr std::size_t width = Some::size();
    const float limit = just_above(time);
    const std::size_t n = deadlines_.size();
    due.resize(n);
    std::size_t found = 0;
    Some earliest = -passed;
    for (std::size_t first = 0; first < n; first += width) {
      Some some = -passed;
      if (first + width <= n)
        some.copy_from(&deadlines_[first], stdx::element_aligned);
      else
        for (std::size_t i = first; i < n; ++i) some[i - first] = deadlines_[i];
      const auto later = some > limit;
      // Where the limit is infinite, the lanes that fill up the last register are not later either.
      const std::size_t taken = std::min(width, n - first);
      for (std::uint64_t rest = ~bits(later) & ((std::uint64_t{1} << taken) - 1); rest;
           rest &= rest - 1)
        due[found++] =
            static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(std::countr_zero(rest));
      stdx::where(later && some < earliest, earliest) = some;
    }
    due.resize(found);
    earliest_ = stdx::hmin(earliest);
  }

  /// The clock was set back by `by`.
  void set_back(double by) {
    for (auto& deadline : deadlines_) deadline = just_below(deadline - by);
    for (auto& hit : hits_) hit.deadline = just_below(hit.deadline - by);
    earliest_ = just_below(earliest_ - by);
  }

  /// Makes all deadlines pass.
  void expire() {
    std::fill(deadlines_.begin(), deadlines_.end(), passed);
    earliest_ = passed;
    hits_.clear();
  }

  float deadline(std::size_t slot) const { return deadlines_[slot]; }

  /// Makes the entry in `slot` the first to be tested in the next run.
  void bring_forward(std::size_t slot) { witness_ = static_cast<std::uint32_t>(slot); }
  /// Whether there is a witness, brought forward since the last restart, and its slot.
  bool witnessed() const { return witness_ != nowhere; }
  std::uint32_t witness() const { return witness_; }

  /// Sets whether the witness's margin is expected to be used up soon. If so, its next tests, up to
  /// `most_brief_tests`, only find whether it still hits, and measure no margin.
  void expect(bool soon) { brief_tests_ = soon ? most_brief_tests : 0; }
  bool take_brief_test() { return brief_tests_ > 0 && brief_tests_-- > 0; }

  std::vector<KnownHit>& hits() { return hits_; }
  const std::vector<KnownHit>& hits() const { return hits_; }
  void add_hit(std::size_t slot, double deadline, std::uint32_t a, std::uint32_t b) {
    hits_.push_back({static_cast<std::uint32_t>(slot), just_below(deadline), a, b});
  }

 private:
  std::vector<NodePair> entries_;
  std::vector<float> deadlines_;
  std::vector<KnownHit> hits_;
  float earliest_ = passed;
  std::uint32_t witness_ = nowhere;
  static constexpr int most_brief_tests = 32;
  int brief_tests_ = 0;
  std::vector<std::uint32_t> holes_;  // empty between runs
};

}  // namespace bvlab
