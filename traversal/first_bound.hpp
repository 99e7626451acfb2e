// SPDX-License-Identifier: BSD-3-Clause
/// A bound for a query that wants one before it starts: one way down to two leaves, always to the
/// nearer child, and their primitives.
#pragma once

#include "traversal/tracked_front.hpp"

namespace bvlab {

/// Says whether the query has had enough.
template <class Traversal>
bool find_first_bound(Traversal& traversal) {
  NodePair pair{0, 0};
  while (true) {
    const auto& a = traversal.a().node(pair.a);
    const auto& b = traversal.b().node(pair.b);
    if (a.count && b.count) break;
    NodePair far = pair;
    if (into_larger(a, b) == Descent::b)
      pair.b = b.first, far.b = b.first + 1;
    else
      pair.a = a.first, far.a = a.first + 1;
    if (traversal.gap(far) < traversal.gap(pair)) pair = far;
  }
  traversal.hold(pair);
  return traversal.flush();
}

}  // namespace bvlab
