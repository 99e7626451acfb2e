// SPDX-License-Identifier: BSD-3-Clause
/// A sphere around the triangles below a node of a hierarchy, in the mesh's frame, whatever the
/// node's volume. The relative motion of two bodies is bounded on it (traversal/measured_gaps.hpp).
#pragma once

#include <algorithm>
#include <span>

#include "hierarchies/geometry/scalar.hpp"
#include "hierarchies/geometry/small_matrices.hpp"

namespace bvlab {

struct alignas(16) NodeSphere {
  float centre[3];
  float radius;

  NodeSphere() = default;
  /// Centred on the bounding box of the points, of which there is at least one.
  explicit NodeSphere(std::span<const Vec3<double>> points) {
    Vec3<double> low = points[0], high = points[0];
    for (const auto& point : points)
      for (int i = 0; i < 3; ++i)
        low[i] = std::min(low[i], point[i]), high[i] = std::max(high[i], point[i]);
    const Vec3<double> at = put_centre(low, high);
    double squared = 0;
    for (const auto& point : points) squared = std::max(squared, squared_norm<double>(point - at));
    put_radius(largest_norm(squared, [&](const auto& take) {
      for (const auto& point : points) take(point - at);
    }));
  }
  /// Around the spheres of children, of which there is at least one.
  explicit NodeSphere(std::span<const NodeSphere> children) {
    const auto corner = [](const NodeSphere& child, double towards) {
      return Vec3<double>(child.centre[0] + towards * child.radius,
                          child.centre[1] + towards * child.radius,
                          child.centre[2] + towards * child.radius);
    };
    Vec3<double> low = corner(children[0], -1), high = corner(children[0], 1);
    for (const auto& child : children)
      low = low.cwiseMin(corner(child, -1)), high = high.cwiseMax(corner(child, 1));
    const Vec3<double> at = put_centre(low, high);
    double farthest = 0;
    for (const auto& child : children)
      farthest = std::max(farthest, stable_norm(corner(child, 0) - at) + child.radius);
    put_radius(farthest);
  }

  /// Sets the centre to that of a box, rounded to float, and returns it.
  Vec3<double> put_centre(const Vec3<double>& low, const Vec3<double>& high) {
    const Vec3<float> at = rounded<float>(0.5 * low + 0.5 * high);
    for (int i = 0; i < 3; ++i) centre[i] = at[i];
    return at.cast<double>();
  }
  /// Sets the radius to at least `farthest`, which has been computed with fewer than sixteen
  /// roundings.
  void put_radius(double farthest) {
    radius = rounded_up<float>(farthest * (1 + 16 * unit_roundoff<double>));
  }
};

}  // namespace bvlab
