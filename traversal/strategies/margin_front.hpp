// SPDX-License-Identifier: BSD-3-Clause
/// A front whose entries are not tested before the bodies can have closed their gaps
/// (measured_gaps.hpp). Until then nothing below an entry can touch; or, for an entry whose
/// triangles have been tested, no verdict can have changed. An entry whose gap is not known is due.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "traversal/lasting_answer.hpp"
#include "traversal/measured_gaps.hpp"
#include "traversal/node_pair.hpp"

namespace bvlab {

/// A pair of triangles that share a point, and the entry that it was found in.
struct KnownHit {
  std::uint32_t slot;
  std::uint32_t a, b;
};

/// Where two bodies are now, as gaps are measured and compared.
class PresentPoses {
 public:
  PresentPoses(MovingBody& a, MovingBody& b)
      : a_(a),
        b_(b),
        displacement_(a.displacement_bound() + b.displacement_bound()),
        rotation_(a.rotation_bound() + b.rotation_bound()) {
    begin(0, a, b);
  }

  /// Sums of the bounds on both bodies' displacements and rotations since their first frames.
  double displacement() const { return displacement_; }
  double rotation() const { return rotation_; }
  const CornerTransform& a_to_b() const { return transforms_[0]; }
  /// From a to b, and back, which is computed when it is first needed.
  const std::array<CornerTransform, 2>& transforms() {
    if (!has_both_) begin(1, b_, a_), has_both_ = true;
    return transforms_;
  }

 private:
  void begin(std::size_t side, MovingBody& from, MovingBody& to) {
    transforms_[side].begin(RelativePose(from.orthonormal_pose(), to.orthonormal_pose()),
                            from.extent().reach, to.extent().reach);
  }

  MovingBody& a_;
  MovingBody& b_;
  double displacement_, rotation_;
  std::array<CornerTransform, 2> transforms_;
  bool has_both_ = false;
};

class MarginFront {
 public:
  /// The slots of due entries, and a lower bound on the remaining gaps of all other entries.
  struct Due {
    std::span<std::uint32_t> slots;
    float least_of_others;
  };

  static constexpr std::uint32_t nowhere = static_cast<std::uint32_t>(-1);

  std::size_t size() const { return entries_.size(); }
  bool empty() const { return entries_.empty(); }
  const NodePair& operator[](std::size_t slot) const { return entries_[slot]; }
  const std::vector<NodePair>& entries() const { return entries_; }

  /// Starts again from the two roots.
  void restart() {
    clear();
    add({0, 0});
  }

  void clear() {
    entries_.clear(), gaps_.clear(), expires_at_.clear(), holes_.clear();
    announced_ = 0;
    clear_hits();
    witness_ = nowhere;
  }

  void open(std::size_t slot) { holes_.push_back(static_cast<std::uint32_t>(slot)); }

  /// Begins to load what a run reads first: the margins of hits, or what collect() reads.
  void prefetch() const {
    if (hit_margins_.size() > 0) return hit_margins_.prefetch(0);
    if (!empty()) gaps_.prefetch(0), gaps_.prefetch(width);
  }

  /// Adds an entry, which is due, and returns its slot.
  [[gnu::always_inline]] std::size_t add(const NodePair& pair) {
    if (!holes_.empty()) {
      const std::size_t slot = holes_.back();
      holes_.pop_back();
      entries_[slot] = pair;
      forget_gap(slot);
      return slot;
    }
    const std::size_t slot = entries_.size();
    if (slot % width == 0) [[unlikely]]
      expires_at_.push_back(all_due);
    entries_.push_back(pair);
    gaps_.add();
    expires_at_.back() = std::min(expires_at_.back(), due);
    return slot;
  }

