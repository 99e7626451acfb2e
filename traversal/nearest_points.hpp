// SPDX-License-Identifier: BSD-3-Clause
/// The nearest points of two surfaces whose nearest triangles a Distance query has found. They are
/// computed from the triangles when they are asked for: the query keeps only which these are.
///
/// Points are computed in double-double and rounded. So each lies on its triangle, and the two are
/// as far apart as the query says, up to the rounding of their coordinates and the error bound of
/// triangle_distance.hpp: with M the largest coordinate of the two triangles in the world, a point
/// is off its triangle by at most 2^-51 M, and the distance of the points differs from the query's
/// by at most 2^-50 M + 1e-14 of it. Surfaces that touch have one common point.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "hierarchies/geometry/pose.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"
#include "traversal/primitives/triangle_distance.hpp"
#include "traversal/queries/candidate.hpp"

namespace bvlab {

/// One of the nearest pairs of points of body a and body b.
struct NearestPair {
  std::array<std::uint32_t, 2> triangles;  ///< of a and of b: indices in their meshes
  std::array<Vec3<double>, 2> points;      ///< on a and on b, in the world
};

/// `nearest` is what the query found with the bodies at these poses. Where nothing was found, as
/// where the distance exceeds the largest number, triangles are NearestTriangles::none and points
/// are NaN.
inline NearestPair nearest_points(const NearestTriangles& nearest, const TriangleMesh& mesh_a,
                                  const Pose& a_in_world, const TriangleMesh& mesh_b,
                                  const Pose& b_in_world) {
  NearestPair pair{{nearest.a, nearest.b}, {}};
  if (nearest.a == NearestTriangles::none) {
    pair.points.fill(Vec3<double>::Constant(std::numeric_limits<double>::quiet_NaN()));
    return pair;
  }
  const TriangleDistance found = distance<DoubleDouble>(a_in_world(mesh_a.corners(nearest.a)),
                                                        b_in_world(mesh_b.corners(nearest.b)));
  pair.points = {found.on_a, found.on_b};
  return pair;
}

}  // namespace bvlab
