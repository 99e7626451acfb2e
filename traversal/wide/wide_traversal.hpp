// SPDX-License-Identifier: BSD-3-Clause
/// A traversal of two bodies over wide trees, one step at a time, so that a caller can interleave
/// several pairs of bodies: while one pair waits for a result, another is computed.
///
/// A kernel defines the step (siblings_kernel.hpp, mixed_kernel.hpp). Where two leaves are left,
/// their triangles are tested in float, with a derived bound on all rounding. Pairs decided by this
/// filter skip the exact test; the few others go to the query, in the world.
///
/// Where one hit is enough or a distance is sought, the open pair that is likeliest to end the
/// search is taken first (see WorkQueue).
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "traversal/primitives/triangle_filter.hpp"
#include "traversal/queries/candidate.hpp"
#include "traversal/queries/query.hpp"
#include "traversal/wide/relative_frame.hpp"
#include "traversal/wide/siblings_kernel.hpp"
#include "traversal/wide/wide_front.hpp"
#include "traversal/wide/work_queue.hpp"

namespace bvlab {

/// Buffers that are reused from one traversal to the next.
struct WideWorkspace {
  WorkQueue nodes;      ///< pairs of nodes
  WorkQueue triangles;  ///< pairs whose triangles are to be tested
};

/// Measures no gaps. See wide_margins.hpp for a memory that needs them.
struct NotMeasuring {
  static constexpr bool measures = false;
};

/// The expected answer. It affects the order of steps, but no answer.
enum class Expect { touching, apart };

/// Where a traversal starts, as its memory knows.
struct TraversalStart {
  Expect expect = Expect::touching;
  std::optional<NodePair> touched = {};  ///< Measure::touched of the last frame, tested first
  /// Null, or a front: if it is complete the traversal starts from it, else it is written anew.
  WideFront* front = nullptr;
  double rotation = 0;  ///< bound on the rotation of both bodies since the first frame
};

template <BoundingVolume V, int F, class Query, class Counter, class Measure = NotMeasuring,
          class Kernel = SiblingsKernel>
class WideTraversal {
  using PairFrame = typename Kernel::template PairFrame<V, F>;
  using S = typename PairFrame::S;
  using Body = typename Kernel::template Body<V, F>;
  static constexpr std::size_t parts = PairFrame::parts, width = S::size();
  static_assert(std::is_same_v<typename V::scalar, float>,
                "orders and the filter of triangles are float32");

 public:
  explicit WideTraversal(WideWorkspace& workspace)
      : nodes_(workspace.nodes), triangles_(workspace.triangles) {}

  /// Starts on two bodies.
  void begin(Body& a, Body& b, Query query, Counter& counter, const TraversalStart& start = {}) {
    bodies_ = {&a, &b};
    pair_frame_.begin(a, b);
    query_.emplace(std::move(query));
    counter_ = &counter;
    steps_ = start.expect == Expect::touching ? 0 : most_in_order + 1;
    nodes_.clear(), triangles_.clear(), pending_ = 0;
    nodes_.push(pair_frame_.roots(), 0);
    if constexpr (Measure::measures) {
      measure_.begin(start.front, start.rotation);
      if (measure_.sweeps())
        nodes_.clear();
      else if (start.touched)
        pair_frame_.retry(*start.touched, nodes_, triangles_);
    }
  }

  const Query& query() const { return *query_; }
  const Measure& measure() const { return measure_; }

