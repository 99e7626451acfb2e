// SPDX-License-Identifier: BSD-3-Clause
/// Bodies that move from frame to frame, and every pair of them asked in every frame: the talk's
/// setting. Pairs stand in the order (0,1) (0,2) ... (0,n-1) (1,2) ...
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

/// A strategy of which somebody else may test the two roots, for many pairs at once:
///   starts_at_roots()     whether the next run begins with that
///   roots_are_apart()     it did, and there was nothing more to do
///   run_below_roots(...)  like `run`, where they are not apart
/// One query says for all pairs whether roots are apart.
template <class S>
concept RootsFirst = requires(S strategy) {
  { strategy.starts_at_roots() } -> std::same_as<bool>;
  strategy.roots_are_apart();
};

/// Over any kind of bodies: `Bodies` or what offers the same.
template <class BodySet, class Strategy>
class AllPairsOf {
 public:
  /// One copy of `strategy` for each pair; `bodies` makes the BodySet.
  template <class Made>
  AllPairsOf(Made&& bodies, std::vector<ObjectPair> pairs, const Strategy& strategy,
             int threads = 1)
      : bodies_(std::forward<Made>(bodies)),
        pairs_(std::move(pairs)),
        strategies_(pairs_.size(), strategy),
        threads_(threads) {
    bodies_.make_room();
    if (threads_.count() > 1) bodies_.asked_by(Askers::several);
    if constexpr (roots_as_batches) {
      fresh_.reserve(pairs_.size());
      apart_.resize(pairs_.size());
    }
  }

  /// Puts every body where its pose says, and asks every pair: `ask(pair)` makes the query for a
  /// pair (an index into `pairs()`), `take(pair, query)` gets it back with its answer, in the order
  /// of pairs; one is made for the test of roots besides, of which nothing is taken.
  ///
  /// With several threads all queries are asked before the first is taken, and `ask` is called on
  /// any thread, for several pairs at once. Answers, contacts and counts are those of one thread.
  /// What bounds them: tests of roots in batches and the takes are one thread's, a frame of few
  /// pairs ends with the longest, and what one thread has posed another reads from its cache.
  template <class Counter, class Ask, class Take>
  void frame(std::span<const Pose> poses, Counter& counter, Ask&& ask, Take&& take) {
    using Query = std::remove_cvref_t<decltype(ask(0))>;
    if (!placed_) origin_ = middle_of(poses), placed_ = true;
    bodies_.move(poses, origin_);
    if constexpr (roots_as_batches && !wants_bound<Query>()) find_roots_apart(counter, ask);
    if (threads_.count() == 1) return ask_range(0, pairs_.size(), counter, ask, take);
    answers_.ask<Query>(
        threads_, pairs_.size(), pairs_.size(), counter, [](std::size_t p) { return p; },
        [&](std::size_t begin, std::size_t end, std::size_t, Counter& own, auto&& answer) {
          ask_range(begin, end, own, ask, answer);
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

  template <class Counter, class Ask, class Take>
  void ask_range(std::size_t begin, std::size_t end, Counter& counter, Ask& ask, Take& take) {
    constexpr bool roots_first =
        roots_as_batches && !wants_bound<std::remove_cvref_t<decltype(ask(0))>>();
    for (std::size_t p = begin; p < end; ++p) {
      auto query = ask(p);
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
      counter.asked(tested);
      take(p, query);
    }
  }

  template <class Counter, class Ask>
  void find_roots_apart(Counter& counter, Ask& ask) {
    fresh_.clear();
    for (std::uint32_t p = 0; p < pairs_.size(); ++p)
      if (strategies_[p].starts_at_roots()) fresh_.push_back(p);
    if (fresh_.empty()) return;
    auto query = ask(fresh_[0]);
    bodies_.cull_roots(pairs_, fresh_, query, counter, apart_.data());
  }

  BodySet bodies_;
  std::vector<ObjectPair> pairs_;
  std::vector<Strategy> strategies_;
  Threads threads_;
  AnswersInOrder answers_;
  // Only where roots are tested first:
  std::vector<std::uint32_t> fresh_;  // the pairs for which that is done
  std::vector<std::uint8_t> apart_;   // for each pair
  Vec3<double> origin_ = Vec3<double>::Zero();
  bool placed_ = false;
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
