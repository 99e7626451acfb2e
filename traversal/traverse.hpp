// SPDX-License-Identifier: BSD-3-Clause
/// Traversals of two bodies by the gathered kernel, in one go: from any front, or from the roots.
#pragma once

#include <type_traits>

#include "traversal/counters.hpp"
#include "traversal/front_recorder.hpp"
#include "traversal/gathered_kernel.hpp"
#include "traversal/no_front.hpp"
#include "traversal/traversal.hpp"

namespace bvlab {

/// Runs the query, a new one, of two bodies that have been moved, from a front, which is updated
/// and remains a partition even if the query ends the run early. Returns the numbers of tests, and
/// whether the run was complete. W pairs of volumes are tested at once.
template <std::size_t W, class Query, class Front>
TraversalStatistics traverse(TreeBody& a, TreeBody& b, const VolumeTests<Query>& tests,
                             Query& query, Workspace& workspace, Front&& front) {
  using Recorder = FrontRecorder<std::remove_reference_t<Front>>;
  static_assert(
      !requires { front.stays(std::size_t(), EntryState::culled, 0.0); },
      "a front's `stays` is now named `keep`: `stays` would never be called");
  NotCounting counter;
  return Traversal<GatheredPair<W, Query>, Query, NotCounting, Recorder>(a, b, query, counter,
                                                                         workspace, front, tests)
      .run();
}

/// The same, counted. B is the scalar or batch in which volumes are tested.
template <class B, class V, class Query, class Counter, class Front>
TraversalStatistics traverse(Body<V>& a, Body<V>& b, Query& query, Counter& counter,
                             Workspace& workspace, Front&& front) {
  constexpr int W = width<B>();
  const TraversalStatistics statistics =
      traverse<W>(a, b, tests_between<W, V, Query>(a, b, workspace), query, workspace,
                  std::forward<Front>(front));
  statistics.count(counter);
  return statistics;
}

/// The same from the two roots, without a front.
template <class B, class V, class Query, class Counter>
TraversalStatistics traverse_from_roots(Body<V>& a, Body<V>& b, Query& query, Counter& counter,
                                        Workspace& workspace) {
  return traverse<B>(a, b, query, counter, workspace, NoFront());
}

}  // namespace bvlab