  /// Announces the gap of an entry whose volumes are apart. It is unknown until measure().
  void announce_gap(std::size_t slot, float gap) { announce(slot, gap, MeasuredGaps::Of::volumes); }
  /// The same for an entry whose triangles are tested: each of their margins then lowers the gap.
  void announce_triangles(std::size_t slot) {
    announce(slot, std::numeric_limits<float>::max(), MeasuredGaps::Of::triangles);
  }
  /// Lowers a gap that announce_triangles() has announced since the last measure().
  void lower_gap(std::size_t slot, float gap) { gaps_.lower(slot, gap); }
  /// Announcements since the last measure().
  std::size_t announced() const { return announced_; }
  /// Makes known the gaps that were announced, at the present poses, but forgets those of volumes
  /// below `useful`. `spheres` point to the spheres of all nodes of a, and of b. Returns the least
  /// of these gaps: infinity where none was announced, 0 where one is forgotten or used up by
  /// rounding.
  float measure(PresentPoses& now, const std::array<const NodeSphere*, 2>& spheres, float useful) {
    float least = std::numeric_limits<float>::infinity();
    if (!announced_) return least;
    announced_ = 0;
    for (std::size_t group = 0; group < expires_at_.size(); ++group) {
      if (expires_at_[group] != to_be_measured) continue;
      expires_at_[group] = due;
      const std::size_t first = group * width, last = entries_.size() - 1;
      const auto sphere = [&](std::size_t side, int k) __attribute__((always_inline)) {
        const NodePair& pair = entries_[std::min(first + static_cast<std::size_t>(k), last)];
        return spheres[side] + (side ? pair.b : pair.a);
      };
      least =
          std::min(least, gaps_.measure(first, now.transforms(), now.rotation(), useful, sphere));
    }
    return least;
  }
  /// Makes an entry due.
  void forget_gap(std::size_t slot) {
    gaps_.forget(slot);
    double& group = expires_at_[slot / width];
    group = std::min(group, due);
  }
  /// The gap of an entry when it was measured; not positive where none is known.
  float gap(std::size_t slot) const { return gaps_[slot]; }

  bool is_due(std::size_t slot, const PresentPoses& now) const {
    return !(one_of(gaps_, slot, now) > 0);
  }
  /// Collects, in order, the slots of the entries whose surfaces may be within `limit` of each
  /// other, and forgets their gaps. No gap may be announced. The slots lie in `buffer`, which is
  /// enlarged where that is needed, and are valid until the next call.
  Due collect(const PresentPoses& now, double limit, std::vector<std::uint32_t>& buffer) {
    using S = MeasuredGaps::S;
    const S limits(just_above(limit));
    const std::size_t n = entries_.size();
    if (buffer.size() < n + width) buffer.resize(n + width);
    std::size_t found = 0;
    S least(std::numeric_limits<float>::infinity());
    double until = std::numeric_limits<double>::infinity();
    const double reached = now.displacement() + limit;
    for (std::size_t first = 0; first < n; first += width) {
      double& group = expires_at_[first / width];
      if (reached < group) {
        until = std::min(until, group);
        continue;
      }
      const std::uint64_t all = (std::uint64_t{1} << std::min(width, n - first)) - 1;
      const auto add_due = [&](std::uint64_t lanes) __attribute__((always_inline)) {
        found += detail::write_numbers<width>(buffer.data() + found, lanes,
                                              static_cast<std::uint32_t>(first));
      };
      if (group == all_due) {
        add_due(all);
        continue;
      }
      gaps_.prefetch(first + 2 * width);
      const S remaining = gaps_.remaining(first, now.a_to_b(), now.rotation());
      const auto later = remaining > limits;
      S of_group(std::numeric_limits<float>::infinity());
      stdx::where(later, of_group) = remaining;
      least = stdx::min(least, of_group);
      const std::uint64_t due_lanes = ~bits(later) & all;
      if (!due_lanes) {
        group = displacement_at_expiry(now.displacement(), stdx::hmin(of_group));
        continue;
      }
      group = due_lanes == all ? all_due : due;
      gaps_.forget(first, !later);
      add_due(due_lanes);
    }
    return {std::span(buffer).first(found),
            std::min(stdx::hmin(least), just_below(until - now.displacement()))};
  }

