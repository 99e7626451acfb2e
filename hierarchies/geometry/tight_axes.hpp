// SPDX-License-Identifier: BSD-3-Clause
/// Axes of a small box around points: starting from given axes, the box is rotated about each axis
/// in turn to the rectangle of least surface, found among the edges of a projected convex hull
/// (toussaint1983solving), until a round gains less than 1 %. A local minimum: the gain over
/// principal axes depends on the points. O(n log n + h^2) per rotation for n points, of which h are
/// on the hull.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "hierarchies/geometry/principal_axes.hpp"
#include "hierarchies/geometry/scalar.hpp"

namespace bvlab {

namespace detail {

/// Drops points that are inside the octagon of those farthest along eight directions, by more than
/// rounding: none is on the hull (akl1978fast). Coordinates are at most 2.
// Templates, so that only those who call them compile them.
template <class = double>
void drop_inner(std::vector<Eigen::Vector2d>& points) {
  std::array<double, 8> farthest;
  farthest.fill(-std::numeric_limits<double>::infinity());
  std::array<Eigen::Vector2d, 8> corners;
  for (const auto& p : points) {
    const double x = p.x(), y = p.y();
    const std::array<double, 8> along{x, x + y, y, y - x, -x, -x - y, -y, x - y};
    for (std::size_t i = 0; i < 8; ++i)
      if (along[i] > farthest[i]) farthest[i] = along[i], corners[i] = p;
  }
  if (corners[0] == corners[4] && corners[2] == corners[6]) return;  // all are equal
  // Inside a side, a x + b y > c; between corners that coincide there is none.
  std::array<double, 8> a, b, c;
  a.fill(0), b.fill(0), c.fill(-1);
  for (std::size_t i = 0; i < 8; ++i) {
    const Eigen::Vector2d side = corners[(i + 1) % 8] - corners[i];
    if (side.x() == 0 && side.y() == 0) continue;
    a[i] = -side.y(), b[i] = side.x(), c[i] = a[i] * corners[i].x() + b[i] * corners[i].y() + 1e-12;
  }
  std::erase_if(points, [&](const Eigen::Vector2d& p) {
    bool inside = true;
    for (std::size_t i = 0; i < 8; ++i) inside &= a[i] * p.x() + b[i] * p.y() > c[i];
    return inside;
  });
}

/// The convex hull, counterclockwise, without points on edges up to rounding (Andrew's monotone
/// chain). Where all points are equal it holds two copies. Sorts `points`, and may drop some.
template <class = double>
void find_hull(std::vector<Eigen::Vector2d>& points, std::vector<Eigen::Vector2d>& hull) {
  if (points.size() > 24) drop_inner(points);
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  const auto turns_left = [](const auto& a, const auto& b, const auto& c) {
    const Eigen::Vector2d p = b - a, q = c - a;
    return p.x() * q.y() - p.y() * q.x() > 0;
  };
  hull.clear();
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
}

template <class = double>
double half_surface(const Vec3<double>& sides) {
  return sides[0] * sides[1] + sides[1] * sides[2] + sides[2] * sides[0];
}

/// A box around points whose coordinates are at most 1, with given axes.
template <class = double>
class RotatedBox {
 public:
  RotatedBox(const Mat3<double>& axes, std::vector<Vec3<double>> points)
      : points_(std::move(points)), axes_(axes), sides_(sides_along(axes)) {}

  const Mat3<double>& axes() const { return axes_; }
  const Vec3<double>& sides() const { return sides_; }
  double half_surface() const { return detail::half_surface(sides_); }

  /// Rotates the box about its k-th axis. Returns whether that makes it smaller; otherwise it is
  /// unchanged.
  bool rotate_about(int k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const auto [along, surface] = best_rectangle(i, j, sides_[k]);
    // Measured along the rotated axes it may be less by rounding alone.
    if (surface > half_surface() * (1 + 1e-9)) return false;
    Mat3<double> rotated = axes_;
    rotated.row(i) = along.x() * axes_.row(i) + along.y() * axes_.row(j);
    rotated.row(j) = axes_.row(k).cross(rotated.row(i));
    const auto axes = orthonormalised(rotated);
    if (!axes) return false;
    const Vec3<double> sides = sides_along(*axes);
    if (!(detail::half_surface(sides) < half_surface())) return false;
    axes_ = *axes, sides_ = sides;
    return true;
  }

