// SPDX-License-Identifier: BSD-3-Clause
/// What a scene has to know of a mesh to move it: where its middle is and how large it is.
#pragma once

#include <span>

#include "experiments/scenes/length.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

struct Extent {
  /// The point, in the mesh's frame, that is moved and turned about: the middle of the mesh's box.
  Vec3<double> centre = Vec3<double>::Zero();
  /// Distance from `centre` to the farthest vertex of a triangle.
  double radius = 0;
  /// Radius of the smallest of the smallest enclosing balls of single triangles that are not one
  /// point: of the smallest leaf of a sphere tree with one triangle a leaf. 0 if there is none.
  double leaf_radius = 0;
};

/// In time linear in the mesh. The mesh has at least one triangle.
Extent extent_of(const TriangleMesh& mesh);

/// A length in units of the mesh. Throws Unusable, naming the option, where it is in radii of
/// leaves and there are none.
double resolved(const Length& length, std::span<const Extent> meshes, const char* option);

}  // namespace bvlab