  /// Makes one step; returns whether there is more to do.
  [[gnu::noinline]] bool advance() {
    if constexpr (Measure::measures)
      if (measure_.sweeps() && !measure_.swept()) {
        if (sweep()) return false;
        return !nodes_.empty() || finish();
      }
    if constexpr (wants_bound<Query>()) {
      float order;
      const NodePair pair = nodes_.take_least(order);
      // Where it is positive, `order` is a lower bound on the distance of the pair.
      if (order > 0 && bits(query_->culls(order))) return !nodes_.empty() || finish();
      step(pair);
      while (!triangles_.empty()) {
        const NodePair next = triangles_.take_least(order);
        if (!(order > 0 && bits(query_->culls(order))) && open_distances(next)) return false;
      }
    } else if constexpr (Query::one_hit_is_enough) {
      float order;
      if constexpr (Measure::measures)
        if (!triangles_.empty() && open_triangles(triangles_.take_last())) return false;
      if (++steps_ <= most_in_order)
        step(Kernel::nearest_child_first ? nodes_.take_last() : nodes_.take_least(order));
      else
        step_several();
      while (!triangles_.empty())
        if (open_triangles(triangles_.take_last())) return false;
    } else {
      step(nodes_.take_last());
      while (!triangles_.empty())
        if (open_triangles(triangles_.take_last())) return false;
    }
    return !nodes_.empty() || finish();
  }

 private:
  /// A hit takes 5 to 13 steps. After more, the bodies are likely apart, and then the order is
  /// irrelevant: steps that do not wait for one another take half the time.
  static constexpr int most_in_order = 16;
  static constexpr std::size_t several = 4;

  [[gnu::always_inline]] void step_several() {
    std::array<NodePair, several> taken;
    const std::size_t count = std::min(nodes_.size(), several);
    for (std::size_t k = 0; k < count; ++k) taken[k] = nodes_.take_last();
    for (std::size_t k = 0; k < count; ++k) step(taken[k]);
  }

  /// Tests the held candidates; the traversal is over, so this returns false.
  bool finish() {
    if (pending_ > 0) flush();
    return false;
  }

  /// Retests the entries whose gaps may have closed. Returns whether the query is satisfied.
  bool sweep()
    requires(Measure::measures)
  {
    WideFront& front = measure_.sweep();
    const std::size_t size = front.size();  // added entries are not retested
    for (std::size_t first = 0; first < size; first += WideFront::width)
      for (std::uint64_t due = measure_.due(first, size - first, pair_frame_.a_to_b()); due;
           due &= due - 1) {
        const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(due));
        const WideFront::Entry entry = front[i];
        if (!entry.triangle)
          step(entry.pair, i);
        else if (open_triangles(entry.pair, i))
          return true;
      }
    while (!triangles_.empty())
      if (open_triangles(triangles_.take_last())) return true;
    return false;
  }

  /// Makes the step of a pair. `entry` is the front's entry that is retested, if any.
  [[gnu::always_inline]] void step(const NodePair& pair, std::size_t entry = WideFront::none) {
    pair_frame_.step(
        pair, *counter_, [&](const auto& step) __attribute__((always_inline)) {
          test(step, pair, entry);
        });
  }
  template <class Step>
  [[gnu::always_inline]] void test(const Step& step, [[maybe_unused]] const NodePair& pair,
                                   [[maybe_unused]] std::size_t entry) {
    const std::uint64_t lanes = step.lanes();
    counter_->tested(static_cast<std::uint64_t>(std::popcount(lanes)));
    std::array<S, parts> order;
    std::uint64_t apart = 0;
    [[maybe_unused]] S least(std::numeric_limits<float>::infinity());
    for_each_part([&](std::size_t part) __attribute__((always_inline)) {
      std::uint64_t found;
      if constexpr (wants_bound<Query>()) {
        order[part] = step.gaps(part);
        found = bits(query_->culls(order[part]));
      } else if constexpr (Measure::measures) {
        const auto seen = step.separation(part);
        found = Measure::apart(seen.gap, least);
        order[part] = seen.order;
      } else {
        const auto seen = step.overlap(part);
        found = bits(seen.apart);
        order[part] = seen.order;
      }
      apart |= found << (part * width);
    });
    std::uint64_t remaining = lanes & ~apart;
    if constexpr (Measure::measures)
      remaining = measure_.record_step(pair, remaining, entry, least,
                                       [&] { return step.reference_sphere(); });
    constexpr bool ordered =
        Kernel::nearest_child_first && Query::one_hit_is_enough && !wants_bound<Query>();
    step.push(nodes_, triangles_, remaining, order,
              ordered && steps_ <= most_in_order ? NextPair::nearest_child : NextPair::any);
  }

