// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/convex_hull.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <vector>

namespace bvlab {

TriangleMesh convex_hull(const TriangleMesh& mesh) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  std::vector<Kernel::Point_3> points;
  for (const auto& [i, j, k] : mesh.triangles)
    for (const auto v : {i, j, k})
      points.emplace_back(mesh.vertices[v][0], mesh.vertices[v][1], mesh.vertices[v][2]);
  CGAL::Surface_mesh<Kernel::Point_3> hull;
  CGAL::convex_hull_3(points.begin(), points.end(), hull);
  TriangleMesh result;
  for (const auto v : hull.vertices()) {
    const auto& p = hull.point(v);
    result.vertices.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : hull.faces()) {
    auto& triangle = result.triangles.emplace_back();
    std::size_t corner = 0;
    for (const auto v : hull.vertices_around_face(hull.halfedge(f)))
      triangle[corner++] = static_cast<std::uint32_t>(v.idx());
  }
  return result;
}

}  // namespace bvlab
