// SPDX-License-Identifier: BSD-3-Clause
/// Compiled once for each query: BVLAB_LIVE_QUERY.
#include "experiments/live/players.hpp"

#include <cstdlib>

#include "experiments/live/watched_front.hpp"
#include "experiments/replay/any_bodies.hpp"
#include "experiments/replay/loops_of.hpp"
#include "experiments/replay/played.hpp"
#include "experiments/replay/wide_of.hpp"
#include "hierarchies/wide/slab_box_sibling_test.hpp"
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

/// In place of hierarchies by mesh: no body is added.
struct NothingIsAdded {
  static OneOfHierarchies of(const TriangleMesh&) { std::abort(); }
};

template <class Query>
std::unique_ptr<detail::AnyPairs<Query>> gathered(const Trace& trace, Run& run) {
  std::unique_ptr<BodyLoops<Query>> loops;
  Volumes::with(run.variant.volume, [&]<class V>(std::type_identity<V>) {
    loops = std::make_unique<WatchedLoops<V, Query>>(trace, run);
  });
  std::unique_ptr<detail::AnyPairs<Query>> made;
  if (loops)
    Strategies::with(run.variant.strategy, [&]<class Strategy>(std::type_identity<Strategy>) {
      using Bodies = AnyBodies<Query, Counting, Fronts>;
      using Pairs = StrategyPairs<Bodies, Strategy>;
      made = std::make_unique<detail::PairsOver<Pairs, Query, NothingIsAdded>>(
          std::make_shared<NothingIsAdded>(), Pairs(Bodies(std::move(loops)), Strategy{}));
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
