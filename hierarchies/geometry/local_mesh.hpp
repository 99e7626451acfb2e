// SPDX-License-Identifier: BSD-3-Clause
/// A mesh about an origin of its own, near its triangles, so that float volumes are as precise
/// where vertices are in survey coordinates as near 0. O(triangles); a copy only where the origin
/// is not 0, or where a vertex that no triangle uses lies outside and is to be moved inside.
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
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

class LocalMesh {
 public:
  /// What becomes of vertices that no triangle uses and that lie outside the triangles' box.
  enum class Unused : std::uint8_t { moved_inside, as_they_are };

  /// `mesh` must outlive this, and have at least one triangle.
  explicit LocalMesh(const TriangleMesh& mesh, Unused unused = Unused::moved_inside)
      : mesh_(&mesh) {
    Eigen::AlignedBox3d box = box_of_vertices(mesh);
    const bool all_inside = reaches_all_sides(mesh, box);
    if (!all_inside) box = box_of_triangles(mesh);
    const Vec3<double>&low = box.min(), &high = box.max();
    origin_ = origin_of(low, high);
    box_ = {low - origin_, high - origin_};
    const auto outside = [&](const Vec3<double>& v) {
      return (v.array() < low.array()).any() || (v.array() > high.array()).any();
    };
    if (!has_own_origin(origin_) && (all_inside || unused == Unused::as_they_are ||
                                     std::ranges::none_of(mesh.vertices, outside)))
      return;
    moved_ = mesh;
    for (auto& v : moved_->vertices) v = v.cwiseMax(low).cwiseMin(high) - origin_;
  }
  /// The mesh as it is, about 0.
  static LocalMesh as_given(const TriangleMesh& mesh) {
    LocalMesh local;
    local.mesh_ = &mesh;
    return local;
  }

  /// The triangles relative to origin(). Vertices that no triangle uses are within their box,
  /// unless they stay as they are.
  const TriangleMesh& mesh() const { return moved_ ? *moved_ : *mesh_; }
  const Vec3<double>& origin() const { return origin_; }
  /// Around the triangles, relative to origin(); empty for a mesh as it is given.
  const Eigen::AlignedBox3d& box() const { return box_; }

  static bool has_own_origin(const Vec3<double>& origin) {
    return origin[0] != 0 || origin[1] != 0 || origin[2] != 0;
  }

 private:
  LocalMesh() = default;

  static Eigen::AlignedBox3d box_of_vertices(const TriangleMesh& mesh) {
    // Several vertices at a time, number by number: loops that are compiled to registers.
    constexpr std::size_t several = 8;
    std::array<double, 3 * several> low, high;
    for (std::size_t k = 0; k < low.size(); ++k) low[k] = high[k] = mesh.vertices[0][k % 3];
    std::size_t i = 0;
    for (; i + several <= mesh.vertices.size(); i += several) {
      const double* const numbers = mesh.vertices[i].data();
      for (std::size_t k = 0; k < low.size(); ++k) {
        low[k] = numbers[k] < low[k] ? numbers[k] : low[k];
        high[k] = numbers[k] > high[k] ? numbers[k] : high[k];
      }
    }
    Eigen::AlignedBox3d box;
    for (std::size_t k = 0; k < low.size(); k += 3)
      box.extend(Vec3<double>(low[k], low[k + 1], low[k + 2]))
          .extend(Vec3<double>(high[k], high[k + 1], high[k + 2]));
    for (; i < mesh.vertices.size(); ++i) box.extend(mesh.vertices[i]);
    return box;
  }
  static Eigen::AlignedBox3d box_of_triangles(const TriangleMesh& mesh) {
    Eigen::AlignedBox3d box;
    for (const auto& triangle : mesh.triangles)
      for (const auto v : triangle) box.extend(mesh.vertices[v]);
    return box;
  }
  /// Whether triangles use, for each side of the vertices' box, the first vertex that lies there.
  /// No vertex is read for a triangle: that takes a sixth of the time of their box.
  static bool reaches_all_sides(const TriangleMesh& mesh, const Eigen::AlignedBox3d& box) {
    std::array<std::uint32_t, 6> on_side;
    for (int k = 0; k < 6; ++k) {
      const double side = k < 3 ? box.min()[k] : box.max()[k - 3];
      const auto at =
          std::ranges::find(mesh.vertices, side, [k](const Vec3<double>& v) { return v[k % 3]; });
      on_side[static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(at - mesh.vertices.begin());
    }
    std::array<std::uint32_t, 6> used{};
    for (const auto& triangle : mesh.triangles)
      for (const auto v : triangle)
        for (std::size_t k = 0; k < 6; ++k) used[k] |= v == on_side[k];
    return std::ranges::all_of(used, [](std::uint32_t each) { return each != 0; });
  }

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
