// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/cgal_meshes.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <CGAL/convex_hull_3.h>

namespace bvlab {
namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;
using Surface = CGAL::Surface_mesh<Point>;
namespace simplification = CGAL::Surface_mesh_simplification;

struct FewEnough {
  std::size_t faces;
  template <class Cost, class Profile>
  bool operator()(const Cost&, const Profile& profile, std::size_t, std::size_t) const {
    return profile.surface_mesh().number_of_faces() <= faces;
  }
};

Surface surface_of(const TriangleMesh& mesh) {
  std::vector<Point> points;
  for (const auto& v : mesh.vertices) points.emplace_back(v[0], v[1], v[2]);
  std::vector<std::vector<std::size_t>> faces;
  for (const auto& [i, j, k] : mesh.triangles)
    if (i != j && j != k && k != i) faces.push_back({i, j, k});
  CGAL::Polygon_mesh_processing::orient_polygon_soup(points, faces);
  Surface surface;
  CGAL::Polygon_mesh_processing::polygon_soup_to_polygon_mesh(points, faces, surface);
  return surface;
}

TriangleMesh mesh_of(Surface& surface) {
  surface.collect_garbage();
  TriangleMesh mesh;
  std::vector<std::uint32_t> numbers(surface.number_of_vertices());
  std::uint32_t used = 0;
  for (const auto v : surface.vertices())
    if (!surface.is_isolated(v)) {
      numbers[v] = used++;
      const Point& p = surface.point(v);
      mesh.vertices.push_back({p.x(), p.y(), p.z()});
    }
  for (const auto f : surface.faces()) {
    const auto h = surface.halfedge(f);
    mesh.triangles.push_back({numbers[surface.source(h)], numbers[surface.target(h)],
                              numbers[surface.target(surface.next(h))]});
  }
  return mesh;
}

}  // namespace

TriangleMesh simplified(const TriangleMesh& mesh, std::size_t polygons) {
  if (mesh.triangles.size() <= polygons) return mesh;
  Surface surface = surface_of(mesh);
  simplification::edge_collapse(
      surface, FewEnough{polygons},
      CGAL::parameters::get_cost(simplification::LindstromTurk_cost<Surface>())
          .get_placement(simplification::LindstromTurk_placement<Surface>()));
  return mesh_of(surface);
}

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
