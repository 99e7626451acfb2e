// SPDX-License-Identifier: BSD-3-Clause
/// Queries every pair of a set of moving bodies in every frame, as in the experiments of
/// li1998incremental. Pairs are in the order (0,1) (0,2) ... (0,n-1) (1,2) ...
#pragma once

#include <cstdint>
#include <ranges>
#include <span>
#include <utility>
#include <vector>

#include "traversal/answers_in_order.hpp"
#include "traversal/pair_choice.hpp"
#include "traversal/strategy_pairs.hpp"

namespace bvlab {

/// (0,1) (0,2) ... (0,n-1) (1,2) ...: n(n-1)/2 pairs.
inline std::vector<ObjectPair> all_object_pairs(std::uint32_t objects) {
  return chosen_pairs({}, objects);
}

/// Pairs is StrategyPairs, WidePairs, or a class with the same members: those that WorldOf uses,
/// and
///   mesh_origin(i)                 of the mesh of body i (LocalMesh)
///   make_room(threads)             allocates for all bodies, so that no frame has to
///   begin_all(poses, origin, threads, counter, make_query)
///                                  begins a frame in which every body may have moved: moves all
///   front_size()                   the entries of all fronts together
template <class Pairs>
class AllPairsOf {
 public:
  /// `engine` has the bodies, and no pairs yet.
  AllPairsOf(Pairs engine, const std::vector<ObjectPair>& pairs, int threads = 1)
      : engine_(std::move(engine)), threads_(threads) {
    // The last slot first: room for all is made at once.
    for (std::size_t p = pairs.size(); p-- > 0;)
      engine_.put(static_cast<std::uint32_t>(p), pairs[p]);
    engine_.make_room(threads_);
  }

  /// Moves every body to its pose, poses[i] for body i, and runs every pair's query.
  /// `make_query(p)` returns the query for pair p (an index into `pairs()`); `take(p, query)`
  /// receives it with its answer: StrategyPairs in the order of pairs, WidePairs in any order. More
  /// queries may be made than are taken: to test roots of all pairs at once, or triangles that a
  /// pair kept. After an exception, of a query, of `take` or of an allocation, later frames are
  /// answered as if it had not occurred.
  ///
  /// With several threads, all queries run before the first `take`, the order is that of pairs, and
  /// `make_query` is called on any thread, concurrently. Answers, contacts and counts equal those
  /// of one thread. Three things limit the speedup: what is done for all pairs at once and the
  /// calls of `take` are serial, a frame of few pairs lasts as long as its longest pair, and
  /// threads read posed volumes from each other's caches.
  template <class Counter, class MakeQuery, class Take>
  void frame(std::span<const Pose> poses, Counter& counter, MakeQuery&& make_query, Take&& take) {
    const auto make = [&make_query](std::uint32_t slot, const ObjectPair&) {
      return make_query(std::size_t{slot});
    };
    if (!has_origin_) origin_ = centre_of(poses, engine_), has_origin_ = true;
    engine_.begin_all(poses, origin_, threads_, counter, make);
    const auto all = std::views::iota(std::uint32_t{0}, static_cast<std::uint32_t>(pairs().size()));
    answers_.run_pairs(
        engine_, threads_, all, pairs().size(), counter, make,
        [&take](std::uint32_t slot, const ObjectPair&, auto&& query) { take(slot, query); });
  }

  const std::vector<ObjectPair>& pairs() const { return engine_.pairs(); }
  /// The entries of all fronts together.
  std::size_t front_size() const { return engine_.front_size(); }

  /// Of StrategyPairs.
  auto& bodies()
    requires requires(Pairs& engine) { engine.bodies(); }
  {
    return engine_.bodies();
  }
  const auto& strategy(std::size_t pair) const
    requires requires(const Pairs& engine) { engine.strategy(0); }
  {
    return engine_.strategy(pair);
  }

 private:
  Pairs engine_;
  Threads threads_;
  AnswersInOrder answers_;
  Vec3<double> origin_ = Vec3<double>::Zero();
  bool has_origin_ = false;
};

/// One body for each shape (meshes and hierarchies must outlive this). B is the scalar or batch in
/// which volumes are tested. Each pair begins with a copy of `strategy`.
template <class B, BoundingVolume V, class Strategy>
class AllPairs : public AllPairsOf<StrategyPairs<Bodies<B, V>, Strategy>> {
 public:
  AllPairs(std::span<const Shape<V>> shapes, const std::vector<ObjectPair>& pairs,
           const Strategy& strategy, int threads = 1)
      : AllPairsOf<StrategyPairs<Bodies<B, V>, Strategy>>({shapes, strategy}, pairs, threads) {}
};

}  // namespace bvlab
