// SPDX-License-Identifier: BSD-3-Clause
/// All that is compiled for a volume in wide trees under one query.
#pragma once

#include <array>
#include <concepts>
#include <deque>
#include <memory>
#include <string>
#include <type_traits>
#include <unordered_map>

#include "experiments/replay/any_pairs.hpp"
#include "experiments/replay/hierarchies_of.hpp"
#include "experiments/replay/play_pairs.hpp"
#include "experiments/replay/strategy_text.hpp"
#include "experiments/replay/wide_entry.hpp"
#include "hierarchies/builds.hpp"
#include "traversal/strategies/by_cost.hpp"
#include "traversal/wide/kernels.hpp"
#include "traversal/wide/list_memory.hpp"
#include "traversal/wide/wide_pairs.hpp"

namespace bvlab {

namespace detail {

/// How many children per node has.
template <class Kernel, class T>
inline constexpr int fan_out_of = native_fan_out<T>;
template <class T>
inline constexpr int fan_out_of<MixedKernel, T> = 4;

/// Those of some meshes, and of others when a body of them comes (see HierarchiesByMesh).
template <class Hierarchy>
class WideHierarchies {
 public:
  WideHierarchies(std::span<const TriangleMesh> meshes, const Variant& variant, int threads)
      : variant_(variant), threads_(threads) {
    for (const auto& mesh : meshes) of(mesh);
  }

  /// The mesh must outlive this.
  ShapeOver<Hierarchy> of(const TriangleMesh& mesh) {
    if (const auto at = known_.find(&mesh); at != known_.end()) return {&mesh, at->second};
    return {&mesh, known_[&mesh] = &build(mesh)};
  }
  const std::deque<Hierarchy>& all() const { return all_; }
  /// All, and those that have been made.
  std::array<std::size_t, 2> nodes() const
    requires requires(const Hierarchy& hierarchy) { hierarchy.made(); }
  {
    std::array<std::size_t, 2> sum{};
    for (const auto& hierarchy : all_) sum[0] += hierarchy.known(), sum[1] += hierarchy.made();
    return sum;
  }

 private:
  const Hierarchy& build(const TriangleMesh& mesh) {
    if constexpr (requires { Hierarchy::on_demand(mesh, variant_.leaf_size); })
      if (variant_.build == builds::OnDemand::name)
        return all_.emplace_back(Hierarchy::on_demand(mesh, variant_.leaf_size));
    Threads several(threads_);
    // Leaves are made while the tree is collapsed.
    Variant down_to_triangles = variant_;
    down_to_triangles.leaf_size = 1;
    return all_.emplace_back(mesh, topology_of(mesh, down_to_triangles), fit_of(variant_),
                             variant_.leaf_size, several);
  }

