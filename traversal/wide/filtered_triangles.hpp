// SPDX-License-Identifier: BSD-3-Clause
/// The leaf stage of wide trees: tests a leaf's triangles, or one of them, against a leaf in float,
/// a register of pairs at a time, with a bound on all rounding (triangle_filter.hpp). Pairs that it
/// leaves open, and all near ones if a distance is sought, go to the query in the world frame.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "hierarchies/wide/lanes.hpp"
#include "traversal/measured_gaps.hpp"
#include "traversal/queries/candidate.hpp"
#include "traversal/queries/query.hpp"
#include "traversal/wide/leaf_tests.hpp"
#include "traversal/wide/wide_front.hpp"
#include "traversal/wide/work_queue.hpp"

namespace bvlab {

/// PairFrame is a kernel's; Recorder records what is found (FrontRecord).
template <class PairFrame, class Body, class Query, class Counter, class Recorder>
class FilteredTriangles {
  using S = typename PairFrame::S;
  static constexpr std::size_t parts = PairFrame::parts;
  template <class T>
  static constexpr std::uint64_t all_lanes = (std::uint64_t{2} << (T::size() - 1)) - 1;

 public:
  template <class Pair, class Workspace>
  FilteredTriangles(Body& a, Body& b, const Pair& pair, Query& query, Counter& counter,
                    Workspace& workspace, Recorder& recorder)
      : frame_(pair.frame()),
        query_(query),
        counter_(counter),
        recorder_(recorder),
        queue_(workspace.triangles),
        bodies_{&a, &b} {}

  /// Tests the queued triangles; returns whether the query is satisfied.
  [[gnu::always_inline]] bool test_due() {
    while (!queue_.empty()) {
      if constexpr (wants_bound<Query>()) {
        float order;
        const OpenPair next = queue_.take_least(order);
        // Where it is positive, `order` is a lower bound on the distance of the pair.
        if (order > 0 && bits(query_.culls(order)))
          recorder_.culled(next.from, order, frame_);
        else if (test(next))
          return true;
      } else {
        if (test(queue_.take_last())) return true;
      }
    }
    return false;
  }
  /// Tests the held candidates at the end of a run.
  bool finish() { return pending_ > 0 && flush(); }
  /// Tests the triangles that decided an earlier run: FrontRecord::touched.
  bool retest(const NodePair& pair) {
    if constexpr (wants_bound<Query>()) {
      counter_.primitives(1);
      put(pair);
      return finish();
    } else {
      return test({pair, no_lane}, WideFront::witness);
    }
  }
  /// Tests the triangles of a pair that a step has found near. `entry` is the front's entry that is
  /// retested, if any.
  bool test(const OpenPair& pair, std::size_t entry = WideFront::none) {
    if constexpr (wants_bound<Query>())
      return measure(pair, entry);
    else
      return filter(pair, entry);
  }

 protected:
  using Lanes = S;

  /// Holds a pair that the filter left open; returns whether the query is satisfied.
  bool hold(const NodePair& numbers) {
    put(numbers);
    return pending_ > std::min(Query::buffer_size, at_most - 1) && flush();
  }
  void put(const NodePair& numbers, std::size_t entry = 0) {
    const auto [a, b] = in_meshes(numbers);
    world_[0][pending_] = bodies_[0]->triangle(a), world_[1][pending_] = bodies_[1]->triangle(b);
    candidates_[pending_] = {&world_[0][pending_], &world_[1][pending_], a, b, entry};
    numbers_[pending_] = numbers;
    ++pending_;
  }
  /// Triangles by their indices in their meshes.
  NodePair in_meshes(const NodePair& numbers) const {
    return {frame_.triangle(0, numbers.a), frame_.triangle(1, numbers.b)};
  }
  /// Takes the candidates that are held.
  std::span<const Candidate> take_held() {
    return std::span(candidates_).first(std::exchange(pending_, 0));
  }

  const PairFrame& frame_;
  Query& query_;
  Counter& counter_;
  Recorder& recorder_;
  WorkQueue& queue_;
  static constexpr std::size_t at_most = 16;
  std::size_t pending_ = 0;

 private:
  [[gnu::noinline]] bool filter(const OpenPair& pair, std::size_t entry) {
    const auto triangles = frame_.triangles(pair);
    const std::uint64_t lanes = triangles.lanes();
    counter_.primitives(static_cast<std::uint64_t>(std::popcount(lanes)));
    auto [met, apart] = verdicts<S, parts>(triangles, frame_.a_to_b().error_bound());
    for (std::uint64_t rest = met &= lanes; rest; rest &= rest - 1) {
      const int lane = std::countr_zero(rest);
      const NodePair hit = in_meshes(triangles.numbers(lane));
      if (!query_.known(hit.a, hit.b)) continue;
      recorder_.record_triangles(pair, true, entry);
      recorder_.record_crossing({hit.a, hit.b, true});
      return true;
    }
    std::uint64_t open = lanes & ~apart & ~met;
    if (recorder_.record_triangles(pair, (open | met) != 0, entry))
      recorder_.set_triangle_gap(triangles, counter_, entry);
    for (; open; open &= open - 1)
      if (hold(triangles.numbers(std::countr_zero(open)))) return true;
    return false;
  }

  /// Where a distance is sought: the query tests the pairs that are not certainly too far apart.
  [[gnu::noinline]] bool measure(const OpenPair& pair, std::size_t entry) {
    const auto triangles = frame_.triangles(pair);
    const auto gaps = triangle_gaps<S, parts>(triangles, frame_.a_to_b().error_bound());
    std::uint64_t near = 0;
    for_each_part<S, parts>(
        triangles.lanes(), [&](std::size_t part) __attribute__((always_inline)) {
          near |= (~bits(query_.culls(gaps[part])) & all_lanes<S>) << (part * S::size());
        });
    near &= triangles.lanes();
    counter_.primitives(static_cast<std::uint64_t>(std::popcount(near)));
    for (std::uint64_t rest = near; rest; rest &= rest - 1)
      if (hold(triangles.numbers(std::countr_zero(rest)))) return end_within(pair, entry);
    if (finish()) return end_within(pair, entry);
    recorder_.record_distances(pair, entry, [&] {
      // What was tested or culled is not nearer than the limit now.
      const S limit(just_below(query_.limit()));
      S least(std::numeric_limits<float>::infinity());
      for_each_part<S, parts>(triangles.lanes(), [&](std::size_t part) {
        least = stdx::min(least, stdx::max(limit, gaps[part]));
      });
      return std::pair(stdx::hmin(least), triangles.reference_sphere());
    });
    return false;
  }

  /// The run ends before the triangles of a pair are recorded: the lane that they are of is due.
  bool end_within(const OpenPair& pair, std::size_t entry) {
    if (entry == WideFront::none)
      recorder_.culled(pair.from, -std::numeric_limits<float>::infinity(), frame_);
    return true;
  }

  bool flush() {
    const auto held = take_held();
    const Outcome outcome = query_.primitives(held);
    if (outcome.witness < held.size()) {
      if constexpr (wants_bound<Query>())
        recorder_.record_touching(numbers_[outcome.witness]);
      else if constexpr (DecidedByOneHit<Query>)
        recorder_.record_crossing({held[outcome.witness].a, held[outcome.witness].b, false});
    }
    return outcome.satisfied;
  }

  std::array<Body*, 2> bodies_;
  std::array<std::array<Triangle, at_most>, 2> world_;
  std::array<Candidate, at_most> candidates_;
  std::array<NodePair, at_most> numbers_;  // of their triangles in the trees
};

}  // namespace bvlab
