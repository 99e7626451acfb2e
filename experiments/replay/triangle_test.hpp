// SPDX-License-Identifier: BSD-3-Clause
/// Triangle against triangle, compiled once for all volumes and queries; and the test of a
/// precision's name.
#pragma once

#include <string_view>

#include "traversal/primitives/triangle_distance.hpp"
#include "traversal/primitives/triangle_distance_bound.hpp"
#include "traversal/primitives/triangle_intersection.hpp"
#include "traversal/primitives/triangle_margin.hpp"

namespace bvlab {

extern template std::uint64_t intersect_batch<Exact>(const Triangle* const*, const Triangle* const*,
                                                     int);
extern template std::uint64_t touching_with_margins<double>(const Triangle* const*,
                                                            const Triangle* const*, int,
                                                            TriangleTest, double*);
extern template TriangleDistance distance<double>(const Triangle&, const Triangle&);
extern template TriangleDistance distance<DoubleDouble>(const Triangle&, const Triangle&);

/// The name is one of Precisions; null where it is not.
TriangleTest triangle_test(std::string_view precision);

}  // namespace bvlab
