// SPDX-License-Identifier: BSD-3-Clause
/// The leaf stage of wide trees: tests a leaf's triangles, or one of them, against a leaf in float,
/// a register of pairs at a time, with a bound on all rounding (triangle_filter.hpp). Pairs that it
/// leaves open, and all near ones if a distance is sought, go to the query in the world frame.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>

#include "hierarchies/wide/lanes.hpp"
#include "traversal/primitives/triangle_filter.hpp"
#include "traversal/queries/candidate.hpp"
#include "traversal/queries/query.hpp"
#include "traversal/wide/wide_front.hpp"
#include "traversal/wide/work_queue.hpp"

namespace bvlab {

/// PairFrame is a kernel's; Recorder records what is found (GapMeasure, NoRecord).
template <class PairFrame, class Body, class Query, class Counter, class Recorder>
class FilteredTriangles {
  using S = typename PairFrame::S;
  static constexpr std::size_t parts = PairFrame::parts, width = S::size();

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
        const NodePair next = queue_.take_least(order);
        // Where it is positive, `order` is a lower bound on the distance of the pair.
        if (!(order > 0 && bits(query_.culls(order))) && measure(next)) return true;
      } else {
        if (test(queue_.take_last())) return true;
      }
    }
    return false;
  }
  /// Tests the held candidates at the end of a run.
  bool finish() { return pending_ > 0 && flush(); }
  /// Tests the triangles of a pair that a step has found near. `entry` is the front's entry that is
  /// retested, if any.
  [[gnu::noinline]] bool test(const NodePair& pair, std::size_t entry = WideFront::none) {
    const auto triangles = frame_.triangles(pair);
    const std::uint64_t lanes = triangles.lanes();
    counter_.primitives(static_cast<std::uint64_t>(std::popcount(lanes)));
    std::uint64_t met = 0, apart = 0;
    for_each_part<S, parts>(
        lanes, [&](std::size_t part) __attribute__((always_inline)) {
          const auto [x, y] = triangles.corners(part);
          const auto verdict = certainly_within<S>(x, y, S(frame_.a_to_b().error_bound()));
          met |= bits(verdict.meeting) << (part * width);
          apart |= bits(verdict.apart) << (part * width);
        });
    for (std::uint64_t rest = met &= lanes; rest; rest &= rest - 1) {
      const int lane = std::countr_zero(rest);
      if (!query_.known(triangles.of_a(lane), triangles.of_b(lane))) continue;
      recorder_.record_triangles(pair, true, entry);
      recorder_.record_crossing({triangles.of_a(lane), triangles.of_b(lane), true});
      return true;
    }
    std::uint64_t open = lanes & ~apart & ~met;
    if (recorder_.record_triangles(pair, (open | met) != 0, entry))
      recorder_.set_triangle_gap(triangles, counter_, entry);
    for (; open; open &= open - 1) {
      const int lane = std::countr_zero(open);
      if (hold(triangles.of_a(lane), triangles.of_b(lane))) return true;
    }
    return false;
  }

 protected:
  using Lanes = S;

  /// Holds a pair that the filter left open; returns whether the query is satisfied.
  bool hold(std::uint32_t a, std::uint32_t b) {
    world_[0][pending_] = bodies_[0]->triangle(a), world_[1][pending_] = bodies_[1]->triangle(b);
    candidates_[pending_] = {&world_[0][pending_], &world_[1][pending_], a, b, 0};
    ++pending_;
    return pending_ > std::min(Query::buffer_size, at_most - 1) && flush();
  }

  const PairFrame& frame_;
  Query& query_;
  Counter& counter_;
  Recorder& recorder_;
  WorkQueue& queue_;

 private:
  static constexpr std::size_t at_most = 16;

  /// As test, where a distance is sought: the query tests the pairs whose volumes are near enough.
  [[gnu::noinline]] bool measure(const NodePair& pair) {
    const auto triangles = frame_.triangles(pair);
    std::uint64_t remaining = triangles.lanes();
    if constexpr (requires { triangles.gaps(counter_); })
      remaining &= ~bits(query_.culls(triangles.gaps(counter_)));
    counter_.primitives(static_cast<std::uint64_t>(std::popcount(remaining)));
    for (; remaining; remaining &= remaining - 1) {
      const int lane = std::countr_zero(remaining);
      if (hold(triangles.of_a(lane), triangles.of_b(lane))) return true;
    }
    return finish();
  }

  bool flush() {
    const std::size_t count = std::exchange(pending_, 0);
    const Outcome outcome = query_.primitives(std::span(candidates_).first(count));
    if constexpr (Query::one_hit_is_enough)
      if (outcome.witness < count)
        recorder_.record_crossing(
            {candidates_[outcome.witness].a, candidates_[outcome.witness].b, false});
    return outcome.satisfied;
  }

  std::array<Body*, 2> bodies_;
  std::array<std::array<Triangle, at_most>, 2> world_;
  std::array<Candidate, at_most> candidates_;
  std::size_t pending_ = 0;
};

}  // namespace bvlab
