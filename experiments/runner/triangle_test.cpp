// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/runner/triangle_test.hpp"

#include "traversal/primitives/precisions.hpp"

namespace bvlab {

template std::uint64_t intersect_batch<Exact>(const Triangle* const*, const Triangle* const*, int);

TriangleTest triangle_test(std::string_view precision) {
  TriangleTest test = nullptr;
  Precisions::with(precision, [&]<class Precision>(std::type_identity<Precision>) {
    test = intersect_batch<Precision>;
  });
  return test;
}

}  // namespace bvlab
