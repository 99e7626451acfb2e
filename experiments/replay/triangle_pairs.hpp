// SPDX-License-Identifier: BSD-3-Clause
/// Pairs of triangles from a file, and which of them share a point.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiments/replay/triangle_test.hpp"

namespace bvlab {

/// float64 .npy of shape (pairs, 18), as the intersection test takes them: triangles 2 i and
/// 2 i + 1. Throws Unusable where a number is not finite.
std::vector<Triangle> read_triangle_pairs(const std::string& path);

/// One a pair: 1 where the two share a point.
std::vector<std::uint8_t> verdicts_on(const std::vector<Triangle>& triangles, TriangleTest test);

}  // namespace bvlab
