// SPDX-License-Identifier: BSD-3-Clause
/// The directions in which points or a surface spread most and least: eigenvectors of the
/// covariance, after gottschalk1996obbtree. O(n).
#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <span>

#include "hierarchies/geometry/scalar.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

namespace detail {

/// Orthonormal to a few roundings, in rows, by decreasing spread; the identity where the covariance
/// says nothing.
// Templates, so that only those who call them compile them.
template <class = double>
Mat3<double> axes_of(const Mat3<double>& covariance) {
  if (!covariance.allFinite()) return Mat3<double>::Identity();
  const Eigen::SelfAdjointEigenSolver<Mat3<double>> solver(covariance);
  Vec3<double> a = solver.eigenvectors().col(2), b = solver.eigenvectors().col(1);
  a.normalize();
  b = (b - a.dot(b) * a).normalized();
  Mat3<double> axes;
  axes.row(0) = a, axes.row(1) = b, axes.row(2) = a.cross(b).normalized();
  return axes.allFinite() ? axes : Mat3<double>::Identity();
}

/// The largest coordinate's distance from `origin`, to scale by: squares must not overflow.
template <class Points>
double extent_about(const Vec3<double>& origin, const Points& points) {
  double extent = 0;
  for (const auto& p : points) extent = std::max(extent, (p - origin).cwiseAbs().maxCoeff());
  return extent;
}

}  // namespace detail

/// Of one point or more.
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

/// Of the surface: the second moment of a triangle with corners p, q, r and mean m is
/// area / 12 (9 mm' + pp' + qq' + rr'). Of the corners where the surface has no area.
template <class = double>
Mat3<double> principal_axes(std::span<const Vec3<double>> points,
                            std::span<const Triangle> triangles) {
  const Vec3<double> origin = points[0];
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
