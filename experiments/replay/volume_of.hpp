// SPDX-License-Identifier: BSD-3-Clause
/// All that is compiled for a volume whatever is asked of it: its hierarchies and its tightness.
#pragma once

#include <algorithm>

#include "experiments/replay/drawn_volume.hpp"
#include "experiments/replay/hierarchies_of.hpp"

namespace bvlab {

namespace detail {

template <BoundingVolume V>
std::vector<double> gaps_of(const TriangleMesh& mesh, const Topology& topology, Fit fit,
                            std::span<const GapQuestion> questions) {
  const Hierarchy<V> hierarchy(mesh, topology, fit);
  std::vector<double> gaps;
  for (const auto& [node, at] : questions) {
    // Both stand where they are, with the margins that a pose brings along.
    const Vec3<double> local = at - hierarchy.extent().origin;
    const double reach = std::max(hierarchy.extent().reach, 2 * local.norm());
    const bvlab::PlacementOf<V> here(Pose{}, Vec3<double>::Zero(), reach);
    const Vec3<double> point[] = {local};
    gaps.push_back(gap(posed(hierarchy.volume(node), here),
                       posed(V::enclosing(std::span<const Vec3<double>>(point)), here)));
  }
  return gaps;
}

template <BoundingVolume V>
std::vector<float> drawn_of(const AnyHierarchies& hierarchies, std::size_t mesh,
                            std::span<const std::uint32_t> nodes) {
  const auto& hierarchy = static_cast<const HierarchiesOf<V>&>(hierarchies)[mesh];
  std::vector<float> all;
  for (const auto node : nodes) {
    const auto numbers = drawn_numbers(hierarchy.volume(node));
    all.insert(all.end(), numbers.begin(), numbers.end());
  }
  return all;
}

}  // namespace detail

template <BoundingVolume V>
constexpr VolumeEntry volume_of() {
  return {
      V::name,
      V::description,
      FittedTightly<V>,
      PlacedRelatively<V>,
      [](std::span<const TriangleMesh> meshes, const Variant& variant) {
        return std::unique_ptr<AnyHierarchies>(std::make_unique<HierarchiesOf<V>>(meshes, variant));
      },
      detail::gaps_of<V>,
      drawn_as<V>(),
      detail::drawn_of<V>};
}

}  // namespace bvlab
