// SPDX-License-Identifier: BSD-3-Clause
/// Finds a first upper bound for a query that wants one (distance): descends once from the roots to
/// two leaves, always to the nearest child, and tests their primitives.
#pragma once

#include "traversal/tracked_front.hpp"

namespace bvlab {

/// Returns whether the query is satisfied.
template <class Traversal>
bool find_first_bound(Traversal& traversal) {
  NodePair pair{0, 0};
  while (true) {
    const auto& a = traversal.a().node(pair.a);
    const auto& b = traversal.b().node(pair.b);
    if (a.count && b.count) break;
    const bool by_b = into_larger(a, b) == Descent::b;
    pair = traversal.nearest(by_b ? b.children : a.children, [&, was = pair](std::size_t k) {
      const auto child = static_cast<std::uint32_t>(k);
      return by_b ? NodePair{was.a, b.first + child} : NodePair{a.first + child, was.b};
    });
  }
  traversal.hold(pair);
  return traversal.flush();
}

}  // namespace bvlab
