// SPDX-License-Identifier: BSD-3-Clause
/// The extent of a hierarchy, whatever its volumes: all that bounds on a body's motion require.
#pragma once

#include <cmath>
#include <cstddef>

#include "hierarchies/geometry/scalar.hpp"

namespace bvlab {

/// Lengths are in units of the mesh, positions in its frame.
struct HierarchyExtent {
  Vec3<double> centre = Vec3<double>::Zero();  ///< of the mesh's bounding box
  double radius = 0;                           ///< no corner is farther than this from the centre
  double reach = 0;        ///< no vertex or volume is farther from the origin of the frame
  std::size_t nodes = 0;   ///< of the tree
  std::size_t leaves = 0;  ///< those that have no children
  /// Of the mesh (LocalMesh), in its frame: centre, reach and all volumes are relative to it.
  Vec3<double> origin = Vec3<double>::Zero();

  /// The size of a leaf, for leaves about as wide as long.
  double leaf_size() const { return 2 * radius / std::sqrt(static_cast<double>(leaves)); }
};

}  // namespace bvlab
