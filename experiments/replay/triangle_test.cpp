// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/triangle_test.hpp"

#include "traversal/primitives/precisions.hpp"

namespace bvlab {

template std::uint64_t intersect_batch<Exact>(const Triangle* const*, const Triangle* const*, int);
template std::uint64_t touching_with_margins<double>(const Triangle* const*, const Triangle* const*,
                                                     int, TriangleTest, double*);
template TriangleDistance distance<double>(const Triangle&, const Triangle&);
template TriangleDistance distance<DoubleDouble>(const Triangle&, const Triangle&);

TriangleTest triangle_test(std::string_view precision) {
  TriangleTest test = nullptr;
  Precisions::with(precision, [&]<class Precision>(std::type_identity<Precision>) {
    test = intersect_batch<Precision>;
  });
  return test;
}

}  // namespace bvlab
