// SPDX-License-Identifier: BSD-3-Clause
/// A polygon cut into triangles, the same ones every time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// Appends the n-2 triangles of a polygon of n corners, given as indices into the mesh's vertices,
/// all in range; for n < 3 nothing. A triangle goes in as it is. Larger ones lose ears, in the
/// projection along their normal (Newell's), always the first ear that there is, so that a polygon
/// that is flat, concave or not, is covered once. One that has no ear (flat, knotted) is cut as if
/// it had. Time n for a convex polygon, n^2 r for one with r concave corners.
void append_polygon(TriangleMesh& mesh, std::span<const std::uint32_t> corners);

}  // namespace bvlab
