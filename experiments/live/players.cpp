// SPDX-License-Identifier: BSD-3-Clause
/// Compiled once for each query: BVLAB_LIVE_QUERY.
#include "experiments/live/players.hpp"

#include <cstdlib>

#include "experiments/live/watched_front.hpp"
#include "experiments/replay/bodies_of.hpp"
#include "experiments/replay/played.hpp"
#include "experiments/replay/wide_of.hpp"
#include "hierarchies/wide/slab_box_sibling_test.hpp"
#include "traversal/queries.hpp"

namespace bvlab::live {
namespace {

/// A pair that tells which entries of its front a run has tested, if it is watched.
template <class Query>
class WatchedPair : public PairOfBodies<BodiesInside<Query>::W, Query, Counting> {
  using Pair = PairOfBodies<BodiesInside<Query>::W, Query, Counting>;

 public:
  WatchedPair(const Pair& pair, std::vector<NodePair>* tested) : Pair(pair), tested_(tested) {}

  template <class Front>
  TraversalStatistics from_front(Front&& front) const {
    if constexpr (std::is_same_v<std::remove_cvref_t<Front>, NoFront>)
      return Pair::from_front(front);
    else
      return Pair::from_front(WatchedFront(front, tested_));
  }

 private:
  std::vector<NodePair>* tested_;
};

template <class Query>
class WatchedBodies : public AnyBodies<Query> {
 public:
  WatchedBodies(std::unique_ptr<BodiesInside<Query>> inside, Run& run)
      : AnyBodies<Query>(std::move(inside)), run_(&run) {}

  WatchedPair<Query> pair(const ObjectPair& pair, Query& query, Counting& counter) {
    const std::size_t n = this->size(), i = pair.i, j = pair.j;
    const bool watched = i * (2 * n - i - 1) / 2 + j - i - 1 == run_->watched;
    return {AnyBodies<Query>::pair(pair, query, counter), watched ? &run_->tested : nullptr};
  }

 private:
  Run* run_;
};

/// In place of hierarchies by mesh: no body is added.
struct NothingIsAdded {
  static OneOfHierarchies of(const TriangleMesh&) { std::abort(); }
};

template <class Query>
std::unique_ptr<detail::AnyPairs<Query>> gathered(const Trace& trace, Run& run) {
  std::unique_ptr<BodiesInside<Query>> inside;
  Volumes::with(run.variant.volume, [&]<class V>(std::type_identity<V>) {
    inside = detail::bodies_over<V, Query>(*run.hierarchies, trace.objects, frame_of(run.variant));
  });
  std::unique_ptr<detail::AnyPairs<Query>> made;
  if (inside)
    Strategies::with(run.variant.strategy, [&]<class Strategy>(std::type_identity<Strategy>) {
      using Pairs = StrategyPairs<WatchedBodies<Query>, Strategy>;
      made = std::make_unique<detail::PairsOver<Pairs, Query, NothingIsAdded>>(
          std::make_shared<NothingIsAdded>(),
          Pairs(WatchedBodies<Query>(std::move(inside), run), Strategy{}));
    });
  return made;
}

template <class Kernel, class Query>
std::unique_ptr<detail::AnyPairs<Query>> wide(std::span<const TriangleMesh> meshes,
                                              const Trace& trace, Run& run) {
  std::unique_ptr<detail::AnyPairs<Query>> made;
  WideVolumes::with(run.variant.volume, [&]<class V>(std::type_identity<V>) {
    using InLoops = std::conditional_t<HasSiblingTest<V>, V, AnyVolume>;
    using Tree = detail::TreeOf<InLoops, Kernel>;
    const auto trees = std::make_shared<detail::WideTreesOf<detail::TreeOf<V, Kernel>, Tree>>(
        meshes, run.variant, 1);
    const auto shapes = trees->shapes(meshes, trace.objects);
    const auto with = [&]<class Memory>(const Memory& memory) {
      using Pairs = WidePairs<InLoops, detail::kernel_lanes<Kernel>, Memory, Kernel>;
      made = std::make_unique<detail::PairsOver<Pairs, Query, detail::WideTrees<Tree>>>(
          trees, Pairs(shapes, memory));
    };
    if (run.variant.strategy == WideMargins::name)
      with(WideMargins());
    else if (run.variant.strategy == Recursive::name)
      with(NoMemory());
  });
  return made;
}

}  // namespace

template <class Query>
std::unique_ptr<detail::Player> player(std::span<const TriangleMesh> meshes, const Trace& trace,
                                       Run& run) {
  std::unique_ptr<detail::AnyPairs<Query>> pairs;
  if (run.variant.kernel == "gathered") pairs = gathered<Query>(trace, run);
  if constexpr (for_wide_trees<Query>())
    Kernels::with(run.variant.kernel, [&]<class Kernel>(std::type_identity<Kernel>) {
      pairs = wide<Kernel, Query>(meshes, trace, run);
    });
  if (!pairs) return nullptr;
  return detail::player_over(std::move(pairs), meshes, trace, run.variant, run.options, run.result);
}

template std::unique_ptr<detail::Player> player<BVLAB_LIVE_QUERY>(std::span<const TriangleMesh>,
                                                                  const Trace&, Run&);

}  // namespace bvlab::live
