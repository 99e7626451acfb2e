// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/peers/triangle_tests.hpp"

#include "experiments/peers/collected.hpp"
#include "experiments/peers/found.hpp"

namespace bvlab {

#define BVLAB_DECLARED(library) std::span<const TriangleTestPeer> library##_triangles();
#define BVLAB_LISTED(library) library##_triangles,
BVLAB_TRIANGLE_PEERS(BVLAB_DECLARED)
std::span<const TriangleTestPeer> moller_triangles();

std::span<const TriangleTestPeer> triangle_test_peers() {
  static const auto all =
      collected<TriangleTestPeer>({BVLAB_TRIANGLE_PEERS(BVLAB_LISTED) moller_triangles});
  return all;
}

}  // namespace bvlab
