// SPDX-License-Identifier: BSD-3-Clause
/// Rectangles and the radius by which points are around them, in float64 without a thought of
/// roundings: what rss.hpp rounds and makes safe.
///
/// Along given axes O(n) for n points, after larsen2000fast. `tight_swept_rectangle` tries some
/// eighty of them, at most 160, by surface: as boxes are chosen by what a line hits of them
/// (goldsmith1987automatic).
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
  Vec3<double> origin;   ///< what coordinates along the axes are relative to
  double middle;         ///< the rectangle's place along the normal
  Eigen::Matrix2d ends;  ///< from row 0 to row 1, of either side in a column
  double radius;         ///< no point is farther, but for rounding

  Vec3<double> centre() const {
    Vec3<double> centre = origin + middle * axes.row(2).transpose();
    for (int k = 0; k < 2; ++k) centre += ends.col(k).sum() / 2 * axes.row(k).transpose();
    return centre;
  }
  double half(int side) const { return (ends(1, side) - ends(0, side)) / 2; }
  /// Two sides, four half pipes, one ball.
  double surface() const {
    constexpr double pi = 3.14159265358979;
    return 8 * half(0) * half(1) + 4 * pi * radius * (half(0) + half(1) + radius);
  }
};

namespace detail {

/// How far beside a point, at this height over the rectangle, the rectangle may end.
// Templates, so that only those who call them compile them.
template <class = double>
double beside(double radius, double height) {
  return std::sqrt(std::max(0.0, radius * radius - height * height));
}

/// Pushes corners outward along the diagonal until no point is beyond the radius.
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
    const double reach = beside(rectangle.radius, x[2] - rectangle.middle),
                 across = (out[0] - out[1]) * (out[0] - out[1]) / 2,
                 within = reach * reach - across;
    const double push = (out[0] + out[1]) / 2 - std::sqrt(std::max(0.0, within) / 2);
    if (push <= 0) continue;
    for (int k = 0; k < 2; ++k) ends(corner[k], k) += corner[k] ? push : -push;
  }
}

}  // namespace detail

/// In the plane of the first two axes, halfway through the points; around it what they need there,
/// and `wider` more, by which the rectangle may be smaller. Sides first, then corners.
template <class = double>
SweptRectangle swept_rectangle(const Mat3<double>& axes, std::span<const Vec3<double>> points,
                               double wider = 0) {
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
  rectangle.middle = (low + high) / 2, rectangle.radius = (high - low) / 2 + wider;
  double lows[2] = {infinity, infinity}, highs[2] = {-infinity, -infinity};
  for (const auto& x : along) {
    const double reach = detail::beside(rectangle.radius, x[2] - rectangle.middle);
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

/// Of little surface when it is swept: from given axes on, the best of the three choices of a
/// normal, then turned and widened a little this way and that while it helps, by steps that halve
/// where it does not. A local minimum, no worse than `start` has; where numbers are too large or
/// too small to tell, that of `start`.
template <class = double>
SweptRectangle tight_swept_rectangle(const Mat3<double>& start,
                                     std::span<const Vec3<double>> points) {
  SweptRectangle best = swept_rectangle(start, points);
  const double size = best.half(0) + best.half(1) + best.radius;
  double surface = best.surface(), wider = 0;
  const auto better = [&](const Mat3<double>& axes, double more) {
    const SweptRectangle other = swept_rectangle(axes, points, more);
    if (!(other.surface() < surface)) return false;
    best = other, surface = other.surface(), wider = more;
    return true;
  };
  for (int k = 0; k < 2; ++k) {
    Mat3<double> axes;
    for (int i = 0; i < 3; ++i) axes.row(i) = start.row((k + 1 + i) % 3);
    better(axes, 0);
  }
  const auto turned = [&](int k, double angle) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    Mat3<double> axes = best.axes;
    axes.row(i) = (best.axes.row(i) + angle * best.axes.row(j)).normalized();
    axes.row(j) = axes.row(k).cross(axes.row(i)).normalized();
    return axes;
  };
  pattern_search([&](double step) {
    bool gained = false;
    for (int k = 0; k < 3; ++k)
      gained |= better(turned(k, step), wider) || better(turned(k, -step), wider);
    const double more = step / 4 * size;
    gained |= better(best.axes, wider + more) || better(best.axes, std::max(0.0, wider - more));
    return gained;
  });
  return best;
}

}  // namespace bvlab
