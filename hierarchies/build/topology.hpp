// SPDX-License-Identifier: BSD-3-Clause
/// Trees over a mesh's triangles, without volumes: a binary one, the result of a builder, and a
/// wide one. Any volume can be fitted to any topology.
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

struct WideTopology {
  struct Node {
    std::uint32_t first = 0;  ///< of its children, which are adjacent; leaf: of its primitives
    std::uint32_t count = 0;  ///< the number of children; leaf: of primitives
    bool leaf = false;
    std::uint32_t begin = 0, end = 0;  ///< the primitives below it
  };
  std::vector<Node> nodes;                ///< the root is node 0; level by level
  std::vector<std::uint32_t> primitives;  ///< triangle indices; those below a node are contiguous
};

}  // namespace bvlab
