// SPDX-License-Identifier: BSD-3-Clause
/// All that is compiled for a volume in wide trees under one query.
#pragma once

#include <algorithm>
#include <type_traits>
#include <vector>

#include "experiments/replay/hierarchies_of.hpp"
#include "experiments/replay/play.hpp"
#include "experiments/replay/wide_entry.hpp"
#include "traversal/wide/wide_pairs.hpp"

namespace bvlab {

namespace detail {

/// A wider node would be tested in several steps; none is narrower than two.
template <class T>
inline constexpr int native_fan_out = std::clamp(native_width<T>, 2, 16);

template <BoundingVolume V, class Query>
void play_wide(std::span<const TriangleMesh> meshes, const Trace& trace, const Variant& variant,
               const ReplayOptions& options, ReplayResult& result) {
  constexpr int fan_out = native_fan_out<typename V::scalar>;
  // Leaves are made while the tree is collapsed.
  Variant down_to_triangles = variant;
  down_to_triangles.leaf_size = 1;
  const auto start = Clock::now();
  std::vector<WideHierarchy<V, fan_out>> hierarchies;
  hierarchies.reserve(meshes.size());
  for (const auto& mesh : meshes)
    hierarchies.emplace_back(mesh, topology_of(mesh, down_to_triangles), fit_of(variant),
                             variant.leaf_size);
  result.build_seconds = seconds_since(start);
  std::vector<WideShape<V, fan_out>> shapes;
  for (std::size_t i = 0; i < trace.objects; ++i)
    shapes.push_back({&meshes[i % meshes.size()], &hierarchies[i % meshes.size()]});
  const auto with = [&]<class Memory>(std::type_identity<Memory>) {
    const auto engine = [&](auto) {
      return [&](std::vector<ObjectPair> pairs) {
        return WidePairs<V, fan_out, RelativeFrame, Memory>(shapes, std::move(pairs));
      };
    };
    play_over<Query>(engine, trace, variant, options, result);
  };
  if (variant.strategy == WideMargins::name)
    with(std::type_identity<WideMargins>());
  else
    with(std::type_identity<Forgetful>());
}

}  // namespace detail

template <BoundingVolume V, class Query>
constexpr WideEntry wide_of() {
  return {V::name, V::description, Query::name, detail::native_fan_out<typename V::scalar>,
          detail::play_wide<V, Query>};
}

}  // namespace bvlab
