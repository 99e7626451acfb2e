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

/// Which node of a pair is opened, that is, replaced by its children. At least one of the two is an
/// inner node.
enum class Descent { a, b, both };

/// The larger node, a's where they are equally large, but never a leaf. Node is the node type of a
/// Hierarchy.
template <class Node>
constexpr Descent into_larger(const Node& a, const Node& b) {
  return a.count || (!b.count && b.size > a.size) ? Descent::b : Descent::a;
}

}  // namespace bvlab
