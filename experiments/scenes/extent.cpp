// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/extent.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "experiments/files/unusable.hpp"

namespace bvlab {
namespace {

double distance(const Vec3<double>& a, const Vec3<double>& b) {
  // Unlike std::hypot, the same to the last digit everywhere; scaled, so that squares fit.
  const Vec3<double> d = a - b;
  const double scale = d.cwiseAbs().maxCoeff();
  if (scale == 0) return 0;
  const double x = d[0] / scale, y = d[1] / scale, z = d[2] / scale;
  return scale * std::sqrt((x * x + y * y) + z * z);
}

/// The smallest enclosing ball of a triangle stands on its longest side where the angle across is
/// right or obtuse, else it is the circumcircle's: abc / (4 area), the area after Kahan.
double ball_radius(const Triangle& t) {
  double side[3] = {distance(t[0], t[1]), distance(t[1], t[2]), distance(t[2], t[0])};
  std::sort(side, side + 3, std::greater<>());
  const auto [a, b, c] = side;
  const double scaled_b = b / a, scaled_c = c / a;
  if (a == 0 || scaled_b * scaled_b + scaled_c * scaled_c <= 1) return a / 2;
  const double sixteen_squared_areas =
      (a + (b + c)) / a * ((c - (a - b)) / a) * ((c + (a - b)) / a) * ((a + (b - c)) / a);
  return a * scaled_b * scaled_c / std::sqrt(sixteen_squared_areas);
}

}  // namespace

Extent extent_of(const TriangleMesh& mesh) {
  Vec3<double> low = mesh.corners(0)[0], high = low;
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle triangle = mesh.corners(i);
    for (const auto& p : triangle) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const double radius = ball_radius(triangle);
    if (radius > 0) smallest = std::min(smallest, radius);
  }
  Extent extent;
  extent.centre = low / 2 + high / 2;
  for (const auto& triangle : mesh.triangles)
    for (const auto v : triangle)
      extent.radius = std::max(extent.radius, distance(mesh.vertices[v], extent.centre));
  if (std::isfinite(smallest)) extent.leaf_radius = smallest;
  return extent;
}

double resolved(const Length& length, std::span<const Extent> meshes, const char* option) {
  double unit = 1;
  if (length.unit == Length::Unit::leaf) {
    unit = std::numeric_limits<double>::infinity();
    for (const Extent& mesh : meshes)
      if (mesh.leaf_radius > 0) unit = std::min(unit, mesh.leaf_radius);
    if (!std::isfinite(unit))
      throw Unusable(std::string(option) +
                     ": every triangle of the meshes is a point, so that "
                     "there is no smallest radius");
  } else if (length.unit == Length::Unit::body) {
    unit = 0;
    for (const Extent& mesh : meshes) unit = std::max(unit, mesh.radius);
  }
  return length.value * unit;
}

}  // namespace bvlab
