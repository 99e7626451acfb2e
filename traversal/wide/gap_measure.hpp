// SPDX-License-Identifier: BSD-3-Clause
/// What a traversal of two wide trees records for the next frame: nothing (NoRecord); or, for
/// wide_margins.hpp, a lower bound on the distance of disjoint bodies, one pair of intersecting
/// triangles, and a front (GapMeasure). See traversal.hpp for the members of a traversal's
/// recorder.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <optional>

#include "traversal/wide/wide_front.hpp"

namespace bvlab {

/// A pair of intersecting triangles that the last traversal found, by their indices in their
/// meshes.
struct Crossing {
  std::uint32_t a, b;
  bool certain;  ///< the filter in float decided it; otherwise the query's own test did
};

/// The expected answer. It affects the order of steps, but no answer.
enum class Expect { touching, apart };

/// Where a traversal of wide trees starts, given by the memory of its pair of bodies.
struct TraversalStart {
  Expect expect = Expect::touching;
  std::optional<NodePair> touched = {};  ///< GapMeasure::touched of the last frame, tested first
  /// Null, or a front: if it is complete the traversal starts from it, else it is written anew.
  WideFront* front = nullptr;
  double rotation = 0;  ///< sum of the bounds on both bodies' rotations since the first frame
};

/// Records nothing: the recorder of a traversal (see traversal.hpp) that starts from the roots.
class NoRecord {
 public:
  static constexpr bool measures_gaps = false;

  explicit NoRecord(const TraversalStart& start) : expect_(start.expect) {}

  template <class Pair>
  void begin(Pair& pair) const {
    pair.start(expect_);
  }
  static constexpr bool sweep_is_due() { return false; }
  template <class Traversal>
  static bool sweep(Traversal&) {
    return false;
  }
  static constexpr std::size_t no_entries() { return WideFront::none; }
  template <class Pair, class Step, class Found, class Query>
  [[gnu::always_inline]] static std::uint64_t record(const Pair&, const Step&, const Found&,
                                                     std::uint64_t near, std::size_t, Query&) {
    return near;
  }
  template <class Pair, class Leaves>
  static void finish(const Pair&, const Leaves&, bool) {}

  static constexpr bool record_triangles(const NodePair&, bool, std::size_t) { return false; }
  static void record_touching(const NodePair&) {}
  static void record_crossing(const Crossing&) {}
  template <class Triangles, class Counter>
  static void set_triangle_gap(const Triangles&, Counter&, std::size_t) {}

 private:
  Expect expect_;
};

/// Measures the least gap, and keeps a front if it is given one.
template <Batched S>
class GapMeasure {
 public:
  static constexpr bool measures_gaps = true;

  explicit GapMeasure(const TraversalStart& start)
      : start_(start),
        least_(infinity),
        least_remaining_(infinity),
        sweep_is_due_(start.front && start.front->is_complete()),
        sweeps_(sweep_is_due_) {
    if (start_.front && !sweeps_) start_.front->clear();
  }

  template <class Pair>
  void begin(Pair& pair) const {
    if (sweeps_) return;
    pair.start(start_.expect);
    if (start_.touched) pair.retry(*start_.touched);
  }

  /// Whether the traversal starts from a front that has not been swept yet.
  bool sweep_is_due() const { return sweep_is_due_; }
  /// Retests the entries whose gaps may have closed. Returns whether the query is satisfied.
  template <class Traversal>
  bool sweep(Traversal& traversal) {
    sweep_is_due_ = false;
    auto& pair = traversal.pair();
    const std::size_t size = start_.front->size();  // added entries are not retested
    for (std::size_t first = 0; first < size; first += MeasuredGaps::width)
      for (std::uint64_t rest = due_lanes(first, size - first, pair.frame().a_to_b()); rest;
           rest &= rest - 1) {
        const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(rest));
        const WideFront::Entry entry = (*start_.front)[i];
        if (!entry.triangle)
          pair.template step<typename Traversal::Query>(
              entry.pair, traversal.counter(), [&](auto&& step) __attribute__((always_inline)) {
                traversal.visit(step, i);
              });
        else if (traversal.leaves().test(entry.pair, i))
          return true;
      }
    return traversal.leaves().test_due();
  }
  static constexpr std::size_t no_entries() { return WideFront::none; }

