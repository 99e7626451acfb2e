// SPDX-License-Identifier: BSD-3-Clause
/// How other libraries decide whether two triangles share a point: each in a loop of its own, so
/// that nothing but its test is timed.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab::peers {

/// How many of the pairs touch. CGAL's filtered exact predicates; triangles without area are
/// outside its preconditions. The time includes making its objects.
std::size_t count_touching_cgal(std::span<const std::array<Triangle, 2>> pairs);

/// FCL's test of two triangles, as its mesh traversal calls it: separating axes in float64 (PQP's).
std::size_t count_touching_fcl(std::span<const std::array<Triangle, 2>> pairs);

}  // namespace bvlab::peers
