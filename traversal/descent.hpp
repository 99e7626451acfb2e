// SPDX-License-Identifier: BSD-3-Clause
/// Whose children take the place of a pair of nodes that is opened, not both of them leaves.
#pragma once

#include <cstdint>

#include "traversal/open_pairs.hpp"

namespace bvlab {

enum class Descent { a, b, both };

/// Of the larger node, of a's where they are equally large; never of a leaf's. Node is that of a
/// Hierarchy.
template <class Node>
constexpr Descent into_larger(const Node& a, const Node& b) {
  return a.count || (!b.count && b.size > a.size) ? Descent::b : Descent::a;
}

/// Pushes the two pairs of one node with the other's children, or the four of both's. `batch` poses
/// them.
template <class Batch, class Node>
[[gnu::always_inline]] inline void descend(const NodePair& pair, const Node& a, const Node& b,
                                           Descent into, Batch& batch, OpenPairs& open) {
  if (into == Descent::both) {
    batch.require({a.first, b.first});
    open.push({a.first + 1, b.first + 1});
    open.push({a.first + 1, b.first});
    open.push({a.first, b.first + 1});
    open.push({a.first, b.first});
  } else {
    const bool second = into == Descent::b;
    const std::uint32_t first = second ? b.first : a.first;
    batch.require_of(into, first);
    open.push(second ? NodePair{pair.a, first + 1} : NodePair{first + 1, pair.b});
    open.push(second ? NodePair{pair.a, first} : NodePair{first, pair.b});
  }
}

}  // namespace bvlab
