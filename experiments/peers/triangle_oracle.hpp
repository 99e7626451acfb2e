// SPDX-License-Identifier: BSD-3-Clause
/// What CGAL says in rational numbers about two closed triangles: slow, and independent of
/// everything in this project.
#pragma once

#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab::oracle {

/// Whether the closed triangles share a point; either may be a segment or a point.
bool intersect(const Triangle& a, const Triangle& b);

/// The sign of det [b-a, c-a, d-a], and of the same in the plane of the coordinates i and j.
int orientation(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c,
                const Vec3<double>& d);
int orientation(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c, int i, int j);

/// Whether the corners lie in one line.
bool without_area(const Triangle& t);

/// Their distance, right to about 1e-16 of itself.
long double distance(const Triangle& a, const Triangle& b);

}  // namespace bvlab::oracle