 private:
  Vec3<double> sides_along(const Mat3<double>& axes) const {
    Vec3<double> low = Vec3<double>::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const auto& p : points_) {
      const Vec3<double> x = axes * p;
      low = low.cwiseMin(x), high = high.cwiseMax(x);
    }
    return high - low;
  }

  using Several = stdx::native_simd<double>;

  /// Of the rectangles in the plane of axes i and j that have a side on an edge of the hull, the
  /// direction of the one with the least half surface of the box, `height` being its third side;
  /// and that half surface. Infinite where no edge has a direction. Several edges at a time.
  std::pair<Eigen::Vector2d, double> best_rectangle(int i, int j, double height) {
    flat_.clear();
    for (const auto& p : points_) flat_.emplace_back(axes_.row(i).dot(p), axes_.row(j).dot(p));
    find_hull(flat_, hull_);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    constexpr std::size_t width = Several::size();
    std::pair<Eigen::Vector2d, double> best({0, 0}, infinity);
    const std::size_t edges = hull_.size();
    // The first corner is repeated at the end as padding: edges of length 0, which are ignored.
    for (int k = 0; k < 2; ++k) {
      corners_[k].assign(edges + 1 + width, hull_[0][k]);
      for (std::size_t e = 0; e < edges; ++e) corners_[k][e] = hull_[e][k];
    }
    for (std::size_t e = 0; e < edges; e += width) {
      const auto from = [&](std::size_t k, std::size_t at) {
        return Several(&corners_[k][at], stdx::element_aligned);
      };
      const Several dx = from(0, e + 1) - from(0, e), dy = from(1, e + 1) - from(1, e),
                    length = stdx::sqrt(dx * dx + dy * dy), x = dx / length, y = dy / length;
      Several low_x(infinity), high_x(-infinity), low_y = low_x, high_y = high_x;
      for (std::size_t p = 0; p < edges; ++p) {
        const Several px(corners_[0][p]), py(corners_[1][p]), along = x * px + y * py,
                                                              across = -y * px + x * py;
        low_x = stdx::min(low_x, along), high_x = stdx::max(high_x, along);
        low_y = stdx::min(low_y, across), high_y = stdx::max(high_y, across);
      }
      const Several u = high_x - low_x, v = high_y - low_y,
                    surface = Several(height) * u + u * v + v * Several(height);
      // An edge too short to have a direction has NaN.
      const Several known =
          select(stdx::abs(x * x + y * y - Several(1)) < Several(0.5), surface, Several(infinity));
      if (const double least = stdx::hmin(known); least < best.second) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(bits(known == Several(least))));
        best = {{x[lane], y[lane]}, least};
      }
    }
    return best;
  }

  std::vector<Vec3<double>> points_;
  Mat3<double> axes_;
  Vec3<double> sides_;
  std::vector<Eigen::Vector2d> flat_, hull_;
  std::array<std::vector<double>, 2> corners_;  // of the hull
};

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
  detail::RotatedBox<> box(start, std::move(scaled));
  int rejected = 0;  // consecutive rotations: after three, no axis has an improvement left
  for (double before = std::numeric_limits<double>::infinity();
       box.half_surface() < 0.99 * before && rejected < 3;) {
    before = box.half_surface();
    for (int k = 0; k < 3 && rejected < 3; ++k) rejected = box.rotate_about(k) ? 0 : rejected + 1;
  }
  const Vec3<double>& sides = box.sides();
  int order[3] = {0, 1, 2};
  std::sort(order, order + 3, [&](int i, int j) { return sides[i] > sides[j]; });
  Mat3<double> sorted = box.axes();
  sorted.row(0) = box.axes().row(order[0]), sorted.row(1) = box.axes().row(order[1]);
  return detail::orthonormalised(sorted).value_or(box.axes());
}

}  // namespace bvlab
