// SPDX-License-Identifier: BSD-3-Clause
#include <fcl/narrowphase/detail/traversal/collision/intersect.h>

#include "experiments/peers/triangle_tests.hpp"

namespace bvlab {
namespace {

/// As FCL's mesh traversal calls it.
void decide_fcl(TriangleTestPeer::Pairs pairs, std::uint8_t* verdicts) {
  for (const auto& [a, b] : pairs)
    *verdicts++ =
        fcl::detail::Intersect<double>::intersect_Triangle(a[0], a[1], a[2], b[0], b[1], b[2]);
}

}  // namespace

std::span<const TriangleTestPeer> fcl_triangles() {
  static constexpr TriangleTestPeer list[] = {
      {"fcl", "separating axes in float64, after PQP", decide_fcl},
  };
  return list;
}

}  // namespace bvlab
