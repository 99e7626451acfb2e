// SPDX-License-Identifier: BSD-3-Clause
/// Principal axes of points or of a surface: the eigenvectors of the covariance, in the order of
/// decreasing spread (gottschalk1996obbtree). O(n).
#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "hierarchies/geometry/scalar.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

namespace detail {

/// Nearly orthonormal rows, made orthonormal in long double and rounded, so that each is off by u
/// in length, as volumes with axes require. Nothing where they are not nearly orthonormal.
template <class = double>
std::optional<Mat3<double>> orthonormalised(const Mat3<double>& rows) {
  using Wide = Eigen::Matrix<long double, 3, 1>;
  Wide a = rows.row(0).transpose().cast<long double>();
  Wide b = rows.row(1).transpose().cast<long double>();
  const auto near_unit = [](const Wide& v) { return std::abs(v.squaredNorm() - 1) < 0.1L; };
  if (!near_unit(a)) return std::nullopt;
  a /= std::sqrt(a.squaredNorm());
  b -= a.dot(b) * a;
  if (!near_unit(b)) return std::nullopt;
  b /= std::sqrt(b.squaredNorm());
  b -= a.dot(b) * a;
  Mat3<double> result;
  result.row(0) = a.cast<double>().transpose(), result.row(1) = b.cast<double>().transpose();
  result.row(2) = a.cross(b).cast<double>().transpose();
  return result;
}

/// The axes as rows, by decreasing spread; the identity where the covariance is degenerate.
// Templates, so that only those who call them compile them.
template <class = double>
Mat3<double> axes_of(const Mat3<double>& covariance) {
  if (!covariance.allFinite()) return Mat3<double>::Identity();
  const Eigen::SelfAdjointEigenSolver<Mat3<double>> solver(covariance);
  Mat3<double> axes = Mat3<double>::Zero();
  axes.row(0) = solver.eigenvectors().col(2).transpose();
  axes.row(1) = solver.eigenvectors().col(1).transpose();
  return orthonormalised(axes).value_or(Mat3<double>::Identity());
}

/// The largest coordinate difference to `origin`, to scale by: squares must not overflow.
template <class Points>
double extent_about(const Vec3<double>& origin, const Points& points) {
  double extent = 0;
  for (const auto& p : points) extent = std::max(extent, (p - origin).cwiseAbs().maxCoeff());
  return extent;
}

}  // namespace detail

/// The principal axes of points (one or more), as rows.
template <class = double>
Mat3<double> principal_axes(std::span<const Vec3<double>> points) {
  const Vec3<double> origin = points[0];
  const double extent = detail::extent_about(origin, points);
  if (!(extent > 0)) return Mat3<double>::Identity();
  Vec3<double> mean = Vec3<double>::Zero();
  for (const auto& p : points) mean += (p - origin) / extent;
  mean /= static_cast<double>(points.size());
  Mat3<double> covariance = Mat3<double>::Zero();
  for (const auto& p : points) {
    const Vec3<double> d = (p - origin) / extent - mean;
    covariance += d * d.transpose();
  }
  return detail::axes_of(covariance);
}

/// The principal axes of a surface, as rows: the second moment of a triangle with corners p, q, r
/// and mean m is area / 12 (9 mm' + pp' + qq' + rr'). Those of the points where the area is 0.
template <class = double>
Mat3<double> principal_axes(std::span<const Vec3<double>> points,
                            std::span<const Triangle> triangles) {
  const Vec3<double>& origin = points[0];
  const double extent = detail::extent_about(origin, points);
  if (!(extent > 0)) return Mat3<double>::Identity();
  Vec3<double> mean = Vec3<double>::Zero();
  Mat3<double> moment = Mat3<double>::Zero();
  double total = 0;
  for (const auto& [a, b, c] : triangles) {
    const Vec3<double> p = (a - origin) / extent, q = (b - origin) / extent,
                       r = (c - origin) / extent, m = (p + q + r) / 3;
    const double area = (q - p).cross(r - p).norm() / 2;
    total += area;
    mean += area * m;
    moment += area / 12 *
              (9 * m * m.transpose() + p * p.transpose() + q * q.transpose() + r * r.transpose());
  }
  if (!(total > 0)) return principal_axes(points);
  mean /= total;
  return detail::axes_of(moment / total - mean * mean.transpose());
}

}  // namespace bvlab
