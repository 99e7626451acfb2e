// SPDX-License-Identifier: BSD-3-Clause
/// CGAL's Rigid_triangle_mesh_collision_detection: AABB trees over exact predicates.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Rigid_triangle_mesh_collision_detection.h>
#include <CGAL/Surface_mesh.h>

#include "experiments/files/unusable.hpp"
#include "experiments/peers/play_peer.hpp"

namespace bvlab {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// Only for meshes that are manifold, with their faces oriented alike: others cannot be put into a
/// Surface_mesh. Its transformations are applied to filtered numbers, not rounded to float64 as
/// ours are, so answers may differ where surfaces just touch.
class CgalWorld {
 public:
  CgalWorld(std::span<const TriangleMesh> meshes, std::size_t objects) {
    std::vector<SurfaceMesh> surfaces;
    for (const auto& mesh : meshes) {
      SurfaceMesh surface;
      for (const auto& v : mesh.vertices) surface.add_vertex({v[0], v[1], v[2]});
      for (const auto& [a, b, c] : mesh.triangles)
        if (surface.add_face(SurfaceMesh::Vertex_index(a), SurfaceMesh::Vertex_index(b),
                             SurfaceMesh::Vertex_index(c)) == SurfaceMesh::null_face())
          throw Unusable("cgal: a mesh is not manifold");
      surfaces.push_back(std::move(surface));
    }
    surfaces_ = std::move(surfaces);
    for (std::size_t i = 0; i < objects; ++i) world_.add_mesh(surfaces_[i % surfaces_.size()]);
  }

  void place(std::size_t i, const Pose& pose) {
    const auto& r = pose.rotation;
    const auto& t = pose.translation;
    world_.set_transformation(
        i, CGAL::Aff_transformation_3<Kernel>(r(0, 0), r(0, 1), r(0, 2), t[0], r(1, 0), r(1, 1),
                                              r(1, 2), t[1], r(2, 0), r(2, 1), r(2, 2), t[2]));
  }

  bool touching(std::size_t i, std::size_t j) {
    const std::size_t others[] = {j};
    return !world_.get_all_intersections(i, others).empty();
  }

 private:
  std::vector<SurfaceMesh> surfaces_;
  CGAL::Rigid_triangle_mesh_collision_detection<SurfaceMesh> world_;
};

}  // namespace

std::span<const Peer> cgal_peers() {
  static constexpr Peer list[] = {
      {"cgal", "CGAL 5.5: Rigid_triangle_mesh_collision_detection", "touching",
       play_peer<CgalWorld>},
  };
  return list;
}

}  // namespace bvlab
