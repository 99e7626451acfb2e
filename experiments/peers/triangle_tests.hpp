// SPDX-License-Identifier: BSD-3-Clause
/// THE list of other triangle tests: how other libraries, and the published algorithms in plain
/// float64, decide whether two triangles share a point. Each has a loop of its own, so that nothing
/// but its test (and making its objects of the corners) is timed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

struct TriangleTestPeer {
  using Pairs = std::span<const std::array<Triangle, 2>>;

  std::string_view name, description;
  /// Fills one verdict for each pair: 1 where they touch.
  void (*decide)(Pairs pairs, std::uint8_t* verdicts);
  bool takes_zero_area = true;  ///< else it may abort on triangles without area
};

std::span<const TriangleTestPeer> triangle_test_peers();

}  // namespace bvlab
