// SPDX-License-Identifier: BSD-3-Clause
/// The smallest enclosing sphere of points, as an LP-type problem: at most four points support it;
/// while a point lies outside, the farthest one enters the support and a new basis is chosen among
/// the five (gartner1999miniball). Each step enlarges the sphere, so it terminates; in practice
/// after about ten passes over the points.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <span>

#include "hierarchies/geometry/scalar.hpp"

namespace bvlab {

struct EnclosingSphere {
  Vec3<double> centre = Vec3<double>::Zero();
  double squared_radius = -1;  ///< negative where there are no points
};

namespace detail {

/// The smallest sphere with all the points (at most four) on its boundary. Meaningless where they
/// are affinely dependent; the caller notices, since that sphere misses a point.
// Templates, so that only those who call them compile them.
template <class = double>
EnclosingSphere circumscribed(std::span<const Vec3<double>> points) {
  if (points.empty()) return {};
  const auto edge = [&](std::size_t i) -> Vec3<double> { return points[i] - points[0]; };
  Vec3<double> offset = Vec3<double>::Zero();
  if (points.size() == 2) {
    offset = edge(1) / 2;
  } else if (points.size() == 3) {
    const Vec3<double> a = edge(1), b = edge(2), n = a.cross(b);
    offset = (a.squaredNorm() * b - b.squaredNorm() * a).cross(n) / (2 * n.squaredNorm());
  } else if (points.size() == 4) {
    const Vec3<double> a = edge(1), b = edge(2), c = edge(3);
    offset = (a.squaredNorm() * b.cross(c) + b.squaredNorm() * c.cross(a) +
              c.squaredNorm() * a.cross(b)) /
             (2 * a.dot(b.cross(c)));
  }
  if (!offset.allFinite()) return {};
  return {points[0] + offset, offset.squaredNorm()};
}

}  // namespace detail

/// The smallest sphere around the points, up to rounding: a caller who needs enclosure takes the
/// largest distance from its centre as the radius. Points may be repeated or dependent; without
/// points the squared radius is negative.
template <class = double>
EnclosingSphere enclosing_sphere(std::span<const Vec3<double>> points) {
  if (points.empty()) return {};
  std::array<Vec3<double>, 5> support;  // the last one is the entering point
  std::size_t supports = 1;
  support[0] = points[0];
  EnclosingSphere sphere{points[0], 0};
  for (int pass = 0; pass < 100; ++pass) {
    const Vec3<double>* farthest = nullptr;
    double largest = sphere.squared_radius * (1 + 1e-14);
    for (const auto& p : points)
      if (const double d = (p - sphere.centre).squaredNorm(); d > largest)
        largest = d, farthest = &p;
    if (!farthest) break;
    support[supports] = *farthest;
    // The smallest sphere through the entering point and some of the support that contains all.
    EnclosingSphere best;
    unsigned chosen = 0;
    for (unsigned subset = 0; subset < 1u << supports; ++subset) {
      if (std::popcount(subset) > 3) continue;
      std::array<Vec3<double>, 4> on;
      std::size_t count = 0;
      on[count++] = *farthest;
      for (std::size_t i = 0; i < supports; ++i)
        if (subset >> i & 1) on[count++] = support[i];
      const EnclosingSphere candidate = detail::circumscribed(std::span(on).first(count));
      if (candidate.squared_radius < 0) continue;
      if (best.squared_radius >= 0 && candidate.squared_radius >= best.squared_radius) continue;
      const bool holds_all = std::all_of(
          support.begin(), support.begin() + static_cast<long>(supports) + 1, [&](const auto& p) {
            return (p - candidate.centre).squaredNorm() <= candidate.squared_radius * (1 + 1e-12);
          });
      if (holds_all) best = candidate, chosen = subset;
    }
    // Rounding may leave no larger sphere: then this one is as good as possible.
    if (!(best.squared_radius > sphere.squared_radius)) break;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < supports; ++i)
      if (chosen >> i & 1) support[kept++] = support[i];
    support[kept++] = *farthest;
    supports = kept;
    sphere = best;
  }
  return sphere;
}

}  // namespace bvlab
