// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/peers/triangle_oracle.hpp"

#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/intersections.h>
#include <CGAL/squared_distance_3.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace bvlab::oracle {
namespace {

using Kernel = CGAL::Simple_cartesian<CGAL::Exact_rational>;
using Rational = CGAL::Exact_rational;
using Point = Kernel::Point_3;
using Segment = Kernel::Segment_3;
using Solid = Kernel::Triangle_3;

Point point(const Vec3<double>& p) { return Point(p[0], p[1], p[2]); }

/// CGAL asks for triangles with area and segments with length, so each hull is given its own type.
template <class F>
auto with_hull(const Triangle& t, const F& f) {
  std::array<Point, 3> p;
  for (int i = 0; i < 3; ++i) p[i] = point(t[i]);
  if (!CGAL::collinear(p[0], p[1], p[2])) return f(Solid(p[0], p[1], p[2]));
  for (int i = 0; i < 3; ++i)
    for (int j = i + 1; j < 3; ++j)
      if (p[i] != p[j] && Segment(p[i], p[j]).has_on(p[3 - i - j])) return f(Segment(p[i], p[j]));
  return f(p[0]);
}

bool meet(const Point& a, const Point& b) { return a == b; }
template <class T>
bool meet(const Point& a, const T& b) {
  return b.has_on(a);
}
template <class T>
bool meet(const T& a, const Point& b) {
  return a.has_on(b);
}
template <class T, class U>
bool meet(const T& a, const U& b) {
  return CGAL::do_intersect(a, b);
}

Rational corners_to_hull(const Triangle& corners, const Triangle& t) {
  return with_hull(t, [&](const auto& hull) {
    Rational least = CGAL::squared_distance(point(corners[0]), hull);
    for (int i = 1; i < 3; ++i)
      least = std::min(least, Rational(CGAL::squared_distance(point(corners[i]), hull)));
    return least;
  });
}

}  // namespace

int orientation(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c,
                const Vec3<double>& d) {
  return static_cast<int>(CGAL::orientation(point(a), point(b), point(c), point(d)));
}

int orientation(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c, int i, int j) {
  const auto seen = [&](const Vec3<double>& p) { return Kernel::Point_2(p[i], p[j]); };
  return static_cast<int>(CGAL::orientation(seen(a), seen(b), seen(c)));
}

bool without_area(const Triangle& t) {
  return CGAL::collinear(point(t[0]), point(t[1]), point(t[2]));
}

bool intersect(const Triangle& a, const Triangle& b) {
  return with_hull(
      a, [&](const auto& x) { return with_hull(b, [&](const auto& y) { return meet(x, y); }); });
}

long double distance(const Triangle& a, const Triangle& b) {
  if (intersect(a, b)) return 0;
  // What is apart is nearest between a corner and a hull, or between two edges.
  auto squared = corners_to_hull(a, b);
  squared = std::min(squared, corners_to_hull(b, a));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (a[i] != a[(i + 1) % 3] && b[j] != b[(j + 1) % 3])
        squared = std::min(
            squared, Rational(CGAL::squared_distance(Segment(point(a[i]), point(a[(i + 1) % 3])),
                                                     Segment(point(b[j]), point(b[(j + 1) % 3])))));
  // Brought to where neither it nor its root leaves the range of doubles.
  const Rational step(std::ldexp(1, 400));
  long double unit = 1;
  for (; squared < Rational(std::ldexp(1, -400)); squared *= step) unit *= std::ldexp(1.0L, -200);
  for (; squared > Rational(std::ldexp(1, 400)); squared /= step) unit *= std::ldexp(1.0L, 200);
  return std::sqrt(static_cast<long double>(CGAL::to_double(squared))) * unit;
}

}  // namespace bvlab::oracle
