// SPDX-License-Identifier: BSD-3-Clause
/// Replaces what CGAL does where it is absent.
#include "experiments/files/unusable.hpp"
#include "experiments/scenes/cgal_meshes.hpp"

namespace bvlab {

TriangleMesh convex_hull(const TriangleMesh&) {
  throw Unusable("the hull of a mesh: bvlab was built without CGAL");
}

TriangleMesh simplified(const TriangleMesh& mesh, std::size_t polygons) {
  if (mesh.triangles.size() <= polygons) return mesh;
  throw Unusable("a mesh with fewer polygons: bvlab was built without CGAL");
}

}  // namespace bvlab
