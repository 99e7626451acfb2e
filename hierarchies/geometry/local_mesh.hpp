// SPDX-License-Identifier: BSD-3-Clause
/// A mesh about an origin of its own, near its triangles, so that float volumes are as precise
/// where vertices are in survey coordinates as near 0. O(triangles); a copy only where the origin
/// is not 0, or where a vertex that no triangle uses lies outside.
///
/// Let L be the longest side of the box around the triangles, c its centre. The origin o is 0 where
/// no |c_i| exceeds 16 L. Else o_i is the multiple of G that is nearest to c_i, G the power of two
/// in (2 L, 4 L], so that
///
/// - no corner is farther from o than 2.5 L along an axis;
/// - o has few digits, and v - o is exact wherever v is on a grid that its distance from o can
///   hold; elsewhere it is rounded once, by at most u |v - o|;
/// - a mesh with |c_i| < G / 2 that is shifted by multiples of G, without rounding and farther than
///   16 L along an axis, becomes itself again: its trees are the same, bit for bit.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

class LocalMesh {
 public:
  /// `mesh` must outlive this, and have at least one triangle.
  explicit LocalMesh(const TriangleMesh& mesh) : mesh_(&mesh) {
    Vec3<double> low = mesh.corners(0)[0], high = low;
    for (const auto& triangle : mesh.triangles)
      for (const auto v : triangle)
        low = low.cwiseMin(mesh.vertices[v]), high = high.cwiseMax(mesh.vertices[v]);
    origin_ = origin_of(low, high);
    box_ = {low - origin_, high - origin_};
    const auto outside = [&](const Vec3<double>& v) {
      return (v.array() < low.array()).any() || (v.array() > high.array()).any();
    };
    if (!has_own_origin(origin_) && std::ranges::none_of(mesh.vertices, outside)) return;
    moved_ = mesh;
    for (auto& v : moved_->vertices) v = v.cwiseMax(low).cwiseMin(high) - origin_;
  }
  /// The mesh as it is, about 0.
  static LocalMesh as_given(const TriangleMesh& mesh) {
    LocalMesh local;
    local.mesh_ = &mesh;
    return local;
  }

  /// The triangles relative to origin(). Vertices that no triangle uses are within their box.
  const TriangleMesh& mesh() const { return moved_ ? *moved_ : *mesh_; }
  const Vec3<double>& origin() const { return origin_; }
  /// Around the triangles, relative to origin(); empty for a mesh as it is given.
  const Eigen::AlignedBox3d& box() const { return box_; }

  static bool has_own_origin(const Vec3<double>& origin) {
    return origin[0] != 0 || origin[1] != 0 || origin[2] != 0;
  }

 private:
  LocalMesh() = default;

  static Vec3<double> origin_of(const Vec3<double>& low, const Vec3<double>& high) {
    Vec3<double> centre = low / 2 + high / 2;
    const double longest = (high - low).maxCoeff();
    if (!(centre.cwiseAbs().maxCoeff() > 16 * longest)) return Vec3<double>::Zero();
    if (longest == 0) return centre;
    int exponent = 0;
    std::frexp(longest, &exponent);  // longest is in [2^(exponent - 1), 2^exponent)
    const double grid = std::ldexp(1.0, exponent + 1);
    // The remainder is exact, and so is the multiple of the grid that it leaves.
    const Vec3<double> origin =
        centre.unaryExpr([grid](double c) { return c - std::remainder(c, grid); });
    return origin.allFinite() ? origin : Vec3<double>::Zero();
  }

  const TriangleMesh* mesh_ = nullptr;
  Vec3<double> origin_ = Vec3<double>::Zero();
  Eigen::AlignedBox3d box_;
  std::optional<TriangleMesh> moved_;
};

}  // namespace bvlab
