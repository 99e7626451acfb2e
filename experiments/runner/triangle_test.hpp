// SPDX-License-Identifier: BSD-3-Clause
/// The triangle test of a precision's name, compiled once for all volumes.
#pragma once

#include <string_view>

#include "traversal/primitives/triangle_intersection.hpp"
#include "traversal/primitives/triangle_margin.hpp"

namespace bvlab {

extern template std::uint64_t intersect_batch<Exact>(const Triangle* const*, const Triangle* const*,
                                                     int);

/// The name is one of Precisions.
TriangleTest triangle_test(std::string_view precision);

}  // namespace bvlab
