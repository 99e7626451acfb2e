// SPDX-License-Identifier: BSD-3-Clause
/// Fits a rectangle swept by a sphere to points, in float64 without regard to rounding; rss.hpp
/// makes the result safe.
///
/// Along given axes O(n) for n points, after larsen2000fast. `tight_swept_rectangle` tries some
/// eighty sets of axes, at most 160, and keeps the one of least surface area, which is proportional
/// to how many lines hit it (goldsmith1987automatic).
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "hierarchies/geometry/pattern_search.hpp"
#include "hierarchies/geometry/scalar.hpp"

namespace bvlab {

struct SweptRectangle {
  Mat3<double> axes;     ///< rows, orthonormal: along the sides, then the normal
  Vec3<double> origin;   ///< of the coordinates along the axes
  double plane_offset;   ///< the rectangle's coordinate along the normal
  Eigen::Matrix2d ends;  ///< column k: where side k begins and ends
  double radius;         ///< bounds the distance of all points, up to rounding

  Vec3<double> centre() const {
    Vec3<double> centre = origin + plane_offset * axes.row(2).transpose();
    for (int k = 0; k < 2; ++k) centre += ends.col(k).sum() / 2 * axes.row(k).transpose();
    return centre;
  }
  double half(int side) const { return (ends(1, side) - ends(0, side)) / 2; }
  /// The surface area: two rectangles, four half cylinders, one sphere.
  double surface() const {
    constexpr double pi = 3.14159265358979;
    return 8 * half(0) * half(1) + 4 * pi * radius * (half(0) + half(1) + radius);
  }
};

namespace detail {

/// How far the rectangle may end before a point at this height over its plane.
// Templates, so that only those who call them compile them.
template <class = double>
double beside(double radius, double height) {
  return std::sqrt(std::max(0.0, radius * radius - height * height));
}

/// Moves corners outward along the diagonal until every point is within the radius.
template <class = double>
void push_corners(SweptRectangle& rectangle, std::span<const Vec3<double>> along) {
  Eigen::Matrix2d& ends = rectangle.ends;
  for (const auto& x : along) {
    int corner[2];
    double out[2];
    for (int k = 0; k < 2; ++k) {
      corner[k] = x[k] > (ends(0, k) + ends(1, k)) / 2;
      out[k] = corner[k] ? x[k] - ends(1, k) : ends(0, k) - x[k];
    }
    if (!(out[0] > 0 && out[1] > 0)) continue;
    const double reach = beside(rectangle.radius, x[2] - rectangle.plane_offset),
                 across = (out[0] - out[1]) * (out[0] - out[1]) / 2,
                 within = reach * reach - across;
    const double push = (out[0] + out[1]) / 2 - std::sqrt(std::max(0.0, within) / 2);
    if (push <= 0) continue;
    for (int k = 0; k < 2; ++k) ends(corner[k], k) += corner[k] ? push : -push;
  }
}

}  // namespace detail

/// The rectangle in the plane of the first two axes, halfway through the points. Its radius is the
/// one needed there plus `extra_radius`, which lets the rectangle shrink. Sides first, then
/// corners.
template <class = double>
SweptRectangle swept_rectangle(const Mat3<double>& axes, std::span<const Vec3<double>> points,
                               double extra_radius = 0) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  SweptRectangle rectangle;
  rectangle.axes = axes, rectangle.origin = points[0];
  std::vector<Vec3<double>> along;
  along.reserve(points.size());
  double low = infinity, high = -low;
  for (const auto& p : points) {
    along.emplace_back(axes * (p - points[0]));
    low = std::min(low, along.back()[2]), high = std::max(high, along.back()[2]);
  }
  rectangle.plane_offset = (low + high) / 2, rectangle.radius = (high - low) / 2 + extra_radius;
  double lows[2] = {infinity, infinity}, highs[2] = {-infinity, -infinity};
  for (const auto& x : along) {
    const double reach = detail::beside(rectangle.radius, x[2] - rectangle.plane_offset);
    for (int k = 0; k < 2; ++k)
      lows[k] = std::min(lows[k], x[k] + reach), highs[k] = std::max(highs[k], x[k] - reach);
  }
  for (int k = 0; k < 2; ++k) {
    if (lows[k] > highs[k]) lows[k] = highs[k] = (lows[k] + highs[k]) / 2;
    rectangle.ends(0, k) = lows[k], rectangle.ends(1, k) = highs[k];
  }
  detail::push_corners(rectangle, along);
  return rectangle;
}

/// A rectangle with a small swept surface area: the best of the three choices of a normal among
/// the axes of `start`, then rotated and widened by pattern search. A local minimum, no worse than
/// the rectangle along `start`, and equal to it where numbers are too large or too small to
/// compare.
template <class = double>
SweptRectangle tight_swept_rectangle(const Mat3<double>& start,
                                     std::span<const Vec3<double>> points) {
  SweptRectangle best = swept_rectangle(start, points);
  const double size = best.half(0) + best.half(1) + best.radius;
  double surface = best.surface(), extra_radius = 0;
  const auto better = [&](const Mat3<double>& axes, double more) {
    const SweptRectangle other = swept_rectangle(axes, points, more);
    if (!(other.surface() < surface)) return false;
    best = other, surface = other.surface(), extra_radius = more;
    return true;
  };
  for (int k = 0; k < 2; ++k) {
    Mat3<double> axes;
    for (int i = 0; i < 3; ++i) axes.row(i) = start.row((k + 1 + i) % 3);
    better(axes, 0);
  }
  const auto rotated = [&](int k, double angle) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    Mat3<double> axes = best.axes;
    axes.row(i) = (best.axes.row(i) + angle * best.axes.row(j)).normalized();
    axes.row(j) = axes.row(k).cross(axes.row(i)).normalized();
    return axes;
  };
  pattern_search([&](double step) {
    bool gained = false;
    for (int k = 0; k < 3; ++k)
      gained |= better(rotated(k, step), extra_radius) || better(rotated(k, -step), extra_radius);
    const double more = step / 4 * size;
    gained |= better(best.axes, extra_radius + more) ||
              better(best.axes, std::max(0.0, extra_radius - more));
    return gained;
  });
  return best;
}

}  // namespace bvlab
