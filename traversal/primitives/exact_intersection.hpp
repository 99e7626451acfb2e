// SPDX-License-Identifier: BSD-3-Clause
/// Decides exactly whether two closed triangles share a point, one pair at a time: first the sides
/// of the planes, then at most two orientations of four corners taken from both triangles
/// (guigue2003fast), each sign exact.
/// Flat pairs (coplanar or of zero area) are decided in a projection by exact separating lines.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "hierarchies/geometry/predicates.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"
#include "traversal/primitives/triangle_filter.hpp"

namespace bvlab {

namespace detail {

using Point = Vec3<double>;

inline bool lexicographically_less(const Point& a, const Point& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

/// The convex hull of a triangle: itself, a segment, or a point.
struct Hull {
  std::array<Point, 3> corner;
  int corners = 3;

  explicit Hull(const Triangle& t) : corner(t) {
    for (int i = 0; i < 3; ++i)
      if (orientation(t[0], t[1], t[2], i, (i + 1) % 3) != 0) return;
    // Collinear points are ordered along their line as they are lexicographically.
    const auto [first, last] = std::minmax_element(t.begin(), t.end(), lexicographically_less);
    const Point ends[] = {*first, *last};
    corner = {ends[0], ends[1], ends[1]};
    corners = ends[0] == ends[1] ? 1 : 2;
  }
  std::span<const Point> points() const {
    return {corner.data(), static_cast<std::size_t>(corners)};
  }
};

/// Whether the line along an edge of `a` separates the hull of `b` strictly from `a`, in the plane
/// of coordinates i and j, in which a triangle `a` must not be collinear.
inline bool separated_by_an_edge(const Hull& a, const Hull& b, int i, int j) {
  if (a.corners == 1) return false;
  const int turn = a.corners == 3 ? orientation(a.corner[0], a.corner[1], a.corner[2], i, j) : 0;
  for (int k = 0; k < (a.corners == 3 ? 3 : 1); ++k) {
    const Point& from = a.corner[k];
    const Point& to = a.corner[(k + 1) % 3];
    bool all_left = turn <= 0, all_right = turn >= 0;
    for (const Point& p : b.points()) {
      const int side = orientation(from, to, p, i, j);
      all_left = all_left && side > 0;
      all_right = all_right && side < 0;
    }
    if (all_left || all_right) return true;
  }
  return false;
}

/// For hulls in one plane, which coordinates i and j map one-to-one. Two convex polygons are apart
/// exactly where an edge of one separates them, unless all points are collinear.
inline bool intersect_in_plane(const Hull& a, const Hull& b, int i, int j) {
  return !separated_by_an_edge(a, b, i, j) && !separated_by_an_edge(b, a, i, j);
}

/// Segment (or point) against triangle, in space.
inline bool segment_intersects_triangle(const Hull& s, const Hull& t) {
  const auto& [a, b, c] = t.corner;
  const Point& p = s.corner[0];
  const Point& q = s.corner[1];
  const int side_of_p = orientation(a, b, c, p);
  const int side_of_q = orientation(a, b, c, q);
  if (side_of_p * side_of_q > 0) return false;
  if (side_of_p == 0 && side_of_q == 0) {
    int i = 0;
    while (orientation(a, b, c, i, (i + 1) % 3) == 0) ++i;
    return intersect_in_plane(s, t, i, (i + 1) % 3);
  }
  // The line crosses the plane in one point, inside the triangle if no two edges disagree.
  const int sides[] = {orientation(p, q, a, b), orientation(p, q, b, c), orientation(p, q, c, a)};
  const auto [least, greatest] = std::minmax_element(sides, sides + 3);
  return *least * *greatest >= 0;
}

/// Segments or points against each other, in space.
inline bool segments_intersect(const Hull& s, const Hull& t) {
  const Point& p = s.corner[0];
  const Point& q = s.corner[1];
  const Point& r = t.corner[0];
  const Point& w = t.corner[1];
  if (orientation(p, q, r, w) != 0) return false;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    if (orientation(p, q, r, i, j) || orientation(p, q, w, i, j) || orientation(p, r, w, i, j) ||
        orientation(q, r, w, i, j))
      return intersect_in_plane(s, t, i, j);
  }
  return !lexicographically_less(q, r) && !lexicographically_less(w, p);  // all in one line
}

/// For coplanar triangles, or where at least one has no area.
inline bool flat_intersect(const Triangle& a, const Triangle& b) {
  const Hull hull_a(a), hull_b(b);
  if (hull_a.corners < 3)
    return hull_b.corners < 3 ? segments_intersect(hull_a, hull_b)
                              : segment_intersects_triangle(hull_a, hull_b);
  if (hull_b.corners < 3) return segment_intersects_triangle(hull_b, hull_a);
  int i = 0;
  while (orientation(a[0], a[1], a[2], i, (i + 1) % 3) == 0) ++i;
  return intersect_in_plane(hull_a, hull_b, i, (i + 1) % 3);
}

/// The corner that is alone on its side of the other triangle's plane, given the three sides (not
/// all equal and nonzero, not all 0), and that side.
struct Apex {
  int corner;
  int side;

