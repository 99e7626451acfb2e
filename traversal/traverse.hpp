// SPDX-License-Identifier: BSD-3-Clause
/// Traversals of two bodies by the gathered kernel, in one go: from any front, or from the roots.
#pragma once

#include <type_traits>

#include "traversal/front_recorder.hpp"
#include "traversal/gathered_kernel.hpp"
#include "traversal/no_front.hpp"
#include "traversal/traversal.hpp"

namespace bvlab {

/// Runs the query, a new one, of two bodies that have been moved, from a front, which is updated
/// and remains a partition even if the query ends the run early. Returns the numbers of tests, and
/// whether the run was complete. B is the scalar or batch in which volumes are tested.
template <class B, class V, class Query, class Counter, class Front>
TraversalStatistics traverse(Body<V>& a, Body<V>& b, Query& query, Counter& counter,
                             Workspace& workspace, Front&& front) {
  using Recorder = FrontRecorder<std::remove_reference_t<Front>>;
  static_assert(
      !requires { front.stays(std::size_t(), EntryState::culled, 0.0); },
      "a front's `stays` is now named `keep`: `stays` would never be called");
  return Traversal<GatheredPair<B, V>, Query, Counter, Recorder>(a, b, query, counter, workspace,
                                                                 front)
      .run();
}

/// The same from the two roots, without a front.
template <class B, class V, class Query, class Counter>
TraversalStatistics traverse_from_roots(Body<V>& a, Body<V>& b, Query& query, Counter& counter,
                                        Workspace& workspace) {
  return traverse<B>(a, b, query, counter, workspace, NoFront());
}

}  // namespace bvlab
