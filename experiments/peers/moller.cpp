// SPDX-License-Identifier: BSD-3-Clause
/// Moller's triangle test as published [moller1997fast]: each triangle cuts an interval from the
/// line in which the planes cross, computed by division along the line's longest coordinate; signed
/// distances below an absolute 1e-6 count as zero, as in its author's code.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "experiments/peers/triangle_tests.hpp"

namespace bvlab {
namespace {

constexpr double epsilon = 1e-6;

struct Plane {
  Vec3<double> normal;
  double offset;

  explicit Plane(const Triangle& t)
      : normal((t[1] - t[0]).cross(t[2] - t[0])), offset(-normal.dot(t[0])) {}

  std::array<double, 3> distances(const Triangle& t) const {
    std::array<double, 3> d;
    for (std::size_t i = 0; i < 3; ++i) {
      d[i] = normal.dot(t[i]) + offset;
      if (std::abs(d[i]) < epsilon) d[i] = 0;
    }
    return d;
  }
};

bool same_side(const std::array<double, 3>& d) { return d[0] * d[1] > 0 && d[0] * d[2] > 0; }

/// Where the triangle meets the line, or nothing where it lies in the other's plane.
bool interval(const std::array<double, 3>& at, const std::array<double, 3>& d,
              std::pair<double, double>& cut) {
  std::size_t alone;
  if (d[0] * d[1] > 0)
    alone = 2;
  else if (d[0] * d[2] > 0)
    alone = 1;
  else if (d[1] * d[2] > 0 || d[0] != 0)
    alone = 0;
  else if (d[1] != 0)
    alone = 1;
  else if (d[2] != 0)
    alone = 2;
  else
    return false;
  const auto end = [&](std::size_t other) {
    return at[alone] + (at[other] - at[alone]) * d[alone] / (d[alone] - d[other]);
  };
  cut = std::minmax(end((alone + 1) % 3), end((alone + 2) % 3));
  return true;
}

double turn(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c, int i, int j) {
  return (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
}

bool edges_cross(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c,
                 const Vec3<double>& d, int i, int j) {
  return turn(a, b, c, i, j) * turn(a, b, d, i, j) <= 0 &&
         turn(c, d, a, i, j) * turn(c, d, b, i, j) <= 0;
}

bool contains(const Triangle& t, const Vec3<double>& p, int i, int j) {
  const double x = turn(t[0], t[1], p, i, j), y = turn(t[1], t[2], p, i, j),
               z = turn(t[2], t[0], p, i, j);
  return (x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0);
}

bool coplanar(const Triangle& a, const Triangle& b, const Vec3<double>& normal) {
  int longest;
  normal.cwiseAbs().maxCoeff(&longest);
  const int i = (longest + 1) % 3, j = (longest + 2) % 3;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t l = 0; l < 3; ++l)
      if (edges_cross(a[k], a[(k + 1) % 3], b[l], b[(l + 1) % 3], i, j)) return true;
  return contains(a, b[0], i, j) || contains(b, a[0], i, j);
}

bool touch(const Triangle& a, const Triangle& b) {
  const Plane plane_a(a), plane_b(b);
  const auto of_b = plane_a.distances(b);
  if (same_side(of_b)) return false;
  const auto of_a = plane_b.distances(a);
  if (same_side(of_a)) return false;
  const Vec3<double> line = plane_a.normal.cross(plane_b.normal);
  int longest;
  line.cwiseAbs().maxCoeff(&longest);
  std::pair<double, double> cut_a, cut_b;
  if (!interval({a[0][longest], a[1][longest], a[2][longest]}, of_a, cut_a) ||
      !interval({b[0][longest], b[1][longest], b[2][longest]}, of_b, cut_b))
    return coplanar(a, b, plane_a.normal);
  return !(cut_a.second < cut_b.first || cut_b.second < cut_a.first);
}

void decide_moller(TriangleTestPeer::Pairs pairs, std::uint8_t* verdicts) {
  for (const auto& [a, b] : pairs) *verdicts++ = touch(a, b);
}

}  // namespace

std::span<const TriangleTestPeer> moller_triangles() {
  static constexpr TriangleTestPeer list[] = {
      {"moller", "Moller's interval test in float64, signs below 1e-6 taken as zero",
       decide_moller},
  };
  return list;
}

}  // namespace bvlab
