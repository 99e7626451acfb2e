// SPDX-License-Identifier: BSD-3-Clause
/// Two indices, the first of body a and the second of body b: of nodes, and in wide trees also of a
/// triangle and a leaf, or of two triangles.
#pragma once

#include <cstdint>

namespace bvlab {

struct NodePair {
  std::uint32_t a, b;
  friend bool operator==(const NodePair&, const NodePair&) = default;
};

}  // namespace bvlab
