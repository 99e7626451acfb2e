// SPDX-License-Identifier: BSD-3-Clause
/// Candidate centres for a spherical shell around a surface, the axis of its cone, and lower bounds
/// on the distance from a centre to the surface. In float64; shell.hpp rounds the results safely.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "hierarchies/geometry/enclosing_sphere.hpp"
#include "hierarchies/geometry/pattern_search.hpp"
#include "hierarchies/geometry/principal_axes.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

namespace detail {

/// A lower bound on the distance from `o` to the triangle. For any vector m the triangle is beyond
/// the plane m.(x - o) = min m.(corner - o); m points to the nearest point found.
// Templates, so that only those who call them compile them.
template <class = double>
double distance_below(const Vec3<double>& o, const Triangle& triangle) {
  const Vec3<double> a = triangle[0] - o, b = triangle[1] - o, c = triangle[2] - o;
  const auto bound = [&](const Vec3<double>& m) {
    const double length = m.norm();
    return length > 0 ? std::min({m.dot(a), m.dot(b), m.dot(c)}) / length : 0.0;
  };
  const auto on_segment = [](const Vec3<double>& p, const Vec3<double>& q) -> Vec3<double> {
    const Vec3<double> d = q - p;
    const double squared = d.squaredNorm();
    return squared > 0 ? Vec3<double>(p + std::clamp(-p.dot(d) / squared, 0.0, 1.0) * d) : p;
  };
  const Vec3<double> n = (b - a).cross(c - a);
  const double best = std::max({bound(a.dot(n) * n), bound(on_segment(a, b)),
                                bound(on_segment(b, c)), bound(on_segment(c, a))});
  const double largest = std::max({a.lpNorm<1>(), b.lpNorm<1>(), c.lpNorm<1>()}) +
                         4 * unit_roundoff<double> * o.lpNorm<1>();
  return std::max(0.0, best - 16 * unit_roundoff<double> * largest);
}

/// The centre c that minimises sum (|p - c|^2 - r^2)^2 over c and r: linear in c and r^2 - |c|^2.
template <class = double>
std::optional<Vec3<double>> fitted_sphere(const Vec3<double>& centre, double radius,
                                          std::span<const Vec3<double>> points) {
  if (points.size() < 4) return std::nullopt;
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (const auto& p : points) {
    const Vec3<double> x = (p - centre) / radius;
    const Eigen::Vector4d row(2 * x[0], 2 * x[1], 2 * x[2], 1);
    normal += row * row.transpose();
    right += row * x.squaredNorm();
  }
  const Eigen::Vector4d solution = normal.ldlt().solve(right);
  if (!solution.allFinite()) return std::nullopt;
  return Vec3<double>(centre + radius * solution.head<3>());
}

template <class = double>
Vec3<double> thin_direction(const Vec3<double>& centre, double radius,
                            std::span<const Vec3<double>> points) {
  std::vector<Vec3<double>> scaled;
  scaled.reserve(points.size());
  for (const auto& p : points) scaled.push_back((p - centre) / radius);
  return principal_axes(scaled).row(2).transpose();
}

}  // namespace detail

/// Candidate centres: that of the best-fitting sphere, if near, and points on both sides of the
/// surface, 1.5 to 12 enclosing radii away. None where the sphere is a point or not finite.
template <class = double>
std::vector<Vec3<double>> shell_centres(const EnclosingSphere& sphere,
                                        std::span<const Vec3<double>> points) {
  std::vector<Vec3<double>> centres;
  const double radius = std::sqrt(std::max(0.0, sphere.squared_radius));
  if (!(radius > 0) || !std::isfinite(radius)) return centres;
  const auto fitted = detail::fitted_sphere(sphere.centre, radius, points);
  if (fitted && (*fitted - sphere.centre).norm() < 16 * radius) centres.push_back(*fitted);
  const Vec3<double> normal = detail::thin_direction(sphere.centre, radius, points);
  for (const double distance : {1.5, 3.0, 6.0, 12.0})
    for (const double side : {-1.0, 1.0})
      if (const Vec3<double> centre = sphere.centre + side * distance * radius * normal;
          centre.allFinite())
        centres.push_back(centre);
  return centres;
}

/// The axis of the narrowest cone at `centre` around the points, if they lie in a half space: it
/// leads to the centre of the smallest sphere around their directions. Else any direction or 0.
template <class = double>
Vec3<double> narrowest_axis(const Vec3<double>& centre, std::span<const Vec3<double>> points) {
  std::vector<Vec3<double>> directions;
  directions.reserve(points.size());
  for (const auto& p : points) directions.push_back((p - centre).stableNormalized());
  const Vec3<double> axis = enclosing_sphere(directions).centre;
  return axis.norm() > 0.01 ? axis.normalized() : Vec3<double>(Vec3<double>::Zero());
}

/// Improves `centre` by pattern search: `better(other)` tries the shell about another centre. Steps
/// go around the sphere's centre, towards it and away, and halve where none helps. At most 120 are
/// tried.
template <class Better>
void improve_centre(Vec3<double>& centre, const EnclosingSphere& sphere, Better&& better) {
  const double radius = std::sqrt(std::max(0.0, sphere.squared_radius));
  pattern_search([&](double step) {
    bool gained = false;
    const Vec3<double> offset = centre - sphere.centre;
    const double length = step * std::max(offset.norm(), radius);
    const Vec3<double> out = offset.norm() > 0 ? Vec3<double>(offset.stableNormalized())
                                               : Vec3<double>(Vec3<double>::UnitX()),
                       across = out.unitOrthogonal();
    for (const Vec3<double>& way : {across, Vec3<double>(out.cross(across)), out})
      for (const double by : {length, -length}) {
        const Vec3<double> other = centre + by * way;
        if (!((other - sphere.centre).norm() < 16 * radius) || !better(other)) continue;
        centre = other, gained = true;
        break;
      }
    return gained;
  });
}

}  // namespace bvlab