  /// Records a step: the lanes that are near, and the gap of the others, at its reference sphere.
  /// Returns the near lanes that were not opened before.
  template <class Pair, class Step, class Found, class Query>
  [[gnu::always_inline]] std::uint64_t record(const Pair&, const Step& step, const Found& found,
                                              std::uint64_t near, std::size_t entry, Query&) {
    least_ = stdx::min(least_, found.least);
    if (!start_.front) return near;
    std::uint64_t fresh = near;
    if (entry == WideFront::none) {
      entry = start_.front->add({step.pair, static_cast<std::uint16_t>(near), 0, 0});
    } else {
      auto& opened = (*start_.front)[entry].opened;
      fresh = near & ~std::uint64_t{opened};
      opened = static_cast<std::uint16_t>(opened | fresh);
    }
    start_.front->gaps().set(entry, stdx::hmin(found.least), step.of.reference_sphere(),
                             start_.rotation);
    return fresh;
  }
  template <class Pair, class Leaves>
  static void finish(const Pair&, const Leaves&, bool) {}

  /// Records a test of triangles; `touching`: some may touch. Returns whether to measure their gap.
  bool record_triangles(const NodePair& pair, bool touching, std::size_t entry) {
    if (touching) touched_ = pair;
    if (!start_.front || entry == WideFront::none) {
      least_ = S(0.0f);
      if (start_.front) start_.front->add({pair, 0, 1, 0});
      return false;
    }
    auto& rest = (*start_.front)[entry].rest;
    if (rest > 0) --rest;
    if (!touching && rest == 0) return true;
    least_ = S(0.0f);
    return false;
  }
  template <class Triangles, class Counter>
  void set_triangle_gap(const Triangles& triangles, Counter& counter, std::size_t entry) {
    const float gap = triangles.gap(counter);
    least_ = stdx::min(least_, S(gap));
    start_.front->gaps().set(entry, gap, triangles.reference_sphere(), start_.rotation);
    if (!(gap > 0)) (*start_.front)[entry].rest = 8;
  }
  /// Called where all hits are sought, for triangles that touch or may touch. Which ones is not
  /// used later: a pair that touches keeps no front, since a retest would test all its contacts
  /// again.
  void record_touching(const NodePair& pair) { touched_ = pair; }
  void record_crossing(const Crossing& found) { crossing_ = found; }

  /// Whether the traversal wrote a front or updated one.
  bool keeps_front() const { return start_.front; }
  /// Whether the traversal started from the front.
  bool sweeps() const { return sweeps_; }
  /// How many entries of the front were due.
  std::size_t due_count() const { return due_count_; }
  const std::optional<Crossing>& crossing() const { return crossing_; }
  /// The pair whose triangles touched, or may have.
  const std::optional<NodePair>& touched() const { return touched_; }
  /// A lower bound on the distance of the bodies; 0 where none is known, and where it overflowed:
  /// an infinite gap would last for ever. It covers the rounding of separations (see
  /// slab_box_sibling_test.hpp, gaps).
  double gap() const {
    const double least = std::min(stdx::hmin(least_), stdx::hmin(least_remaining_));
    return least > 0 && least < infinity ? least * (1 - 32 * unit_roundoff<float>) : 0;
  }

 private:
  using Gaps = MeasuredGaps::S;
  static constexpr float infinity = std::numeric_limits<float>::infinity();

  /// Which of the entries from `first` on, at most a register of them, are due, that is, may have
  /// closed their gaps.
  [[gnu::always_inline]] std::uint64_t due_lanes(std::size_t first, std::size_t entries,
                                                 const CornerTransform& corners) {
    const Gaps remaining = start_.front->gaps().remaining(first, corners, start_.rotation);
    const std::size_t lanes = std::min<std::size_t>(entries, MeasuredGaps::width);
    const auto apart = remaining > Gaps(0.0f);
    stdx::where(apart, least_remaining_) = stdx::min(least_remaining_, remaining);
    const std::uint64_t due = ~bits(apart) & ((std::uint64_t{1} << lanes) - 1);
    due_count_ += static_cast<std::size_t>(std::popcount(due));
    return due;
  }

  TraversalStart start_;
  S least_;
  Gaps least_remaining_;
  std::optional<NodePair> touched_;
  std::optional<Crossing> crossing_;
  std::size_t due_count_ = 0;
  bool sweep_is_due_, sweeps_;
};

}  // namespace bvlab
