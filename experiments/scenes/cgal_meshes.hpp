// SPDX-License-Identifier: BSD-3-Clause
/// Meshes that CGAL makes of others. Where the program was built without CGAL they throw Unusable.
#pragma once

#include <cstddef>

#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// A mesh with fewer triangles: edges collapse one after the other, the cheapest first, by the cost
/// and placement of Lindstrom and Turk [lindstrom1998fast]. Under a second for a hundred thousand
/// triangles.
///
/// The mesh with `polygons` triangles, or one or two fewer where an edge collapse leaps over that
/// number, or more where no further edge can collapse without changing the surface's topology.
/// Vertices have another order than before, unused ones are gone, and where more than two
/// triangles meet at an edge, or at a vertex more than one fan, the surface is cut apart there
/// first. A mesh that has no more triangles than wanted is returned as it is.
TriangleMesh simplified(const TriangleMesh& mesh, std::size_t polygons);

/// The convex hull of a mesh: closed, with outward triangles.
TriangleMesh convex_hull(const TriangleMesh& mesh);

}  // namespace bvlab
