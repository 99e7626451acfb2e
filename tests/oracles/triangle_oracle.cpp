// SPDX-License-Identifier: BSD-3-Clause
#include "tests/oracles/triangle_oracle.hpp"

#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/intersections.h>

#include <array>

namespace bvlab::oracle {
namespace {

using Kernel = CGAL::Simple_cartesian<CGAL::Exact_rational>;
using Point = Kernel::Point_3;
using Segment = Kernel::Segment_3;
using Solid = Kernel::Triangle_3;

/// CGAL asks for triangles with area and segments with length, so each hull is given its own type.
template <class F>
bool with_hull(const Triangle& t, const F& f) {
  std::array<Point, 3> p;
  for (int i = 0; i < 3; ++i) p[i] = Point(t[i][0], t[i][1], t[i][2]);
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

}  // namespace

bool intersect(const Triangle& a, const Triangle& b) {
  return with_hull(
      a, [&](const auto& x) { return with_hull(b, [&](const auto& y) { return meet(x, y); }); });
}

}  // namespace bvlab::oracle
