// SPDX-License-Identifier: BSD-3-Clause
/// Two bodies over wide trees, one step at a time, so that a caller can let several pairs of bodies
/// take turns: a step's result is waited for while another pair's is worked out.
///
/// A step takes a pair of nodes and tests one of them against all children of the other, of the
/// larger one, inner nodes before leaves. Children of a leaf are triangles: what is left of those
/// is tested against all triangles of the other leaf at once, in float, where a derived bound on
/// all rounding says which verdicts are certain; the few others go to the query, in the world.
///
/// Where one hit is enough or a distance is sought, the pair that is likeliest to end the search is
/// taken first, of all that are open (see Frontier).
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
#include "traversal/wide/frames.hpp"
#include "traversal/wide/frontier.hpp"
#include "traversal/wide/wide_front.hpp"

namespace bvlab {

template <class Q>
concept SeeksDistance = requires {
  requires Q::wants_bound;
};

/// Room that is used again from one traversal to the next.
struct WideWorkspace {
  Frontier frontier;   ///< pairs of nodes
  Frontier triangles;  ///< a's triangles, as leaves number them, with leaves of b
};

/// How far bodies are apart is not asked: see wide_margins.hpp for what asks it.
struct NotMeasuring {
  static constexpr bool measures = false;
};

template <BoundingVolume V, int F, class Frame, class Query, class Counter,
          class Measure = NotMeasuring>
class WideTraversal {
  using T = typename V::scalar;
  using S = Batch<T, F>;
  using Body = typename Frame::template Body<V, F>;
  static_assert(std::is_same_v<T, float>, "orders and the filter of triangles are float32");

 public:
  explicit WideTraversal(WideWorkspace& workspace)
      : frontier_(workspace.frontier), triangles_(workspace.triangles) {}

  /// Looks at two bodies, whose roots are known not to be apart or are still to be tested.
  void begin(Body& a, Body& b, Query query, Counter& counter) {
    bodies_ = {&a, &b};
    between_.begin(a, b);
    query_.emplace(std::move(query));
    counter_ = &counter;
    steps_ = 0;
    frontier_.clear(), triangles_.clear(), pending_ = 0;
    frontier_.push({0, 0}, 0);
  }

  /// `touched`, a triangle of a and a leaf of b, is looked at first, then its leaf. What the bodies
  /// are known to be apart by is in `front`, if that is complete; else it is written there. `turn`
  /// is what both have turned by since the first frame.
  void begin(Body& a, Body& b, Query query, Counter& counter,
             const std::optional<NodePair>& touched, WideFront* front,
             double turn) requires(Measure::measures) {
    begin(a, b, std::move(query), counter);
    measure_.begin(front, turn);
    if (measure_.sweeps()) {
      frontier_.clear();
    } else if (touched) {
      frontier_.push({a.hierarchy().leaf_of(touched->a), touched->b},
                     -std::numeric_limits<float>::max());
      triangles_.push(*touched, 0);
    }
  }

  const Query& query() const { return *query_; }
  const Measure& measure() const { return measure_; }

  /// Says whether there is more to do.
  [[gnu::noinline]] bool advance() {
    if constexpr (Measure::measures)
      if (measure_.sweeps() && !measure_.swept()) {
        if (sweep()) return false;
        return !frontier_.empty() || finish();
      }
    if constexpr (SeeksDistance<Query>) {
      float order;
      const NodePair pair = frontier_.take_least(order);
      // What is `order` apart, or less where they may meet.
      if (order > 0 && bits(query_->culls(order))) return !frontier_.empty() || finish();
      step(pair);
      while (!triangles_.empty()) {
        const NodePair next = triangles_.take_least(order);
        if (!(order > 0 && bits(query_->culls(order))) && open_distances(next)) return false;
      }
    } else if constexpr (Query::one_hit_is_enough) {
      float order;
      if constexpr (Measure::measures)
        if (!triangles_.empty() && open_triangle(triangles_.take_last())) return false;
      if (++steps_ <= most_in_order)
        step(frontier_.take_least(order));
      else
        step_several();
      while (!triangles_.empty())
        if (open_triangle(triangles_.take_last())) return false;
    } else {
      step(frontier_.take_last());
      while (!triangles_.empty())
        if (open_triangle(triangles_.take_last())) return false;
    }
    return !frontier_.empty() || finish();
  }

 private:
  /// Hits take 5 to 13 steps. Who has come so far is likely apart, and then order is worth nothing:
  /// steps that do not wait for one another take half the time.
  static constexpr int most_in_order = 16;
  static constexpr std::size_t several = 4;

