// SPDX-License-Identifier: BSD-3-Clause
/// All that is compiled for a volume in wide trees under one query.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <type_traits>

#include "experiments/replay/play_pairs.hpp"
#include "experiments/replay/wide_entry.hpp"
#include "experiments/replay/wide_pairs_over.hpp"

namespace bvlab {

namespace detail {

/// The trees of a variant, of those that are kept or new. Adds the time to build to
/// `build_seconds`.
template <class Trees>
std::shared_ptr<Trees> wide_trees_of(std::span<const TriangleMesh> meshes, const Variant& variant,
                                     int threads, KeptTrees* kept, double& build_seconds) {
  KeptTrees here;
  TreesOfMeshes& of = (kept ? *kept : here)[trees_of(variant)];
  if (!of.trees) {
    const auto start = Clock::now();
    of.trees = std::make_shared<Trees>(meshes, variant, threads);
    of.seconds = seconds_since(start);
  }
  build_seconds += of.seconds;
  return std::static_pointer_cast<Trees>(of.trees);
}

/// Adds the time to build to `build_seconds`.
template <BoundingVolume V, class Query>
std::unique_ptr<AnyPairs<Query>> wide_pairs(std::span<const TriangleMesh> meshes,
                                            std::size_t objects, const Variant& variant,
                                            int threads, KeptTrees* kept, double& build_seconds) {
  std::unique_ptr<AnyPairs<Query>> made;
  const auto trees = [&]<class Hierarchy, class Tree>() {
    return wide_trees_of<WideTreesOf<Hierarchy, Tree>>(meshes, variant, threads, kept,
                                                       build_seconds);
  };
  Kernels::with(variant.kernel, [&]<class Kernel>(std::type_identity<Kernel>) {
    const auto any = [&]<int lanes>() {
      made = pairs_over_any<Query>(
          trees.template operator()<TreeOf<V, Kernel, lanes>, TreeOf<AnyVolume, Kernel, lanes>>(),
          meshes, objects, variant);
    };
    constexpr int lanes = kernel_lanes<Kernel>;
    if constexpr (lanes < most_kernel_lanes<Kernel>)
      if (variant.fan_out > lanes) return any.template operator()<most_kernel_lanes<Kernel>>();
    // Loops of a volume's own are compiled where it has a sibling test of its own.
    if constexpr (HasSiblingTest<V>)
      if (frame_of(variant) == Frame::body) {
        using Tree = TreeOf<V, Kernel>;
        made = pairs_over<V, Kernel, lanes, Query>(trees.template operator()<Tree, Tree>(), meshes,
                                                   objects, variant);
        return;
      }
    any.template operator()<lanes>();
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

/// The fan-out for which a kernel is fastest.
template <BoundingVolume V>
constexpr std::uint32_t fan_out_with(std::string_view kernel) {
  std::uint32_t fan_out = 0;
  if constexpr (WideVolume<V>)
    Kernels::with(
        kernel, [&]<class Kernel>(std::type_identity<Kernel>) { fan_out = kernel_lanes<Kernel>; });
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
