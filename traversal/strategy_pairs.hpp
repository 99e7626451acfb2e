// SPDX-License-Identifier: BSD-3-Clause
/// Pairs of bodies over trees of any fan-out, each with a strategy of its own: pairs in
/// slots, as AllPairsOf and WorldOf use them.
///
/// The pairs are divided among the threads. In a World the first thread that needs a body moves it
/// and poses its volumes: what is posed and tested is the same for any number of threads.
#pragma once

#include <concepts>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "hierarchies/geometry/once.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "hierarchies/geometry/unless_done.hpp"
#include "traversal/bodies.hpp"

namespace bvlab {

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
class StrategyPairs {
 public:
  /// The BodySet is constructed from `bodies`; each pair begins with a copy of `strategy`.
  template <class Made>
  StrategyPairs(Made&& bodies, const Strategy& strategy)
      : bodies_(std::forward<Made>(bodies)),
        prototype_(strategy),
        moved_(bodies_.size(), never_done) {}

  std::size_t size() const { return bodies_.size(); }
  const TriangleMesh& mesh(std::size_t i) const { return bodies_.mesh(i); }
  const Vec3<double>& mesh_origin(std::size_t i) const { return bodies_.mesh_origin(i); }

  /// Adds a body, of what BodySet::add takes.
  template <class... OfBody>
  void add(const OfBody&... of_body) {
    bodies_.add(of_body...);
    moved_.push_back(never_done);
  }

  void put(std::uint32_t slot, const ObjectPair& pair) {
    if (slot >= pairs_.size()) strategies_.resize(slot + 1, prototype_), pairs_.resize(slot + 1);
    pairs_[slot] = pair;
  }
  void drop(std::uint32_t slot) { strategies_[slot] = prototype_; }

  void make_room(const Threads& threads) {
    bodies_.make_room();
    share_among(threads);
    if constexpr (roots_as_batches) fresh_.reserve(pairs_.size()), apart_.resize(pairs_.size());
  }

  /// Begins a frame in which every body may have moved. Moves all, and tests the roots of pairs
  /// that start there, where that pays.
  template <class Counter, class MakeQuery>
  void begin_all(std::span<const Pose> poses, const Vec3<double>& origin, const Threads& threads,
                 Counter& counter, MakeQuery& make_query) {
    share_among(threads);
    bodies_.move(poses, origin);
    are_all_moved_ = true;
    if constexpr (roots_as_batches && !wants_bound<QueryOf<MakeQuery>>())
      find_roots_apart(counter, make_query);
  }

  /// Begins a frame in which some have moved. A body is moved when the first of its pairs is
  /// queried; `poses` and `origin` must stay valid until then.
  template <class Query>
  void begin(std::span<const std::uint32_t>, std::span<const Pose> poses,
             const Vec3<double>& origin, const Threads& threads) {
    share_among(threads);
    poses_ = poses, origin_ = &origin;
    are_all_moved_ = false;
    if (++frame_ >= never_done) frame_ = 0;
  }
  void set_pose(std::uint32_t) {}

  template <class Slots, class Counter, class MakeQuery, class Take>
  void run(const Slots& slots, std::size_t, Counter& counter, MakeQuery&& make_query, Take&& take) {
    for (const std::uint32_t slot : slots) {
      const ObjectPair& pair = pairs_[slot];
      auto query = make_query(slot, pair);
      const std::uint64_t before = counter.tests();
      if (!are_all_moved_)
        for (const auto k : {pair.i, pair.j})
          once(moved_[k], frame_, sharing_, [&] { bodies_.move(k, poses_[k], *origin_); });
      run_pair(slot, bodies_.pair(pair, query, counter), counter);
      counter.queried(before);
      take(slot, pair, query);
    }
  }

  BodySet& bodies() { return bodies_; }
  const std::vector<ObjectPair>& pairs() const { return pairs_; }
  const Strategy& strategy(std::size_t slot) const { return strategies_[slot]; }

  std::size_t front_size(std::uint32_t slot) const { return strategies_[slot].front_size(); }
  std::size_t front_size() const {
    std::size_t sum = 0;
    for (const auto& strategy : strategies_) sum += strategy.front_size();
    return sum;
  }

 private:
  static constexpr bool roots_as_batches = BodySet::culls_in_batches && RootsFirst<Strategy>;
  template <class MakeQuery>
  using QueryOf =
      std::remove_cvref_t<decltype(std::declval<MakeQuery&>()(std::uint32_t{}, ObjectPair{}))>;

  void share_among(const Threads& threads) {
    const Sharing sharing = threads.count() > 1 ? Sharing::several_threads : Sharing::one_thread;
    if (sharing != sharing_) bodies_.set_sharing(sharing_ = sharing);
  }

  /// After an exception, of a query or of an allocation, what the strategy keeps may lack entries:
  /// the next run begins with a new one.
  template <class Pair, class Counter>
  void run_pair(std::uint32_t slot, const Pair& pair, Counter& counter) {
    UnlessDone undo([&] { drop(slot); });
    Strategy& strategy = strategies_[slot];
    if constexpr (roots_as_batches && !wants_bound<typename Pair::Query>())
      if (are_all_moved_ && strategy.starts_at_roots()) {
        counter.tested(1);
        if (apart_[slot])
          strategy.roots_are_apart();
        else
          strategy.run_below_roots(pair);
        return undo.is_done();
      }
    strategy.run(pair);
    undo.is_done();
  }

  template <class Counter, class MakeQuery>
  void find_roots_apart(Counter& counter, MakeQuery& make_query) {
    fresh_.clear();
    for (std::uint32_t slot = 0; slot < pairs_.size(); ++slot)
      if (strategies_[slot].starts_at_roots()) fresh_.push_back(slot);
    if (fresh_.empty()) return;
    auto query = make_query(fresh_[0], pairs_[fresh_[0]]);
    bodies_.cull_roots(pairs_, fresh_, query, counter, apart_.data());
  }

  BodySet bodies_;
  Strategy prototype_;
  std::vector<ObjectPair> pairs_;
  std::vector<Strategy> strategies_;
  std::vector<std::uint32_t> moved_;  // the frame in which each body was moved last
  std::span<const Pose> poses_;
  const Vec3<double>* origin_ = nullptr;
  std::uint32_t frame_ = 0;
  Sharing sharing_ = Sharing::one_thread;
  bool are_all_moved_ = false;  // in this frame, by begin_all
  // Where roots are tested first, in frames in which all are moved:
  std::vector<std::uint32_t> fresh_;  // slots whose next run starts at the roots
  std::vector<std::uint8_t> apart_;   // for each slot, whether its roots are apart
};

}  // namespace bvlab
