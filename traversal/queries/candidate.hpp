// SPDX-License-Identifier: BSD-3-Clause
/// Two primitives whose leaves could not be told apart, waiting to be tested.
#pragma once

#include <cstdint>

#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

struct Candidate {
  const Triangle* triangle_a;  ///< in the world
  const Triangle* triangle_b;
  std::uint32_t a, b;  ///< their indices in their meshes
  std::size_t slot;    ///< of the front's entry they come from, where a front is kept
};

}  // namespace bvlab