  /// Makes all entries due.
  void expire() {
    for (std::size_t slot = 0; slot < size(); ++slot) forget_gap(slot);
    clear_hits();
  }

  /// Makes the entry in `slot` the first to be tested in the next run.
  void set_witness(std::size_t slot) { witness_ = static_cast<std::uint32_t>(slot); }
  /// Whether an entry is the witness, set since the last restart; and its slot.
  bool witnessed() const { return witness_ != nowhere; }
  std::uint32_t witness() const { return witness_; }

  /// Sets whether the witness's margin is expected to be used up soon. If so, its next tests, up to
  /// `most_brief_tests`, only find whether it still hits, and measure no margin.
  void expect(bool soon) { brief_tests_ = soon ? most_brief_tests : 0; }
  bool take_brief_test() { return brief_tests_ > 0 && brief_tests_-- > 0; }

  const std::vector<KnownHit>& hits() const { return hits_; }
  /// Adds a hit, which lasts as long as the gap of its entry. For queries that find all hits.
  void add_hit(const KnownHit& hit) { hits_.push_back(hit); }
  /// Removes the hits of entries whose gaps are not known.
  void remove_hits_of_due() {
    std::erase_if(hits_, [&](const KnownHit& hit) { return !(gaps_[hit.slot] > 0); });
  }
  /// Adds a hit without a margin: it lasts while the bodies do not move, if the run measured gaps.
  /// For queries that one hit may end.
  void add_brief_hit(const KnownHit& hit) {
    hit_margins_.add();
    hits_.push_back(hit);
  }
  /// The same for a hit that lasts as long as its own margin.
  void add_hit(const KnownHit& hit, float margin, const ReferenceSphere& reference,
               double rotation) {
    add_brief_hit(hit);
    hit_margins_.set(hits_.size() - 1, margin, reference, rotation);
  }
  /// Sets which hit is repeated while the answer lasts, for queries that one hit may end.
  void repeat_hit(std::size_t i) { repeated_ = i; }
  std::size_t repeated_hit() const { return repeated_; }
  /// What is left of the margin of hit i, in `hits()`.
  float remaining_of_hit(std::size_t i, const PresentPoses& now) const {
    return hit_margins_[i] > 0 ? one_of(hit_margins_, i, now) : 0;
  }
  void clear_hits() { hits_.clear(), hit_margins_.clear(), repeated_ = 0; }

 private:
  static constexpr int most_brief_tests = 32;
  static constexpr std::size_t width = MeasuredGaps::width;
  // In place of the expiry of a group: an entry may be due, a gap is announced, or no gap is known.
  // min() keeps the least.
  static constexpr double due = -1, to_be_measured = -2, all_due = -3;

  [[gnu::always_inline]] void announce(std::size_t slot, float gap, MeasuredGaps::Of what) {
    gaps_.announce(slot, gap, what);
    expires_at_[slot / width] = to_be_measured;
    ++announced_;
  }
  template <class Gaps>
  static float one_of(const Gaps& gaps, std::size_t i, const PresentPoses& now) {
    constexpr std::size_t W = Gaps::width;
    return gaps.remaining(i / W * W, now.a_to_b(), now.rotation())[i % W];
  }

  std::vector<NodePair> entries_;
  MeasuredGaps gaps_;
  // For each group of `width` entries: none of them is due while the sum of displacements and the
  // query's limit is less than this.
  std::vector<double> expires_at_;
  std::size_t announced_ = 0;  // since the last measure()
  std::vector<KnownHit> hits_;
  FewMeasuredGaps hit_margins_;
  std::size_t repeated_ = 0;  // of hits_
  std::uint32_t witness_ = nowhere;
  int brief_tests_ = 0;
  std::vector<std::uint32_t> holes_;  // empty between runs
};

}  // namespace bvlab
