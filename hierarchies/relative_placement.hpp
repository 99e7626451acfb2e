// SPDX-License-Identifier: BSD-3-Clause
/// Poses the volumes of one body into the world, or into the frame of another, whose volumes are
/// tested as stored. A relative placement is made once for each pair of bodies, instead of once for
/// each body.
#pragma once

#include <concepts>
#include <type_traits>

#include "hierarchies/bounding_volume.hpp"
#include "hierarchies/geometry/local_pose.hpp"
#include "hierarchies/geometry/relative_pose.hpp"
#include "hierarchies/hierarchy_extent.hpp"

namespace bvlab {

/// Volumes whose placement accounts for the error of a relative pose: those of `Placement`, and
/// those with a placement of their own that is constructed from (pose, origin, reach, error bound).
template <class V>
concept PlacedRelatively =
    std::same_as<PlacementOf<V>, Placement<Element<typename V::scalar>>> ||
    std::constructible_from<PlacementOf<V>, Pose, Vec3<double>, double, double>;

/// The placement for a pose of which positions may be off by `error_bound`.
template <PlacedRelatively V>
PlacementOf<V> placement_with_error(const Pose& pose, double reach, double error_bound) {
  using T = Element<typename V::scalar>;
  using Made = PlacementOf<V>;
  if constexpr (!std::same_as<Made, Placement<T>>) {
    return Made(pose, Vec3<double>::Zero(), reach, error_bound);
  } else {
    Made made(pose, Vec3<double>::Zero(), reach);
    made.slack = rounded_up<T>((made.slack + error_bound) * (1 + 4 * unit_roundoff<T>));
    return made;
  }
}

/// The placement for a relative pose. `reach`, in units of the mesh, bounds the distance of all
/// vertices and volumes of the posed body from its mesh's origin.
template <PlacedRelatively V>
PlacementOf<V> relative_placement(const RelativePose& pose, double reach) {
  using T = Element<typename V::scalar>;
  using Made = PlacementOf<V>;
  const Pose seen{pose.rotation(), pose.shift()};
  if constexpr (std::same_as<Made, Placement<T>> && std::same_as<T, float>) {
    return Made(typename Made::Orthonormal{}, seen.rotation, seen.translation, reach,
                pose.error_bound);
  } else {
    return placement_with_error<V>(seen, reach, pose.error_bound);
  }
}

/// The placement in the world, about an origin there, of volumes about the mesh's own.
template <class V>
PlacementOf<V> world_placement(const Pose& pose, const Vec3<double>& origin,
                               const HierarchyExtent& extent) {
  if constexpr (PlacedRelatively<V>)
    if (LocalMesh::has_own_origin(extent.origin)) [[unlikely]] {
      const LocalPose local(pose, extent.origin, extent.reach, origin);
      return placement_with_error<V>(local.pose, extent.reach, local.error);
    }
  return PlacementOf<V>(pose, origin, extent.reach);
}

/// A stored volume in its own mesh's frame, in the form that tests take.
template <class V, class Volumes>
[[gnu::always_inline]] inline decltype(auto) as_stored(const Volumes& volumes) {
  if constexpr (std::is_same_v<Posed<V>, V>)
    return (volumes);
  else
    return posed(volumes, PlacementOf<V>());
}

}  // namespace bvlab
