// SPDX-License-Identifier: BSD-3-Clause
/// The box, along the world's axes, of a mesh that is turned and moved: the axes' part of a posed
/// 26-DOP, which holds every vertex, rounding included (zachmann1998rapid; see Realignment).
///
/// It costs the same for every mesh, and is smaller than the box of a turned box, which is all that
/// the six support values along the mesh's own axes know.
#pragma once

#include <algorithm>
#include <limits>

#include "broadphase/box.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"
#include "hierarchies/volumes/kdop.hpp"

namespace bvlab {

class TurnedBox {
 public:
  /// The mesh must have a triangle; vertices that no triangle uses count as well.
  explicit TurnedBox(const TriangleMesh& mesh) : hull_(Kdop26<float>::enclosing(mesh.vertices)) {
    reach_ = static_cast<double>(reach_of(hull_));
    for (const auto& v : mesh.vertices) reach_ = std::max(reach_, v.stableNorm());
    reach_ *= 1 + 8 * unit_roundoff<float>;
  }

  /// Relative to `origin`. What is too large for a float ends at the largest one.
  Box<float> operator()(const Pose& pose, const Vec3<double>& origin) const {
    const Kdop26<float> posed_hull = posed(hull_, Realignment<float, 26>(pose, origin, reach_));
    constexpr float most = std::numeric_limits<float>::max();
    Box<float> box;
    for (int axis = 0; axis < 3; ++axis) {
      const float hi = posed_hull.bounds[2 * axis], lo = -posed_hull.bounds[2 * axis + 1];
      // Written so that what is not a number counts as everywhere.
      const bool sound = lo >= -most && hi <= most && lo <= hi;
      box.lo[axis] = sound ? lo : -most;
      box.hi[axis] = sound ? hi : most;
    }
    return box;
  }

 private:
  Kdop26<float> hull_;
  double reach_ = 0;
};

}  // namespace bvlab
