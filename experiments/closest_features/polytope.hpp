// SPDX-License-Identifier: BSD-3-Clause
/// A convex polytope with the neighbourhoods that closest-feature methods walk along: a closed
/// convex triangle mesh whose coplanar triangles stay apart.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hierarchies/geometry/pose.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab::closest_features {

class Polytope {
 public:
  /// From tail to head; `left` is the face that runs along it in this direction.
  struct Edge {
    std::uint32_t tail, head, left, right;
    Vec3<double> along;                  ///< unit vector from tail to head
    Vec3<double> into_left, into_right;  ///< unit vectors in the faces, at right angles to the edge
  };
  struct Face {
    std::array<std::uint32_t, 3> vertices;
    std::array<std::uint32_t, 3> edges;  ///< edge k runs from vertex k to the next, or back
    Vec3<double> normal;                 ///< unit vector, outward

    /// Towards the face's inside from its edge k.
    const Vec3<double>& inward(const Polytope& p, std::size_t k) const {
      const Edge& e = p.edges()[edges[k]];
      return e.tail == vertices[k] ? e.into_left : e.into_right;
    }
  };

  /// Throws Unusable where the mesh is not closed, not oriented outward or not convex (by more than
  /// 1e-9 of its size, which rounding makes of a hull).
  explicit Polytope(const TriangleMesh& mesh);

  const std::vector<Vec3<double>>& vertices() const { return vertices_; }
  const std::vector<Edge>& edges() const { return edges_; }
  const std::vector<Face>& faces() const { return faces_; }
  std::span<const std::uint32_t> edges_at(std::uint32_t vertex) const {
    return {edges_at_.data() + first_[vertex], edges_at_.data() + first_[vertex + 1]};
  }
  std::uint32_t other_end(std::uint32_t edge, std::uint32_t vertex) const {
    return edges_[edge].tail ^ edges_[edge].head ^ vertex;
  }

  /// Signed distance from the face's plane.
  double above(const Face& face, const Vec3<double>& x) const {
    return face.normal.dot(x - vertices_[face.vertices[0]]);
  }

 private:
  void check_convex() const;

  std::vector<Vec3<double>> vertices_;
  std::vector<Edge> edges_;
  std::vector<Face> faces_;
  std::vector<std::uint32_t> first_, edges_at_;
};

/// Two polytopes in their poses: the second one's points in the first one's frame, and back.
struct PosedPair {
  const Polytope *a, *b;
  Pose pose_a, pose_b;
  Mat3<double> rotation;     ///< b to a
  Vec3<double> translation;  ///< b to a

  PosedPair(const Polytope& a, const Pose& pose_a, const Polytope& b, const Pose& pose_b)
      : a(&a),
        b(&b),
        pose_a(pose_a),
        pose_b(pose_b),
        rotation(pose_a.rotation.transpose() * pose_b.rotation),
        translation(pose_a.rotation.transpose() * (pose_b.translation - pose_a.translation)) {}

  Vec3<double> b_in_a(const Vec3<double>& x) const { return rotation * x + translation; }
  Vec3<double> a_in_b(const Vec3<double>& x) const {
    return rotation.transpose() * (x - translation);
  }
  const Polytope& polytope(int side) const { return side == 0 ? *a : *b; }
  /// A vertex of `side` in the frame of the other.
  Vec3<double> across(int side, std::uint32_t vertex) const {
    return side == 0 ? a_in_b(a->vertices()[vertex]) : b_in_a(b->vertices()[vertex]);
  }
  Vec3<double> in_world(int side, std::uint32_t vertex) const {
    return side == 0 ? pose_a(a->vertices()[vertex]) : pose_b(b->vertices()[vertex]);
  }
};

}  // namespace bvlab::closest_features