  explicit Apex(const std::array<int, 3>& sides) {
    for (corner = 0; corner < 2; ++corner) {
      const int t = sides[(corner + 1) % 3], r = sides[(corner + 2) % 3];
      side = sides[corner];
      if (side != 0 && side * t <= 0 && side * r <= 0) return;
      // In the plane, the others strictly on one side: counts as beyond it.
      if (side == 0 && t * r > 0) {
        side = -t;
        return;
      }
    }
    side = sides[2] != 0 ? sides[2] : -sides[0];
  }
};

inline bool all_on_one_side(const std::array<int, 3>& s) {
  return s[0] != 0 && s[0] == s[1] && s[1] == s[2];
}

/// The sides of the plane of `t` on which three points lie; only signs that the filter left open
/// are computed exactly.
inline std::array<int, 3> exact_sides(const Triangle& t, const Triangle& points,
                                      const std::array<double, 3>& computed, double bound) {
  std::array<int, 3> sides;
  int open = 0;
  for (int i = 0; i < 3; ++i) {
    sides[i] = (computed[i] > bound) - (computed[i] < -bound);
    open += sides[i] == 0;
  }
  if (open == 0) return sides;
  double x[18];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) x[3 * i + j] = t[i][j], x[9 + 3 * i + j] = points[i][j];
  const FixedPoint<18> fixed(x);
  if (fixed.exact) {
    const Fixed3 origin = fixed.point(0);
    const FixedNormal normal(fixed.point(1) - origin, fixed.point(2) - origin);
    for (int i = 0; i < 3; ++i)
      if (sides[i] == 0) sides[i] = normal.side(fixed.point(3 + i) - origin);
  } else {
    for (int i = 0; i < 3; ++i)
      if (sides[i] == 0) sides[i] = exact_orientation(t[0], t[1], t[2], points[i]);
  }
  return sides;
}

inline Corners<double> corners_of(const Triangle& t) {
  return {{{t[0][0], t[0][1], t[0][2]}, {t[1][0], t[1][1], t[1][2]}, {t[2][0], t[2][1], t[2][2]}}};
}

/// The whole test of one pair: boxes, the filter's determinants, and exact ones where needed.
inline bool exactly_intersect(const Triangle& a, const Triangle& b) {
  const Corners<double> x = corners_of(a), y = corners_of(b);
  const filter::BoxAndBound<double, CornersAre::given> box(x, y);
  if (box.apart) return false;
  const auto computed_b = filter::sides_of<double>(x, y);
  if (filter::all_beyond<double>(computed_b, box.bound)) return false;
  const auto computed_a = filter::sides_of<double>(y, x);
  if (filter::all_beyond<double>(computed_a, box.bound)) return false;
  if (!(filter::all_known<double>(computed_a, box.bound) &&
        filter::all_known<double>(computed_b, box.bound)) &&
      filter::share_a_corner<double>(x, y))
    return true;
  const auto sides_b = exact_sides(a, b, computed_b, box.bound);
  constexpr std::array<int, 3> in_plane{};
  if (sides_b == in_plane) return flat_intersect(a, b);
  if (all_on_one_side(sides_b)) return false;
  const auto sides_a = exact_sides(b, a, computed_a, box.bound);
  if (all_on_one_side(sides_a)) return false;
  if (sides_a == in_plane) return flat_intersect(a, b);
  // Both have area, and their planes cross in a line. With corners rotated and swapped so that each
  // apex is above the other's plane, the intervals cut from that line overlap unless one of two
  // orientations is positive.
  const Apex apex_a(sides_a), apex_b(sides_b);
  const Point *p = &a[apex_a.corner], *q = &a[(apex_a.corner + 1) % 3],
              *r = &a[(apex_a.corner + 2) % 3];
  const Point *s = &b[apex_b.corner], *t = &b[(apex_b.corner + 1) % 3],
              *w = &b[(apex_b.corner + 2) % 3];
  if (apex_a.side < 0) std::swap(t, w);
  if (apex_b.side < 0) std::swap(q, r);
  return orientation(*q, *t, *s, *p) <= 0 && orientation(*p, *s, *r, *w) <= 0;
}

}  // namespace detail

}  // namespace bvlab
