// SPDX-License-Identifier: BSD-3-Clause
/// Whose children take the place of a pair of nodes that is opened, not both of them leaves.
#pragma once

namespace bvlab {

enum class Descent { a, b, both };

/// Of the larger node, of a's where they are equally large; never of a leaf's. Node is that of a
/// Hierarchy.
template <class Node>
constexpr Descent into_larger(const Node& a, const Node& b) {
  return a.count || (!b.count && b.size > a.size) ? Descent::b : Descent::a;
}

}  // namespace bvlab
