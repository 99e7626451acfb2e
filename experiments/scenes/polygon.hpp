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
/// projection along their normal (Newell's), always the first ear that there is. A polygon that is
/// flat and does not cross itself is covered once: it may be concave, touch itself, have corners
/// on a straight line, repeated ones, spikes, and holes that are joined to its outline by an edge
/// there and back. What is cut off spikes and straight lines are triangles without area. One that
/// crosses itself has no such cut: up to 64 corners, the one of least area is taken.
///
/// Time n for a convex polygon, n^2 r for one with r concave corners, n^3 for one that crosses
/// itself. Signs are exact.
void append_polygon(TriangleMesh& mesh, std::span<const std::uint32_t> corners);

/// Appends the n-2 triangles of a strip, every other one turned about, and those of a fan.
void append_strip(TriangleMesh& mesh, std::span<const std::uint32_t> corners);
void append_fan(TriangleMesh& mesh, std::span<const std::uint32_t> corners);

}  // namespace bvlab
