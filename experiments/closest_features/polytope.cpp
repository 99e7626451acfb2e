// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/closest_features/polytope.hpp"

#include <Eigen/Geometry>
#include <map>

#include "experiments/files/unusable.hpp"

namespace bvlab::closest_features {

Polytope::Polytope(const TriangleMesh& mesh) {
  // Vertices that no triangle has are left out.
  std::vector<std::uint32_t> renamed(mesh.vertices.size(), static_cast<std::uint32_t>(-1));
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edge_of;
  for (const auto& triangle : mesh.triangles) {
    Face face;
    for (std::size_t k = 0; k < 3; ++k) {
      auto& name = renamed[triangle[k]];
      if (name == static_cast<std::uint32_t>(-1)) {
        name = static_cast<std::uint32_t>(vertices_.size());
        vertices_.push_back(mesh.vertices[triangle[k]]);
      }
      face.vertices[k] = name;
    }
    const auto& [i, j, k] = face.vertices;
    face.normal = (vertices_[j] - vertices_[i]).cross(vertices_[k] - vertices_[i]).normalized();
    const auto number = static_cast<std::uint32_t>(faces_.size());
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t from = face.vertices[c], to = face.vertices[(c + 1) % 3];
      const auto [place, fresh] =
          edge_of.try_emplace(std::minmax(from, to), static_cast<std::uint32_t>(edges_.size()));
      face.edges[c] = place->second;
      if (fresh) {
        const Vec3<double> along = (vertices_[to] - vertices_[from]).normalized();
        edges_.push_back({from, to, number, number, along, face.normal.cross(along), along});
        continue;
      }
      Edge& edge = edges_[place->second];
      if (edge.head != from || edge.right != edge.left)
        throw Unusable("not a closed surface, oriented outward: closest features need one");
      edge.right = number;
      edge.into_right = -face.normal.cross(edge.along);
    }
    faces_.push_back(face);
  }
  first_.assign(vertices_.size() + 1, 0);
  for (const Edge& e : edges_) {
    if (e.left == e.right) throw Unusable("not closed: closest features need a closed surface");
    ++first_[e.tail + 1], ++first_[e.head + 1];
  }
  for (std::size_t v = 0; v < vertices_.size(); ++v) first_[v + 1] += first_[v];
  edges_at_.resize(2 * edges_.size());
  auto next = first_;
  for (std::uint32_t e = 0; e < edges_.size(); ++e)
    edges_at_[next[edges_[e].tail]++] = e, edges_at_[next[edges_[e].head]++] = e;
  check_convex();
}

void Polytope::check_convex() const {
  double size = 0;
  for (const auto& v : vertices_) size = std::max(size, (v - vertices_[0]).norm());
  for (const Face& face : faces_)
    for (const auto& v : vertices_)
      if (!(above(face, v) <= 1e-9 * size))
        throw Unusable("not convex: closest features need convex meshes, such as NAME-hull");
}

}  // namespace bvlab::closest_features
