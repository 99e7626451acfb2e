// SPDX-License-Identifier: BSD-3-Clause
/// Which node of a pair is opened, that is, replaced by its children. At least one of the two is an
/// inner node.
#pragma once

namespace bvlab {

enum class Descent { a, b, both };

/// The larger node, a's where they are equally large, but never a leaf. Node is the node type of a
/// Hierarchy.
template <class Node>
constexpr Descent into_larger(const Node& a, const Node& b) {
  return a.count || (!b.count && b.size > a.size) ? Descent::b : Descent::a;
}

}  // namespace bvlab
