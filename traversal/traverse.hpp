// SPDX-License-Identifier: BSD-3-Clause
/// The loop over two hierarchies. Pairs of nodes are tested W at a time. A pair that the query
/// culls is not descended. A pair of leaves passes its primitives to the query. Any other pair is
/// replaced by the pairs of one node with the other's children, or by all pairs of children.
///
/// Started from the two roots it is the recursive algorithm, depth first up to W - 1 pairs. Started
/// from a front it tests the entries that the front names, in the front's order, and keeps the
/// front up to date. Volume, query, counter, width and front are template parameters; fan-out and
/// frame are the bodies'. The loop depends on none of them.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <type_traits>

#include "traversal/first_bound.hpp"
#include "traversal/no_front.hpp"
#include "traversal/traversal_steps.hpp"

namespace bvlab {

/// One run. The public members are for sweeps of fronts; those that return bool return whether the
/// query is satisfied. B is the scalar or batch, of W lanes, in which volumes are tested.
template <class B, class V, class Query, class Counter, class Front>
class Traversal : public TraversalSteps<B, V, Query, Counter, Front> {
  using Steps = TraversalSteps<B, V, Query, Counter, Front>;
  using Steps::front_, Steps::open_, Steps::batch_, Steps::held_, Steps::query_, Steps::tests_;

 public:
  using Steps::Steps, Steps::W, Steps::a, Steps::b, Steps::culled, Steps::flush;
  using typename Steps::Node;

  TraversalStatistics run() {
    bool satisfied = wants_bound<Query>() && !front_.witnessed() && find_first_bound(*this);
    satisfied = satisfied || front_.sweep(*this);
    while (!open_.empty() && !satisfied) satisfied = test_open_pairs();
    satisfied = satisfied || flush();
    while (!open_.empty()) front_.add(open_.pop(), EntryState::not_yet, 0);
    front_.finish(held_.witness(), satisfied);
    return {!satisfied, tests_, held_.tested()};
  }

  /// Tests the entries in slots slot(0), slot(1), ..., and descends below them as far as that fills
  /// whole batches.
  template <class Slot>
  bool test_entries(std::size_t count, Slot&& slot) {
    bool satisfied = false;
    for (std::size_t next = 0, some; next < count && !satisfied; next += some) {
      some = std::min(W, count - next);
      satisfied = test_batch_of_entries(some, [&](std::size_t i) { return slot(next + i); });
      satisfied = satisfied || fill_batches();
    }
    return satisfied;
  }
  /// Tests one entry and its primitives at once: a witness mostly decides the query.
  bool test_entry(std::size_t slot) {
    return test_batch_of_entries(1, [slot](std::size_t) { return slot; }) || flush();
  }
  bool fill_batches() {
    bool satisfied = false;
    while (open_.size() >= W && !satisfied) satisfied = test_open_pairs();
    return satisfied;
  }

  /// Descends below a pair that is no entry and is known not to be culled.
  void enter(const NodePair& pair) {
    open_.reserve(4);
    batch_.put(0, pair);
    open_up(0, added(), [](std::size_t) {});
  }

 private:
  template <class Slot>
  bool test_batch_of_entries(std::size_t count, Slot&& slot) {
    const std::uint64_t mask = culled(count, [&](std::size_t i) { return front_[slot(i)]; });
    return keep_or_open(
        count, mask,
        [&](std::size_t i, EntryState state, double gap) {
          front_.keep(slot(i), state, gap);
          return static_cast<std::size_t>(slot(i));
        },
        [&](std::size_t i) { front_.open(slot(i)); });
  }

  bool test_open_pairs() {
    const std::size_t count = std::min(W, open_.size());
    for (std::size_t i = 0; i < count; ++i) batch_.put(i, open_.pop());
    return keep_or_open(count, this->test(count), added(), [](std::size_t) {});
  }

  auto added() {
    return [this](std::size_t i, EntryState state, double gap) {
      return front_.add(batch_[i], state, gap);
    };
  }

  /// `keep` makes the pair in a lane an entry, or leaves it one, and returns its slot; `replace` is
  /// called if the pair is replaced by its children.
  template <class Keep, class Replace>
  [[gnu::always_inline]] bool keep_or_open(std::size_t count, std::uint64_t culled, Keep&& keep,
                                           Replace&& replace) {
    open_.reserve(4 * W);
    for (std::uint64_t rest = culled; rest; rest &= rest - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(rest));
      const NodePair pair = batch_[i];
      if (front_.opens(query_, a().node(pair.a), b().node(pair.b), batch_.gap(i)))
        culled &= ~(std::uint64_t{1} << i);
      else
        keep(i, EntryState::culled, batch_.gap(i));
    }
    batch_.template for_each_near<Query>(~culled & batch_.all(count),
                                         [&](std::size_t i) { open_up(i, keep, replace); });
    return held_.full() && flush();
  }

  /// Holds the primitives of two leaves; replaces any other pair by its children.
  template <class Keep, class Replace>
  [[gnu::always_inline]] void open_up(std::size_t i, Keep&& keep, Replace&& replace) {
    const NodePair pair = batch_[i];
    const Node &a = this->a().node(pair.a), &b = this->b().node(pair.b);
    if (a.count && b.count) {
      held_.hold(a, b, keep(i, EntryState::near, 0));
    } else {
      replace(i);
      this->descend(pair, a, b);
    }
  }
};

namespace detail {

/// The placement of a in the frame of b, if volumes are tested there; null in the world frame. It
/// lies in the workspace and is valid until the next call.
template <class V>
const bvlab::PlacementOf<V>* placement_in_b(Body<V>& a, Body<V>& b, Workspace& workspace) {
  if constexpr (PlacedRelatively<V>)
    if (a.frame() == Frame::body) {
      auto& placement = workspace.template scratch<bvlab::PlacementOf<V>>();
      placement = relative_placement<V>(RelativePose(a.orthonormal_pose(), b.orthonormal_pose()),
                                        a.hierarchy().extent().reach);
      return &placement;
    }
  return nullptr;
}

}  // namespace detail

/// Runs the query of two bodies from a front, which is updated and remains a partition even if the
/// query ends the run early. Returns the numbers of tests, and whether the run was complete.
template <class B, class V, class Query, class Counter, class Front>
TraversalStatistics traverse(Body<V>& a, Body<V>& b, Query& query, Counter& counter,
                             Workspace& workspace, Front&& front) {
  using Run = Traversal<B, V, Query, Counter, std::remove_reference_t<Front>>;
  static_assert(TrackedFront<std::remove_cvref_t<Front>, Run>);
  static_assert(
      !requires { front.stays(std::size_t(), EntryState::culled, 0.0); },
      "TrackedFront::stays is named keep: as it is, nothing would call it");
  return Run(a, b, detail::placement_in_b(a, b, workspace), query, counter, workspace, front).run();
}

/// The same from the two roots, without a front.
template <class B, class V, class Query, class Counter>
TraversalStatistics traverse_from_roots(Body<V>& a, Body<V>& b, Query& query, Counter& counter,
                                        Workspace& workspace) {
  return traverse<B>(a, b, query, counter, workspace, NoFront());
}

}  // namespace bvlab
