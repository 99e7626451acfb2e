// SPDX-License-Identifier: BSD-3-Clause
/// The kernel that gathers: a step tests up to W pairs of nodes from anywhere in both trees, a lane
/// each, and replaces those that overlap by pairs of their children. It runs on any volume
/// and fan-out. In the world frame a volume is posed when it is first needed; else, and where a
/// body is too far from the origin for float (Body::is_far), that of a is
/// posed into the frame of b in each test.
///
/// See traversal.hpp for the members of a pair. A step keeps its pairs and their gaps in memory,
/// since the test itself is out of line: it is compiled once for all fronts and counters.
#pragma once

#include <algorithm>
#include <cstdint>

#include "traversal/body.hpp"
#include "traversal/held_primitives.hpp"
#include "traversal/node_pair.hpp"
#include "traversal/pair_batch.hpp"
#include "traversal/traversal.hpp"

namespace bvlab {

/// The placement of a in the frame of b, if volumes are tested there; null in the world frame,
/// unless a body is far. It lies in the workspace and is valid until the next call.
template <class V>
const PlacementOf<V>* placement_in_b(Body<V>& a, Body<V>& b, Workspace& workspace) {
  if constexpr (PlacedRelatively<V>)
    if (a.frame() == Frame::body || a.is_far() || b.is_far()) {
      auto& placement = workspace.template scratch<PlacementOf<V>>();
      placement = relative_placement<V>(RelativePose(a.orthonormal_pose(), b.orthonormal_pose()),
                                        a.hierarchy().extent().reach);
      return &placement;
    }
  return nullptr;
}

/// Two bodies as this kernel sees them. B is the scalar or batch in which volumes are tested.
template <class B, BoundingVolume V>
class GatheredPair {
 public:
  using Node = typename Hierarchy<V>::Node;
  using Workspace = bvlab::Workspace;
  template <class Query, class Counter, class Recorder>
  using Leaves = HeldPrimitives<V, Query, Counter, typename Recorder::Front>;
  static constexpr std::size_t W = width<B>();

  GatheredPair(Body<V>& a, Body<V>& b, Workspace& workspace)
      : placement_(placement_in_b(a, b, workspace)), a_(a), b_(b), open_(workspace.open) {
    open_.clear();
  }

  Body<V>& a() const { return a_; }
  Body<V>& b() const { return b_; }
  /// The pairs that wait for a test, a stack.
  OpenPairs& open() { return open_; }
  bool done() const { return open_.empty(); }

  /// Pairs that are tested together, and their gaps if kGaps.
  template <bool kGaps>
  struct Step {
    PairBatch<B, kGaps> pairs;
    std::size_t count = 0;

    std::uint64_t lanes() const { return PairBatch<B, kGaps>::all(count); }
  };
  template <TestFor wanted>
  using StepFor = Step<wanted != TestFor::overlap>;

  /// Takes the next step's pairs from the stack and passes them to `visit`.
  template <TestFor wanted, class Query, class Counter, class Recorder, class Visit>
  [[gnu::always_inline]] void next(Query&, Counter&, Recorder&, Visit&& visit) {
    StepFor<wanted> step;
    step.count = std::min(W, open_.size());
    for (std::size_t i = 0; i < step.count; ++i) step.pairs.put(i, open_.pop());
    visit(step);
  }

