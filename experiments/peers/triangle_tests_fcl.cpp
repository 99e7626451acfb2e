// SPDX-License-Identifier: BSD-3-Clause
#include <fcl/narrowphase/detail/traversal/collision/intersect.h>

#include "experiments/peers/triangle_tests.hpp"

namespace bvlab::peers {

std::size_t count_touching_fcl(std::span<const std::array<Triangle, 2>> pairs) {
  std::size_t touching = 0;
  for (const auto& [a, b] : pairs)
    touching +=
        fcl::detail::Intersect<double>::intersect_Triangle(a[0], a[1], a[2], b[0], b[1], b[2]);
  return touching;
}

}  // namespace bvlab::peers
