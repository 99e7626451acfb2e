// SPDX-License-Identifier: BSD-3-Clause
/// The root of a hierarchy bounded by the mesh's convex hull (klosowski1998efficient, "hill
/// climbing"): along each direction a vertex climbs from where it was the frame before to the
/// farthest one. The bounds are the best there are, the K-DOP's own looseness left out, too. For
/// measuring; its cost is that of as many vertices as neighbours are looked at.
#pragma once

#include <array>
#include <cstdint>

#include "experiments/closest_features/polytope.hpp"
#include "hierarchies/volumes/kdop.hpp"

namespace bvlab::closest_features {

template <int K>
class ClimbingRoot {
 public:
  explicit ClimbingRoot(const Polytope& hull) : hull_(&hull) {}

  /// reach: the largest distance of a vertex from the mesh's own origin.
  Kdop<float, K> bounds(const Pose& pose, const Vec3<double>& origin, double reach) {
    using Directions = bvlab::detail::KdopDirections<K>;
    const KdopOffsets<float, K> offsets(pose, origin, reach);
    Kdop<float, K> result;
    for (int k = 0; k < K / 2; ++k) {
      const auto* d = Directions::direction(k);
      const Vec3<double> n = pose.rotation.transpose() * Vec3<double>(d[0], d[1], d[2]);
      result.bounds[2 * k] = rounded_up<float>(climbed(at_[2 * k], n)) + offsets.along[k];
      result.bounds[2 * k + 1] =
          rounded_up<float>(climbed(at_[2 * k + 1], -n)) + offsets.opposite[k];
    }
    return result;
  }

 private:
  /// On a convex polytope no vertex but the farthest is farther than all its neighbours.
  double climbed(std::uint32_t& at, const Vec3<double>& n) const {
    const auto& vertices = hull_->vertices();
    double most = n.dot(vertices[at]);
    for (bool higher = true; higher;) {
      higher = false;
      const std::uint32_t from = at;
      for (const auto edge : hull_->edges_at(from)) {
        const std::uint32_t other = hull_->other_end(edge, from);
        const double along = n.dot(vertices[other]);
        if (along > most) most = along, at = other, higher = true;
      }
    }
    return most;
  }

  const Polytope* hull_;
  std::array<std::uint32_t, K> at_{};
};

}  // namespace bvlab::closest_features
