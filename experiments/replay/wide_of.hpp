// SPDX-License-Identifier: BSD-3-Clause
/// All that is compiled for a volume in wide trees under one query.
#pragma once

#include <memory>
#include <type_traits>
#include <vector>

#include "experiments/replay/hierarchies_of.hpp"
#include "experiments/replay/play.hpp"
#include "experiments/replay/touching_world.hpp"
#include "experiments/replay/wide_entry.hpp"
#include "traversal/wide/mixed_kernel.hpp"
#include "traversal/wide/wide_pairs.hpp"

namespace bvlab {

namespace detail {

/// How many children per node has.
template <class Kernel, class T>
inline constexpr int fan_out_of = native_fan_out<T>;
template <class T>
inline constexpr int fan_out_of<MixedKernel, T> = 4;

template <class Hierarchy>
std::vector<Hierarchy> wide_hierarchies(std::span<const TriangleMesh> meshes,
                                        const Variant& variant, int threads) {
  Threads several(threads);
  // Leaves are made while the tree is collapsed.
  Variant down_to_triangles = variant;
  down_to_triangles.leaf_size = 1;
  std::vector<Hierarchy> hierarchies;
  hierarchies.reserve(meshes.size());
  for (const auto& mesh : meshes)
    hierarchies.emplace_back(mesh, topology_of(mesh, down_to_triangles), fit_of(variant),
                             variant.leaf_size, several);
  return hierarchies;
}

template <class V>
using KernelsOf = std::conditional_t<MixedKernel::takes<V>, TypeList<SiblingsKernel, MixedKernel>,
                                     TypeList<SiblingsKernel>>;

/// Calls `with` with the variant's kernel and its hierarchies.
template <BoundingVolume V, class With>
void with_kernel(const Variant& variant, const With& with) {
  KernelsOf<V>::with(variant.kernel,
                     [&]<class Kernel>(std::type_identity<Kernel> kernel) { with(kernel); });
}

/// Calls `with` with the type that is what the variant's strategy remembers.
template <class With>
auto with_memory(const Variant& variant, const With& with) {
  if (variant.strategy == WideMargins::name) return with(std::type_identity<WideMargins>());
  return with(std::type_identity<NoMemory>());
}

template <BoundingVolume V, class Query>
void play_wide(std::span<const TriangleMesh> meshes, const Trace& trace, const Variant& variant,
               const ReplayOptions& options, ReplayResult& result) {
  with_kernel<V>(variant, [&]<class Kernel>(std::type_identity<Kernel>) {
    constexpr int fan_out = fan_out_of<Kernel, typename V::scalar>;
    const auto start = Clock::now();
    const auto hierarchies = wide_hierarchies<typename Kernel::template Hierarchy<V, fan_out>>(
        meshes, variant, static_cast<int>(options.threads));
    result.build_seconds = seconds_since(start);
    const auto shapes = shapes_over(meshes, hierarchies, trace.objects);
    with_memory(variant, [&]<class Memory>(std::type_identity<Memory>) {
      const auto pairs = [&](auto) { return WidePairs<V, fan_out, Memory, Kernel>(shapes); };
      play_over<Query>(pairs, trace, variant, options, result);
    });
  });
}

/// Null where the query is no matter of yes or no.
template <BoundingVolume V, class Query>
std::unique_ptr<WorldEngine> wide_world(std::span<const TriangleMesh> meshes, std::size_t objects,
                                        const Variant& variant, int threads) {
  std::unique_ptr<WorldEngine> world;
  if constexpr (AnswersYesOrNo<Query>)
    with_kernel<V>(variant, [&]<class Kernel>(std::type_identity<Kernel>) {
      constexpr int fan_out = fan_out_of<Kernel, typename V::scalar>;
      auto hierarchies = wide_hierarchies<typename Kernel::template Hierarchy<V, fan_out>>(
          meshes, variant, threads);
      // Shapes point to what the vector holds, wherever that is moved.
      const auto shapes = shapes_over(meshes, hierarchies, objects);
      with_memory(variant, [&]<class Memory>(std::type_identity<Memory>) {
        using Pairs = WidePairs<V, fan_out, Memory, Kernel>;
        world = std::make_unique<TouchingWorld<Pairs, Query, decltype(hierarchies)>>(
            std::move(hierarchies), Pairs(shapes), variant, threads);
      });
    });
  return world;
}

template <BoundingVolume V>
constexpr std::uint32_t fan_out_with(std::string_view kernel) {
  std::uint32_t fan_out = 0;
  KernelsOf<V>::with(kernel, [&]<class Kernel>(std::type_identity<Kernel>) {
    fan_out = fan_out_of<Kernel, typename V::scalar>;
  });
  return fan_out;
}

}  // namespace detail

template <BoundingVolume V, class Query>
constexpr WideEntry wide_of() {
  WideEntry entry{V::name, V::description, Query::name, detail::fan_out_with<V>, nullptr, nullptr};
  if constexpr (for_wide_trees<Query>())
    entry.play = detail::play_wide<V, Query>, entry.world = detail::wide_world<V, Query>;
  return entry;
}

}  // namespace bvlab
