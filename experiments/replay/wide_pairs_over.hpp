// SPDX-License-Identifier: BSD-3-Clause
/// The loops of wide trees: compiled for each volume with a sibling test of its own, in a body's
/// frame, and once for all else (wide_any.cpp.in).
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <utility>

#include "experiments/replay/strategy_text.hpp"
#include "experiments/replay/wide_trees.hpp"
#include "traversal/strategies/by_cost.hpp"
#include "traversal/wide/kernels.hpp"
#include "traversal/wide/list_memory.hpp"
#include "traversal/wide/wide_pairs.hpp"

namespace bvlab::detail {

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

/// Pairs over these trees; bodies are of the meshes in turn.
template <class V, class Kernel, int lanes, class Query>
std::unique_ptr<AnyPairs<Query>> pairs_over(
    const std::shared_ptr<WideTrees<TreeOf<V, Kernel, lanes>>>& trees,
    std::span<const TriangleMesh> meshes, std::size_t objects, const Variant& variant) {
  std::unique_ptr<AnyPairs<Query>> made;
  const auto shapes = trees->shapes(meshes, objects);
  with_memory(variant, [&]<class Memory>(const Memory& memory) {
    using Pairs = WidePairs<V, lanes, Memory, Kernel>;
    made = std::make_unique<PairsOver<Pairs, Query, WideTrees<TreeOf<V, Kernel, lanes>>>>(
        trees, Pairs(shapes, memory, frame_of(variant)));
  });
  return made;
}

/// The same over trees of any kernel, by loops that do not know their volume. Null where the query
/// is none for wide trees.
template <class Query>
std::unique_ptr<AnyPairs<Query>> pairs_over_trees(const std::shared_ptr<AnyTrees>& trees,
                                                  std::span<const TriangleMesh> meshes,
                                                  std::size_t objects, const Variant& variant) {
  std::unique_ptr<AnyPairs<Query>> made;
  const auto with = [&]<class Kernel, int lanes>() {
    using Trees = WideTrees<TreeOf<AnyVolume, Kernel, lanes>>;
    if (const auto of = std::dynamic_pointer_cast<Trees>(trees))
      made = pairs_over<AnyVolume, Kernel, lanes, Query>(of, meshes, objects, variant);
  };
  if constexpr (for_wide_trees<Query>())
    Kernels::for_each([&]<class Kernel>(std::type_identity<Kernel>) {
      with.template operator()<Kernel, kernel_lanes<Kernel>>();
      if constexpr (kernel_lanes<Kernel> < most_kernel_lanes<Kernel>)
        with.template operator()<Kernel, most_kernel_lanes<Kernel>>();
    });
  return made;
}

}  // namespace bvlab::detail