  Variant variant_;
  int threads_;
  std::deque<Hierarchy> all_;  // a deque: bodies refer to its elements while it grows
  std::unordered_map<const TriangleMesh*, const Hierarchy*> known_;
};

/// Volumes that these kernels take: over float, with a sibling test of their own or
/// PosedSiblingTest.
template <class V>
concept WideVolume = std::same_as<typename V::scalar, float> &&
                     (HasSiblingTest<V> || (std::same_as<Posed<V>, V> && PlacedRelatively<V>));

/// Calls `with` with what pairs keep under the variant's strategy, whose name and parameter have
/// been checked. Steps of these kernels open one node or both by the nodes' sizes, so that the two
/// ways to recur are one. Margins begin and end with the motion of each pair, so they are
/// `adaptive`.
template <class With>
void with_memory(const Variant& variant, const With& with) {
  const std::string_view name = name_of(variant.strategy);
  if (name == "margins" || name == "adaptive") return with(WideMargins());
  if (name == "witness") return with(NoMemory(NoMemory::Witness::kept));
  if (name == "separation-list") return with(ListMemory());
  if (name == "deferred") return with(ListMemory(made_from<Deferred>(variant.strategy).rule()));
  if (name == "by-cost") return with(ListMemory(ByCost().rule()));
  if (name == "raise")
    return with(ListMemory(RebuildRule::by_last_rebuild(), ListMemory::Raise::tried));
  with(NoMemory());
}

/// The hierarchies of a variant, of those that are kept or new. Adds the time to build to
/// `build_seconds`.
template <class Hierarchies>
std::shared_ptr<Hierarchies> hierarchies_of(std::span<const TriangleMesh> meshes,
                                            const Variant& variant, int threads, KeptTrees* kept,
                                            double& build_seconds) {
  KeptTrees here;
  TreesOfMeshes& of = (kept ? *kept : here)[trees_of(variant)];
  if (!of.trees) {
    const auto start = Clock::now();
    of.trees = std::make_shared<Hierarchies>(meshes, variant, threads);
    of.seconds = seconds_since(start);
  }
  build_seconds += of.seconds;
  return std::static_pointer_cast<Hierarchies>(of.trees);
}

/// Adds the time to build to `build_seconds`.
template <BoundingVolume V, class Query>
std::unique_ptr<AnyPairs<Query>> wide_pairs(std::span<const TriangleMesh> meshes,
                                            std::size_t objects, const Variant& variant,
                                            int threads, KeptTrees* kept, double& build_seconds) {
  std::unique_ptr<AnyPairs<Query>> made;
  Kernels::with(variant.kernel, [&]<class Kernel>(std::type_identity<Kernel>) {
    constexpr int fan_out = fan_out_of<Kernel, typename V::scalar>;
    using Hierarchies = WideHierarchies<typename Kernel::template Hierarchy<V, fan_out>>;
    const auto hierarchies =
        hierarchies_of<Hierarchies>(meshes, variant, threads, kept, build_seconds);
    const auto shapes = shapes_over(meshes, hierarchies->all(), objects);
    with_memory(variant, [&]<class Memory>(const Memory& memory) {
      using Pairs = WidePairs<V, fan_out, Memory, Kernel>;
      made = std::make_unique<PairsOver<Pairs, Query, Hierarchies>>(hierarchies,
                                                                    Pairs(shapes, memory));
    });
  });
  return made;
}

template <BoundingVolume V, class Query>
void play_wide(std::span<const TriangleMesh> meshes, const Trace& trace, const Variant& variant,
               const ReplayOptions& options, ReplayResult& result) {
  play_pairs(wide_pairs<V, Query>(meshes, trace.objects, variant, static_cast<int>(options.threads),
                                  options.trees, result.build_seconds),
             meshes, trace, variant, options, result);
}

/// Null where the query is no matter of yes or no.
template <BoundingVolume V, class Query>
std::unique_ptr<WorldEngine> wide_world(std::span<const TriangleMesh> meshes, std::size_t objects,
                                        const Variant& variant, int threads) {
  double build_seconds = 0;
  return world_of_pairs(
      wide_pairs<V, Query>(meshes, objects, variant, threads, nullptr, build_seconds), variant,
      threads);
}

template <BoundingVolume V>
constexpr std::uint32_t fan_out_with(std::string_view kernel) {
  std::uint32_t fan_out = 0;
  if constexpr (WideVolume<V>)
    Kernels::with(kernel, [&]<class Kernel>(std::type_identity<Kernel>) {
      fan_out = fan_out_of<Kernel, typename V::scalar>;
    });
  return fan_out;
}

}  // namespace detail

template <BoundingVolume V, class Query>
constexpr WideEntry wide_of() {
  WideEntry entry{V::name, V::description, Query::name, detail::fan_out_with<V>, nullptr, nullptr};
  if constexpr (detail::WideVolume<V> && for_wide_trees<Query>())
    entry.play = detail::play_wide<V, Query>, entry.world = detail::wide_world<V, Query>;
  return entry;
}

}  // namespace bvlab