  [[gnu::always_inline]] void step_several() {
    std::array<NodePair, several> taken;
    const std::size_t count = std::min(frontier_.size(), several);
    for (std::size_t k = 0; k < count; ++k) taken[k] = frontier_.take_last();
    for (std::size_t k = 0; k < count; ++k) step(taken[k]);
  }

  /// What was held back is looked at; nothing more is to do.
  bool finish() {
    if (pending_ > 0) flush();
    return false;
  }

  /// Looks again at what can have come together. Says whether that is enough.
  bool sweep() requires(Measure::measures) {
    WideFront& front = measure_.sweep();
    const std::size_t size = front.size();  // what is added needs no second look
    for (std::size_t first = 0; first < size; first += WideFront::width)
      for (std::uint64_t due = measure_.due(first, size - first, between_.corners()); due;
           due &= due - 1) {
        const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(due));
        const WideFront::Entry entry = front[i];
        if (!entry.triangle)
          step(entry.pair, i);
        else if (open_triangle(entry.pair, i))
          return true;
      }
    while (!triangles_.empty())
      if (open_triangle(triangles_.take_last())) return true;
    return false;
  }

  /// Tests one node of the pair against the children of the other: of a, where both are leaves.
  /// `entry` is the one of the front that is looked at again, if any.
  [[gnu::always_inline]] void step(const NodePair& pair,
                                   [[maybe_unused]] std::size_t entry = WideFront::none) {
    const std::array<std::uint32_t, 2> node{pair.a, pair.b};
    const auto& a = bodies_[0]->hierarchy().node(pair.a);
    const auto& b = bodies_[1]->hierarchy().node(pair.b);
    const unsigned leaves = a.leaf & b.leaf;
    const std::size_t side =
        (a.leaf & ~b.leaf & 1u) | (((a.leaf | b.leaf) == 0) & (b.size > a.size));
    const std::array<const typename WideHierarchy<V, F>::Node*, 2> nodes{&a, &b};
    const auto& many = *nodes[side];
    const auto one = between_.one(1 - side, node[1 - side], *counter_);
    counter_->tested(static_cast<std::uint64_t>(std::popcount(many.lanes)));
    Frontier& next = leaves ? triangles_ : frontier_;
    if constexpr (SeeksDistance<Query>) {
      const S gaps = between_.gaps(side, node[side], one, *counter_);
      const std::uint64_t left = many.lanes & ~bits(query_->culls(gaps));
      next.template push_lanes<F>(static_cast<int>(side), left, many.first, node[1 - side], gaps);
    } else if constexpr (Measure::measures) {
      const auto seen = between_.separated(side, node[side], one, *counter_);
      const std::uint64_t left = measure_.left(pair, many.lanes & measure_.opened(seen.gap), entry,
                                               between_, 1 - side, node[1 - side]);
      next.template push_lanes<F>(static_cast<int>(side), left, many.first, node[1 - side],
                                  seen.order);
    } else {
      const auto seen = between_.compared(side, node[side], one, *counter_);
      const std::uint64_t left = many.lanes & ~bits(seen.apart);
      next.template push_lanes<F>(static_cast<int>(side), left, many.first, node[1 - side],
                                  seen.order);
    }
  }