  /// In the world frame, poses the two volumes unless that has been done since the last move.
  template <class Counter>
  void require(const NodePair& pair, Counter& counter) const {
    a_.require(pair.a, counter);
    b_.require(pair.b, counter);
  }
  /// Which of the step's pairs the query culls. Their volumes must have been required.
  template <TestFor, bool kGaps, class Query, class Counter>
  [[gnu::always_inline]] LanesApart test(Step<kGaps>& step, Query& query, Counter& counter) const {
    count_posed(step.count, counter);
    if constexpr (PlacedRelatively<V>)
      if (placement_) [[unlikely]]
        return {culled_where_stored(step.pairs, stored_volumes(), step.count, query)};
    return {step.pairs.culled(posed_volumes(), step.count, query)};
  }
  /// Replaces the pairs in `lanes` by pairs of their children; of two leaves, the primitives are
  /// held for a test. Entries are told that they are replaced, or kept as near.
  template <bool kGaps, class Entries, class Recorder, class Leaves, class Query, class Counter>
  [[gnu::always_inline]] void pass_on(const Step<kGaps>& step, LanesApart, std::uint64_t lanes,
                                      const Entries& entries, Recorder& recorder, Leaves& leaves,
                                      Query&, Counter& counter) {
    open_.reserve(room);
    step.pairs.template for_each_near<Query>(
        lanes, [&](std::size_t i) __attribute__((always_inline)) {
          open_up(step.pairs, i, entries, recorder, leaves, counter);
        });
  }
  template <class Pairs, class Entries, class Recorder, class Leaves, class Counter>
  [[gnu::always_inline]] void open_up(const Pairs& pairs, std::size_t i, const Entries& entries,
                                      Recorder& recorder, Leaves& leaves, Counter& counter) {
    const NodePair pair = pairs[i];
    const Node &a = a_.hierarchy().node(pair.a), &b = b_.hierarchy().node(pair.b);
    if (a.count && b.count) {
      leaves.hold(a, b, entries.keep(pairs, i, EntryState::near, 0));
    } else {
      entries.replace(i);
      descend(pair, a, b, recorder.descent(a, b), counter);
    }
  }

 private:
  static constexpr std::size_t room = 4 * W;  // for pairs pushed without a check

  template <class Counter>
  [[gnu::always_inline]] void count_posed(std::size_t count, Counter& counter) const {
    if constexpr (Counter::counts)
      if (placement_) counter.posed(count);
  }

  /// The first children are pushed last, so that they are tested first. Room for four pairs of each
  /// lane has been reserved; larger nodes reserve their own.
  template <class Counter>
  [[gnu::always_inline]] void descend(const NodePair& pair, const Node& a, const Node& b,
                                      Descent descent, Counter& counter) {
    if (descent == Descent::both) {
      a_.require_children(a, counter), b_.require_children(b, counter);
      if (a.children + b.children > 4) [[unlikely]]
        return push_all(open_, a, b);
      open_.push({a.first + 1, b.first + 1});
      open_.push({a.first + 1, b.first});
      open_.push({a.first, b.first + 1});
      open_.push({a.first, b.first});
    } else if (descent == Descent::b) {
      open_one(b_, b, counter, [other = pair.a](std::uint32_t child) {
        return NodePair{other, child};
      });
    } else {
      open_one(a_, a, counter, [other = pair.b](std::uint32_t child) {
        return NodePair{child, other};
      });
    }
  }
  /// Called for a or for b, in a branch each: a predicted branch does not wait for the sizes.
  template <class Counter, class WithChild>
  [[gnu::always_inline]] void open_one(Body<V>& body, const Node& node, Counter& counter,
                                       const WithChild& with_child) {
    body.require_children(node, counter);
    if (node.children > 2) [[unlikely]]
      push_from_third(open_, node, with_child);
    open_.push(with_child(node.first + 1));
    open_.push(with_child(node.first));
  }

  // Static and out of line, so that the loop over binary trees stays in registers.
  template <class WithChild>
  [[gnu::noinline]] static void push_from_third(OpenPairs& open, const Node& opened,
                                                WithChild with_child) {
    open.reserve(opened.children + room);
    for (std::uint32_t k = opened.children; k-- > 2;) open.push(with_child(opened.first + k));
  }
  [[gnu::noinline]] static void push_all(OpenPairs& open, const Node& a, const Node& b) {
    open.reserve(std::size_t{a.children} * b.children + room);
    for (std::uint32_t i = a.children; i-- > 0;)
      for (std::uint32_t j = b.children; j-- > 0;) open.push({a.first + i, b.first + j});
  }
  template <class Batch, class Query>
  [[gnu::noinline]] static std::uint64_t culled_where_stored(Batch& batch,
                                                             const StoredVolumes<V>& volumes,
                                                             std::size_t count, Query& query) {
    return batch.culled(volumes, count, query);
  }

  [[gnu::always_inline]] PosedVolumes<V> posed_volumes() const {
    return {a_.volumes(), b_.volumes()};
  }
  [[gnu::always_inline]] StoredVolumes<V> stored_volumes() const {
    return {a_.hierarchy().volumes(), b_.hierarchy().volumes(), *placement_};
  }

  const PlacementOf<V>* placement_;
  Body<V>& a_;
  Body<V>& b_;
  OpenPairs& open_;
};

}  // namespace bvlab
