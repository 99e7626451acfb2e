// SPDX-License-Identifier: BSD-3-Clause
/// Queries every pair of a set of moving bodies in every frame, as in the talk's experiments. Pairs
/// are in the order (0,1) (0,2) ... (0,n-1) (1,2) ...
#pragma once

#include <concepts>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "traversal/answers_in_order.hpp"
#include "traversal/bodies.hpp"

namespace bvlab {

/// (0,1) (0,2) ... (0,n-1) (1,2) ...: n(n-1)/2 pairs.
inline std::vector<ObjectPair> all_object_pairs(std::uint32_t objects) {
  std::vector<ObjectPair> pairs;
  for (std::uint32_t i = 0; i < objects; ++i)
    for (std::uint32_t j = i + 1; j < objects; ++j) pairs.push_back({i, j});
  return pairs;
}

/// A strategy whose test of the two roots can be made by the caller, for many pairs at once:
///   starts_at_roots()     whether the next run begins with the test of the roots
///   roots_are_apart()     the caller found the roots apart: the run is over
///   run_below_roots(...)  like `run`, for roots known to overlap
/// One query object tests the roots of all pairs.
template <class S>
concept RootsFirst = requires(S strategy) {
  { strategy.starts_at_roots() } -> std::same_as<bool>;
  strategy.roots_are_apart();
};

/// BodySet is `Bodies` or a class with the same members.
template <class BodySet, class Strategy>
class AllPairsOf {
 public:
  /// Each pair gets a copy of `strategy`. The BodySet is constructed from `bodies`.
  template <class Made>
  AllPairsOf(Made&& bodies, std::vector<ObjectPair> pairs, const Strategy& strategy,
             int threads = 1)
      : bodies_(std::forward<Made>(bodies)),
        pairs_(std::move(pairs)),
        strategies_(pairs_.size(), strategy),
        threads_(threads) {
    bodies_.make_room();
    if (threads_.count() > 1) bodies_.set_sharing(Sharing::several_threads);
    if constexpr (roots_as_batches) {
      fresh_.reserve(pairs_.size());
      apart_.resize(pairs_.size());
    }
  }

  /// Moves every body to its pose and runs every pair's query. `make_query(p)` returns the query
  /// for pair p (an index into `pairs()`); `take(p, query)` receives it with its answer, in the
  /// order of pairs. One more query is made for the batched test of roots; it is never passed to
  /// `take`.
  ///
  /// With several threads, all queries run before the first `take`, and `make_query` is called on
  /// any thread, concurrently. Answers, contacts and counts equal those of one thread. Three things
  /// limit the speedup: the batched test of roots and the calls of `take` are serial, a frame of
  /// few pairs lasts as long as its longest pair, and threads read posed volumes from each other's
  /// caches.
  template <class Counter, class MakeQuery, class Take>
  void frame(std::span<const Pose> poses, Counter& counter, MakeQuery&& make_query, Take&& take) {
    using Query = std::remove_cvref_t<decltype(make_query(0))>;
    if (!has_origin_) origin_ = centre_of(poses), has_origin_ = true;
    bodies_.move(poses, origin_);
    if constexpr (roots_as_batches && !wants_bound<Query>()) find_roots_apart(counter, make_query);
    if (threads_.count() == 1) return run_range(0, pairs_.size(), counter, make_query, take);
    answers_.run<Query>(
        threads_, pairs_.size(), pairs_.size(), counter, [](std::size_t p) { return p; },
        [&](std::size_t begin, std::size_t end, std::size_t, Counter& own, auto&& answer) {
          run_range(begin, end, own, make_query, answer);
        },
        take);
  }

  BodySet& bodies() { return bodies_; }
  const std::vector<ObjectPair>& pairs() const { return pairs_; }
  const Strategy& strategy(std::size_t pair) const { return strategies_[pair]; }

  /// The entries of all fronts together.
  std::size_t front_size() const {
    std::size_t sum = 0;
    for (const auto& strategy : strategies_) sum += strategy.front_size();
    return sum;
  }

 private:
  static constexpr bool roots_as_batches = BodySet::culls_in_batches && RootsFirst<Strategy>;

  template <class Counter, class MakeQuery, class Take>
  void run_range(std::size_t begin, std::size_t end, Counter& counter, MakeQuery& make_query,
                 Take& take) {
    constexpr bool roots_first =
        roots_as_batches && !wants_bound<std::remove_cvref_t<decltype(make_query(0))>>();
    for (std::size_t p = begin; p < end; ++p) {
      auto query = make_query(p);
      const std::uint64_t tested = counter.n_v + counter.n_p;
      const auto pair = bodies_.pair(pairs_[p], query, counter);
      if constexpr (roots_first) {
        const bool from_roots = strategies_[p].starts_at_roots();
        if (from_roots) {
          counter.tested(1);
        }
        if (!from_roots)
          strategies_[p].run(pair);
        else if (apart_[p])
          strategies_[p].roots_are_apart();
        else
          strategies_[p].run_below_roots(pair);
      } else {
        strategies_[p].run(pair);
      }
      counter.queried(tested);
      take(p, query);
    }
  }

  template <class Counter, class MakeQuery>
  void find_roots_apart(Counter& counter, MakeQuery& make_query) {
    fresh_.clear();
    for (std::uint32_t p = 0; p < pairs_.size(); ++p)
      if (strategies_[p].starts_at_roots()) fresh_.push_back(p);
    if (fresh_.empty()) return;
    auto query = make_query(fresh_[0]);
    bodies_.cull_roots(pairs_, fresh_, query, counter, apart_.data());
  }

  BodySet bodies_;
  std::vector<ObjectPair> pairs_;
  std::vector<Strategy> strategies_;
  Threads threads_;
  AnswersInOrder answers_;
  // Only where roots are tested first:
  std::vector<std::uint32_t> fresh_;  // pairs whose next run starts at the roots
  std::vector<std::uint8_t> apart_;   // for each pair, whether its roots are apart
  Vec3<double> origin_ = Vec3<double>::Zero();
  bool has_origin_ = false;
};

/// One body for each shape (meshes and hierarchies must outlive this). B is the scalar or batch in
/// which volumes are tested.
template <class B, BoundingVolume V, class Strategy>
class AllPairs : public AllPairsOf<Bodies<B, V>, Strategy> {
 public:
  AllPairs(std::span<const Shape<V>> shapes, std::vector<ObjectPair> pairs,
           const Strategy& strategy, int threads = 1)
      : AllPairsOf<Bodies<B, V>, Strategy>(shapes, std::move(pairs), strategy, threads) {}
};

}  // namespace bvlab
