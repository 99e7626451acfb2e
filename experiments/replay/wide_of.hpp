// SPDX-License-Identifier: BSD-3-Clause
/// All that is compiled for a volume in wide trees under one query.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <type_traits>

#include "experiments/replay/made_pairs.hpp"
#include "experiments/replay/wide_entry.hpp"
#include "experiments/replay/wide_pairs_over.hpp"

namespace bvlab {

namespace detail {

template <BoundingVolume V, class Query>
std::unique_ptr<PairsUnderSome> wide_pairs(PairsFrom& from, const Variant& variant) {
  std::unique_ptr<PairsUnderSome> made;
  const auto trees = [&]<class Hierarchy, class Tree>() {
    using Trees = WideTreesOf<Hierarchy, Tree>;
    return from.trees<Trees>(
        variant, [&] { return std::make_shared<Trees>(from.meshes, variant, from.threads); });
  };
  Kernels::with(variant.kernel, [&]<class Kernel>(std::type_identity<Kernel>) {
    const auto any = [&]<int lanes>() {
      made = pairs_over_any<Query>(
          trees.template operator()<TreeOf<V, Kernel, lanes>, TreeOf<AnyVolume, Kernel, lanes>>(),
          from.meshes, from.objects, variant);
    };
    constexpr int lanes = kernel_lanes<Kernel>;
    if constexpr (lanes < most_kernel_lanes<Kernel>)
      if (variant.fan_out > lanes) return any.template operator()<most_kernel_lanes<Kernel>>();
    // Loops of a volume's own are compiled where it has a sibling test of its own.
    if constexpr (HasSiblingTest<V>)
      if (frame_of(variant) == Frame::body) {
        using Tree = TreeOf<V, Kernel>;
        made = pairs_over<V, Kernel, lanes, Query>(trees.template operator()<Tree, Tree>(),
                                                   from.meshes, from.objects, variant);
        return;
      }
    any.template operator()<lanes>();
  });
  return made;
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
  WideEntry entry{V::name, V::description, Query::name, detail::fan_out_with<V>, nullptr};
  if constexpr (detail::WideVolume<V> && for_wide_trees<Query>())
    entry.pairs = detail::wide_pairs<V, Query>;
  return entry;
}

}  // namespace bvlab
