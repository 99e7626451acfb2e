// SPDX-License-Identifier: BSD-3-Clause
/// A binary tree over a mesh's triangles, without volumes: the result of a builder. Any volume can
/// be fitted to any topology.
#pragma once

#include <cstdint>
#include <vector>

namespace bvlab {

struct Topology {
  struct Node {
    std::uint32_t first =
        0;  ///< inner: the first of two adjacent children; leaf: of its primitives
    std::uint32_t count = 0;  ///< number of primitives of a leaf; 0 for an inner node
  };
  std::vector<Node> nodes;                ///< the root is node 0; children come after their parent
  std::vector<std::uint32_t> primitives;  ///< triangle indices, leaf by leaf
};

}  // namespace bvlab
