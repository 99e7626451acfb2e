// SPDX-License-Identifier: BSD-3-Clause
#include <BulletCollision/Gimpact/btTriangleShapeEx.h>

#include "experiments/peers/triangle_tests.hpp"

namespace bvlab {
namespace {

/// As btGImpactCollisionAlgorithm::collide_sat_triangles does for each pair of leaves, without a
/// margin.
void decide_bullet(TriangleTestPeer::Pairs pairs, std::uint8_t* verdicts) {
  const auto made = [](const Triangle& t) {
    btPrimitiveTriangle triangle;
    for (int i = 0; i < 3; ++i)
      triangle.m_vertices[i] =
          btVector3(static_cast<btScalar>(t[i][0]), static_cast<btScalar>(t[i][1]),
                    static_cast<btScalar>(t[i][2]));
    triangle.m_margin = 0;
    triangle.buildTriPlane();
    return triangle;
  };
  for (const auto& [a, b] : pairs) {
    btPrimitiveTriangle one = made(a), other = made(b);
    GIM_TRIANGLE_CONTACT contact;
    *verdicts++ = one.overlap_test_conservative(other) &&
                  one.find_triangle_collision_clip_method(other, contact);
  }
}

}  // namespace

std::span<const TriangleTestPeer> bullet_triangles() {
  static constexpr TriangleTestPeer list[] = {
      {"bullet", "GImpact's clipping in float32", decide_bullet},
  };
  return list;
}

}  // namespace bvlab
