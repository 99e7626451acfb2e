// SPDX-License-Identifier: BSD-3-Clause
/// What the nearest triangles and points of a distance must be, whoever found them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "traversal/nearest_points.hpp"

namespace bvlab {

inline double largest_coordinate(const Triangle& a, const Triangle& b) {
  double largest = 0;
  for (const Triangle* t : {&a, &b})
    for (const auto& p : *t) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  return largest;
}

/// The points lie on their triangles and are as far apart as the bodies are, up to the rounding of
/// coordinates; the triangles are exactly that far apart.
inline void expect_nearest(const NearestPair& pair, double answer, const TriangleMesh& mesh_a,
                           const Pose& a_in_world, const TriangleMesh& mesh_b,
                           const Pose& b_in_world, const std::string& where) {
  ASSERT_LT(pair.triangles[0], mesh_a.triangles.size()) << where;
  ASSERT_LT(pair.triangles[1], mesh_b.triangles.size()) << where;
  const Triangle a = a_in_world(mesh_a.corners(pair.triangles[0])),
                 b = b_in_world(mesh_b.corners(pair.triangles[1]));
  ASSERT_EQ(distance(a, b).distance, answer) << where;
  const double rounding = 0x1p-51 * largest_coordinate(a, b);
  const auto& [on_a, on_b] = pair.points;
  ASSERT_LE(distance(a, {on_a, on_a, on_a}).distance, rounding) << where;
  ASSERT_LE(distance(b, {on_b, on_b, on_b}).distance, rounding) << where;
  ASSERT_NEAR((on_a - on_b).norm(), answer, 2 * rounding + 1e-14 * answer) << where;
  if (answer == 0) {
    ASSERT_EQ(on_a, on_b) << where;
  }
}

}  // namespace bvlab