  /// Unrolled: a loop, even of one pass, would keep its results in memory.
  template <class Do>
  [[gnu::always_inline]] static void for_each_part(Do&& what) {
    [&]<std::size_t... part>(std::index_sequence<part...>) __attribute__((always_inline)) {
      (what(part), ...);
    }
    (std::make_index_sequence<parts>());
  }

  [[gnu::noinline]] bool open_triangles(const NodePair& pair,
                                        [[maybe_unused]] std::size_t entry = WideFront::none) {
    const auto triangles = pair_frame_.triangles(pair);
    const std::uint64_t lanes = triangles.lanes();
    counter_->primitives(static_cast<std::uint64_t>(std::popcount(lanes)));
    std::uint64_t met = 0, apart = 0;
    for_each_part([&](std::size_t part) __attribute__((always_inline)) {
      const auto [x, y] = triangles.corners(part);
      const auto verdict = certainly_within<S>(x, y, S(pair_frame_.a_to_b().error_bound()));
      met |= bits(verdict.meeting) << (part * width);
      apart |= bits(verdict.apart) << (part * width);
    });
    for (std::uint64_t rest = met &= lanes; rest; rest &= rest - 1) {
      const int lane = std::countr_zero(rest);
      if (!query_->known(triangles.of_a(lane), triangles.of_b(lane))) continue;
      if constexpr (Measure::measures) {
        measure_.triangles(pair, true, entry);
        measure_.crossing({triangles.of_a(lane), triangles.of_b(lane), true});
      }
      return true;
    }
    std::uint64_t open = lanes & ~apart & ~met;
    if constexpr (Measure::measures)
      if (measure_.triangles(pair, open != 0, entry))
        measure_.set_triangle_gap(triangles.gap(*counter_), entry, triangles.reference_sphere());
    for (; open; open &= open - 1) {
      const int lane = std::countr_zero(open);
      if (hold(triangles.of_a(lane), triangles.of_b(lane))) return true;
    }
    return false;
  }

  /// As open_triangles, where a distance is sought: holds pairs of triangles whose volumes are near
  /// enough.
  [[gnu::noinline]] bool open_distances(const NodePair& pair) {
    const auto triangles = pair_frame_.triangles(pair);
    std::uint64_t remaining = triangles.lanes();
    if constexpr (requires { triangles.gaps(*counter_); })
      remaining &= ~bits(query_->culls(triangles.gaps(*counter_)));
    counter_->primitives(static_cast<std::uint64_t>(std::popcount(remaining)));
    for (; remaining; remaining &= remaining - 1) {
      const int lane = std::countr_zero(remaining);
      if (hold(triangles.of_a(lane), triangles.of_b(lane))) return true;
    }
    return pending_ > 0 && flush();
  }

  bool hold(std::uint32_t a, std::uint32_t b) {
    world_[0][pending_] = bodies_[0]->triangle(a), world_[1][pending_] = bodies_[1]->triangle(b);
    candidates_[pending_] = {&world_[0][pending_], &world_[1][pending_], a, b, 0};
    ++pending_;
    return pending_ > std::min(Query::buffer_size, at_most - 1) && flush();
  }

  bool flush() {
    const std::size_t count = std::exchange(pending_, 0);
    const Outcome outcome = query_->primitives(std::span(candidates_).first(count));
    if constexpr (Measure::measures && Query::one_hit_is_enough)
      if (outcome.witness < count)
        measure_.crossing({candidates_[outcome.witness].a, candidates_[outcome.witness].b, false});
    return outcome.satisfied;
  }

  static constexpr std::size_t at_most = 16;

  std::array<Body*, 2> bodies_;
  PairFrame pair_frame_;
  std::optional<Query> query_;
  [[no_unique_address]] Measure measure_;
  Counter* counter_;
  int steps_;
  WorkQueue& nodes_;
  WorkQueue& triangles_;
  std::array<std::array<Triangle, at_most>, 2> world_;
  std::array<Candidate, at_most> candidates_;
  std::size_t pending_ = 0;
};

}  // namespace bvlab
