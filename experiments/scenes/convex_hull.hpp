// SPDX-License-Identifier: BSD-3-Clause
/// The convex hull of a mesh, by CGAL.
#pragma once

#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// Closed, with outward triangles. Throws Unusable where the program was built without CGAL.
TriangleMesh convex_hull(const TriangleMesh& mesh);

}  // namespace bvlab