  /// A triangle of a against all of a leaf of b.
  [[gnu::noinline]] bool open_triangle(const NodePair& pair,
                                       [[maybe_unused]] std::size_t entry = WideFront::none) {
    const auto& leaf = bodies_[1]->hierarchy().node(pair.b);
    const auto& lanes = bodies_[1]->hierarchy().corners(leaf.first).corner;
    const auto& own = bodies_[0]->hierarchy().corners(pair.a).corner;
    const std::size_t lane = pair.a % F;
    alignas(16) std::array<std::array<float, 4>, 3> turned;
    for (std::size_t i = 0; i < 3; ++i)
      between_.corners()
          .turned(own[i][0][lane], own[i][1][lane], own[i][2][lane])
          .copy_to(turned[i].data(), stdx::vector_aligned);
#if defined(__GNUC__)
    asm("" : "+m"(turned));  // to be broadcast from memory
#endif
    Corners<S> x, y;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        x[i][j] = S(turned[i][j]);
        y[i][j] = S(lanes[i][j].data(), stdx::vector_aligned);
      }
    counter_->primitives(static_cast<std::uint64_t>(std::popcount(leaf.lanes)));
    const auto verdict = certainly_within<S>(x, y, S(between_.corners().off()));
    std::uint64_t met = bits(verdict.meeting) & leaf.lanes;
    const std::uint32_t triangle = bodies_[0]->hierarchy().triangle(pair.a);
    for (std::uint64_t rest = met; rest; rest &= rest - 1)
      if (query_->known(triangle, triangle_of_b(leaf.first, rest))) {
        if constexpr (Measure::measures) {
          measure_.triangles(pair, true, entry);
          measure_.crossing(triangle, triangle_of_b(leaf.first, rest));
        }
        return true;
      }
    std::uint64_t open = leaf.lanes & ~bits(verdict.apart) & ~met;
    if constexpr (Measure::measures)
      if (measure_.triangles(pair, open != 0, entry))
        measure_.triangles_are(gaps_of(pair), entry, place_of(own, lane, turned));
    for (; open; open &= open - 1)
      if (hold(triangle, triangle_of_b(leaf.first, open))) return true;
    return false;
  }

  /// A ball around a triangle of a about its first corner.
  template <class Own, class Turned>
  Place place_of(const Own& own, std::size_t lane, const Turned& turned) const {
    Place place;
    for (std::size_t k = 0; k < 3; ++k)
      place.of_a[k] = own[0][k][lane], place.of_b[k] = turned[0][k];
    float squared = 0;
    for (std::size_t i = 1; i < 3; ++i) {
      float length = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const float side = own[i][k][lane] - own[0][k][lane];
        length += side * side;
      }
      squared = std::max(squared, length);
    }
    place.radius = std::sqrt(squared) * (1 + 16 * unit_roundoff<float>);
    place.off = between_.corners().off();
    return place;
  }

  /// How far the volume of a triangle of a is from those of all of a leaf of b.
  [[gnu::noinline]] S gaps_of(const NodePair& pair) const {
    const auto one = between_.one_child(0, bodies_[0]->hierarchy().leaf_of(pair.a),
                                        static_cast<int>(pair.a % F), *counter_);
    const auto& leaf = bodies_[1]->hierarchy().node(pair.b);
    counter_->tested(static_cast<std::uint64_t>(std::popcount(leaf.lanes)));
    return between_.separated(1, pair.b, one, *counter_).gap;
  }

  /// As open_triangle, where a distance is sought: pairs whose volumes are near enough are looked
  /// at.
  [[gnu::noinline]] bool open_distances(const NodePair& pair) {
    const auto& a = bodies_[0]->hierarchy();
    const auto& leaf = bodies_[1]->hierarchy().node(pair.b);
    const auto one =
        between_.one_child(0, a.leaf_of(pair.a), static_cast<int>(pair.a % F), *counter_);
    counter_->tested(static_cast<std::uint64_t>(std::popcount(leaf.lanes)));
    const S gaps = between_.gaps(1, pair.b, one, *counter_);
    std::uint64_t left = leaf.lanes & ~bits(query_->culls(gaps));
    counter_->primitives(static_cast<std::uint64_t>(std::popcount(left)));
    for (; left; left &= left - 1)
      if (hold(a.triangle(pair.a), triangle_of_b(leaf.first, left))) return true;
    return pending_ > 0 && flush();
  }

  std::uint32_t triangle_of_b(std::uint32_t first, std::uint64_t lanes) const {
    return bodies_[1]->hierarchy().triangle(first +
                                            static_cast<std::uint32_t>(std::countr_zero(lanes)));
  }

  bool hold(std::uint32_t a, std::uint32_t b) {
    world_[0][pending_] = bodies_[0]->triangle(a), world_[1][pending_] = bodies_[1]->triangle(b);
    candidates_[pending_] = {&world_[0][pending_], &world_[1][pending_], a, b, 0};
    ++pending_;
    return pending_ > std::min(Query::buffer_size, at_most - 1) && flush();
  }

  bool flush() {
    const std::size_t count = std::exchange(pending_, 0);
    return query_->primitives(std::span(candidates_).first(count)).enough;
  }

  static constexpr std::size_t at_most = 16;

  std::array<Body*, 2> bodies_;
  typename Frame::template Between<V, F> between_;
  std::optional<Query> query_;
  [[no_unique_address]] Measure measure_;
  Counter* counter_;
  int steps_;
  Frontier& frontier_;
  Frontier& triangles_;
  std::array<std::array<Triangle, at_most>, 2> world_;
  std::array<Candidate, at_most> candidates_;
  std::size_t pending_ = 0;
};

}  // namespace bvlab
