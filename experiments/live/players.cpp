// SPDX-License-Identifier: BSD-3-Clause
/// Compiled once for each query: BVLAB_LIVE_QUERY.
#include "experiments/live/players.hpp"

#include "experiments/live/watched_front.hpp"
#include "experiments/replay/loops_of.hpp"
#include "experiments/replay/play.hpp"
#include "experiments/replay/wide_of.hpp"
#include "traversal/queries.hpp"

namespace bvlab::live {
namespace {

/// The fronts of the strategies above.
using Fronts = TypeList<NoFront, Front, RisingFront, MarginSweep>;

template <BoundingVolume V, class Query>
class WatchedLoops final : public detail::BodiesOver<V, Query> {
 public:
  WatchedLoops(const Trace& trace, Run& run)
      : detail::BodiesOver<V, Query>(
            static_cast<const HierarchiesOf<V>&>(*run.hierarchies).shapes(trace.objects),
            frame_of(run.variant)),
        run_(run) {}
  AnyLoop loop(const std::type_info& front) const override { return find(front, Fronts{}); }

 private:
  template <class... All>
  static AnyLoop find(const std::type_info& front, TypeList<All...>) {
    AnyLoop found = nullptr;
    ((front == typeid(All) ? void(found = reinterpret_cast<AnyLoop>(traverse<All>)) : void()), ...);
    return found;
  }

  template <class Front>
  static TraversalStatistics traverse(BodyLoops<Query>& bodies, const ObjectPair& pair,
                                      Query& query, Front& front) {
    auto& self = static_cast<WatchedLoops&>(bodies);
    const auto between = self.pair(pair, query);
    if constexpr (std::is_same_v<Front, NoFront>) {
      return between.from_front(front);
    } else {
      const std::size_t n = self.size(), i = pair.i, j = pair.j;
      const bool watched = i * (2 * n - i - 1) / 2 + j - i - 1 == self.run_.watched;
      return between.from_front(WatchedFront(front, watched ? &self.run_.tested : nullptr));
    }
  }

  Run& run_;
};

template <class Query, class Engine>
std::unique_ptr<detail::Player> played(Engine engine, const Trace& trace, Run& run) {
  const QueryOptions how{triangle_test(run.variant.precision), run.variant.relative_error};
  return std::make_unique<detail::PlayedBy<Engine, Query, Counting>>(std::move(engine), trace, how,
                                                                     run.options, run.result);
}

std::vector<ObjectPair> pairs_of(const Trace& trace) {
  return all_object_pairs(static_cast<std::uint32_t>(trace.objects));
}

template <class Query>
std::unique_ptr<detail::Player> gathered(const Trace& trace, Run& run) {
  std::unique_ptr<BodyLoops<Query>> loops;
  Volumes::with(run.variant.volume, [&]<class V>(std::type_identity<V>) {
    loops = std::make_unique<WatchedLoops<V, Query>>(trace, run);
  });
  std::unique_ptr<detail::Player> player;
  if (loops)
    Strategies::with(run.variant.strategy, [&]<class Strategy>(std::type_identity<Strategy>) {
      using Bodies = AnyBodies<Query, Counting, Fronts>;
      player = played<Query>(AllPairsOf<StrategyPairs<Bodies, Strategy>>(
                                 {Bodies(std::move(loops)), Strategy{}}, pairs_of(trace)),
                             trace, run);
    });
  return player;
}

/// An engine and the trees that it is over.
template <class Hierarchies, class Engine>
class OverOwnTrees : public Engine {
 public:
  OverOwnTrees(std::unique_ptr<Hierarchies> hierarchies, Engine engine)
      : Engine(std::move(engine)), hierarchies_(std::move(hierarchies)) {}

 private:
  std::unique_ptr<Hierarchies> hierarchies_;
};

template <class Query>
std::unique_ptr<detail::Player> siblings(std::span<const TriangleMesh> meshes, const Trace& trace,
                                         Run& run) {
  std::unique_ptr<detail::Player> player;
  WideVolumes::with(run.variant.volume, [&]<class V>(std::type_identity<V>) {
    constexpr int fan_out = native_fan_out<typename V::scalar>;
    using Trees = std::vector<typename SiblingsKernel::template Hierarchy<V, fan_out>>;
    auto trees = std::make_unique<Trees>(
        detail::wide_hierarchies<typename Trees::value_type>(meshes, run.variant, 1));
    const auto shapes = shapes_over(meshes, *trees, trace.objects);
    const auto with = [&]<class Memory>(std::type_identity<Memory>) {
      using Engine = AllPairsOf<WidePairs<V, fan_out, Memory, SiblingsKernel>>;
      player = played<Query>(
          OverOwnTrees<Trees, Engine>(
              std::move(trees), Engine(WidePairs<V, fan_out, Memory, SiblingsKernel>(shapes),
                                       pairs_of(trace))),
          trace, run);
    };
    if (run.variant.strategy == WideMargins::name)
      with(std::type_identity<WideMargins>());
    else if (run.variant.strategy == Recursive::name)
      with(std::type_identity<NoMemory>());
  });
  return player;
}

}  // namespace

template <class Query>
std::unique_ptr<detail::Player> player(std::span<const TriangleMesh> meshes, const Trace& trace,
                                       Run& run) {
  if (run.variant.kernel == "gathered") return gathered<Query>(trace, run);
  if constexpr (for_wide_trees<Query>())
    if (run.variant.kernel == SiblingsKernel::name) return siblings<Query>(meshes, trace, run);
  return nullptr;
}

template std::unique_ptr<detail::Player> player<BVLAB_LIVE_QUERY>(std::span<const TriangleMesh>,
                                                                  const Trace&, Run&);

}  // namespace bvlab::live
