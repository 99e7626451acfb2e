// SPDX-License-Identifier: BSD-3-Clause
/// Axes of a small box around points: starting from given axes, the box is rotated about each axis
/// in turn to the rectangle of least surface, found among the edges of a projected convex hull
/// (toussaint1983solving), until a round gains less than 1 %. A local minimum: the gain over
/// principal axes depends on the points. O(n log n) per rotation for n points.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "hierarchies/geometry/principal_axes.hpp"
#include "hierarchies/geometry/scalar.hpp"

namespace bvlab {

namespace detail {

/// The convex hull, counterclockwise, without points on edges up to rounding (Andrew's monotone
/// chain). Where all points are equal it holds two copies.
// Templates, so that only those who call them compile them.
template <class = double>
std::vector<Eigen::Vector2d> convex_hull(std::vector<Eigen::Vector2d> points) {
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  const auto turns_left = [](const auto& a, const auto& b, const auto& c) {
    const Eigen::Vector2d p = b - a, q = c - a;
    return p.x() * q.y() - p.y() * q.x() > 0;
  };
  std::vector<Eigen::Vector2d> hull;
  const auto add_chain = [&](auto first, auto last) {
    const std::size_t start = hull.size();
    for (; first != last; ++first) {
      while (hull.size() >= start + 2 && !turns_left(hull[hull.size() - 2], hull.back(), *first))
        hull.pop_back();
      hull.push_back(*first);
    }
    hull.pop_back();
  };
  add_chain(points.begin(), points.end());
  add_chain(points.rbegin(), points.rend());
  return hull;
}

template <class = double>
double half_surface(const Vec3<double>& sides) {
  return sides[0] * sides[1] + sides[1] * sides[2] + sides[2] * sides[0];
}

template <class = double>
Vec3<double> sides_along(const Mat3<double>& axes, std::span<const Vec3<double>> points) {
  Vec3<double> low = Vec3<double>::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const auto& p : points) {
    const Vec3<double> x = axes * p;
    low = low.cwiseMin(x), high = high.cwiseMax(x);
  }
  return high - low;
}

/// Rotates the axes about the k-th; nothing where no hull edge gives a direction.
template <class = double>
std::optional<Mat3<double>> rotated_about(int k, const Mat3<double>& axes, double height,
                                          std::span<const Vec3<double>> points) {
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  std::vector<Eigen::Vector2d> flat;
  flat.reserve(points.size());
  for (const auto& p : points) flat.emplace_back(axes.row(i).dot(p), axes.row(j).dot(p));
  const auto hull = convex_hull(std::move(flat));
  double least = std::numeric_limits<double>::infinity();
  Eigen::Vector2d best(0, 0);
  for (std::size_t e = 0; e < hull.size(); ++e) {
    const Eigen::Vector2d along = (hull[(e + 1) % hull.size()] - hull[e]).normalized(),
                          across(-along.y(), along.x());
    // Skip an edge too short to have a direction.
    if (!(std::abs(along.squaredNorm() - 1) < 0.5)) continue;
    Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()),
                    high = -low;
    for (const auto& p : hull) {
      const Eigen::Vector2d x(along.dot(p), across.dot(p));
      low = low.cwiseMin(x), high = high.cwiseMax(x);
    }
    const Eigen::Vector2d sides = high - low;
    if (const double surface = half_surface({height, sides.x(), sides.y()}); surface < least)
      least = surface, best = along;
  }
  Mat3<double> rotated = axes;
  rotated.row(i) = best.x() * axes.row(i) + best.y() * axes.row(j);
  rotated.row(j) = axes.row(k).cross(rotated.row(i));
  return orthonormalised(rotated);
}

}  // namespace detail

/// The axes as rows, orthonormal up to rounding, by decreasing length of the box; `start` likewise.
/// No worse than `start`, and equal to it where numbers are too large or small.
template <class = double>
Mat3<double> tight_axes(const Mat3<double>& start, std::span<const Vec3<double>> points) {
  const Vec3<double> origin = points[0];
  const double extent = detail::extent_about(origin, points);
  if (!(extent > 0) || !(extent < std::numeric_limits<double>::infinity())) return start;
  std::vector<Vec3<double>> scaled;
  scaled.reserve(points.size());
  for (const auto& p : points) scaled.push_back((p - origin) / extent);
  Mat3<double> axes = start;
  double surface = detail::half_surface(detail::sides_along(axes, scaled));
  for (double before = std::numeric_limits<double>::infinity(); surface < 0.99 * before;) {
    before = surface;
    for (int k = 0; k < 3; ++k) {
      const auto rotated =
          detail::rotated_about(k, axes, detail::sides_along(axes, scaled)[k], scaled);
      if (!rotated) continue;
      const double reached = detail::half_surface(detail::sides_along(*rotated, scaled));
      if (reached < surface) axes = *rotated, surface = reached;
    }
  }
  const Vec3<double> sides = detail::sides_along(axes, scaled);
  int order[3] = {0, 1, 2};
  std::sort(order, order + 3, [&](int i, int j) { return sides[i] > sides[j]; });
  Mat3<double> sorted = axes;
  sorted.row(0) = axes.row(order[0]), sorted.row(1) = axes.row(order[1]);
  return detail::orthonormalised(sorted).value_or(axes);
}

}  // namespace bvlab
