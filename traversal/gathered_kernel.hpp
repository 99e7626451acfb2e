// SPDX-License-Identifier: BSD-3-Clause
/// The kernel that gathers: a step tests up to W pairs of nodes from anywhere in both trees, a lane
/// each, and replaces those that overlap by pairs of their children. It runs on trees of any volume
/// and fan-out, in either frame (volume_tests.hpp).
///
/// See traversal.hpp for the members of a pair. A step keeps its pairs and their gaps in memory,
/// since the test itself is out of line.
#pragma once

#include <algorithm>
#include <cstdint>

#include "traversal/body.hpp"
#include "traversal/held_primitives.hpp"
#include "traversal/node_pair.hpp"
#include "traversal/pair_batch.hpp"
#include "traversal/traversal.hpp"

namespace bvlab {

/// Two bodies as this kernel sees them.
template <std::size_t kLanes, class Query>
class GatheredPair {
 public:
  using Node = Tree::Node;
  using Workspace = bvlab::Workspace;
  template <class SameQuery, class Counter, class Recorder>
  using Leaves = HeldPrimitives<Query, Counter, typename Recorder::Front>;
  static constexpr std::size_t W = kLanes;  ///< pairs tested at once

  GatheredPair(TreeBody& a, TreeBody& b, Workspace& workspace, const VolumeTests<Query>& tests)
      : tests_(tests), a_(a), b_(b), open_(workspace.open) {
    open_.clear();
  }

  TreeBody& a() const { return a_; }
  TreeBody& b() const { return b_; }
  /// The number of volumes posed in so many tests.
  std::size_t posed(std::size_t tests) const { return posed_ + (tests_.placement ? tests : 0); }
  /// The pairs that wait for a test, a stack.
  OpenPairs& open() { return open_; }
  bool done() const { return open_.empty(); }

  /// Pairs that are tested together, and their gaps if kGaps.
  template <bool kGaps>
  struct Step {
    PairBatch<W, kGaps> pairs;
    std::size_t count = 0;

    std::uint64_t lanes() const { return PairBatch<W, kGaps>::all(count); }
  };
  template <TestFor wanted>
  using StepFor = Step<wanted != TestFor::overlap>;

  /// Takes the next step's pairs from the stack and visits them.
  template <class Traversal>
  [[gnu::always_inline]] void next(Traversal& traversal) {
    StepFor<Traversal::wanted> step;
    step.count = std::min(W, open_.size());
    for (std::size_t i = 0; i < step.count; ++i) step.pairs.put(i, open_.pop());
    traversal.visit(step, traversal.recorder().no_entries());
  }

  /// In the world frame, poses the two volumes unless that has been done since the last move.
  void require(const NodePair& pair) { a_.require(pair.a, posed_), b_.require(pair.b, posed_); }
  /// Which of the step's pairs the query culls. Their volumes must have been required.
  template <TestFor, bool kGaps, class Counter>
  [[gnu::always_inline]] LanesApart test(Step<kGaps>& step, Query& query, Counter&) const {
    return {step.pairs.culled(tests_, step.count, query)};
  }
  /// Replaces the pairs in `lanes` by pairs of their children; of two leaves, the primitives are
  /// held for a test. Entries are told that they are replaced, or kept as near.
  template <bool kGaps, class Entries, class Recorder, class Leaves, class Counter>
  [[gnu::always_inline]] void pass_on(const Step<kGaps>& step, LanesApart, std::uint64_t lanes,
                                      const Entries& entries, Recorder& recorder, Leaves& leaves,
                                      Query&, Counter&) {
    open_.reserve(room);
    step.pairs.template for_each_near<Query>(
        lanes, [&](std::size_t i) __attribute__((always_inline)) {
          open_up(step.pairs, i, entries, recorder, leaves);
        });
  }
  template <class Pairs, class Entries, class Recorder, class Leaves>
  [[gnu::always_inline]] void open_up(const Pairs& pairs, std::size_t i, const Entries& entries,
                                      Recorder& recorder, Leaves& leaves) {
    const NodePair pair = pairs[i];
    const Node &a = a_.tree().node(pair.a), &b = b_.tree().node(pair.b);
    if (a.count && b.count) {
      leaves.hold(a, b, entries.keep(pairs, i, EntryState::near, 0));
    } else {
      entries.replace(i);
      descend(pair, a, b, recorder.descent(a, b));
    }
  }

 private:
  static constexpr std::size_t room = 4 * W;  // for pairs pushed without a check

  /// The first children are pushed last, so that they are tested first. Room for four pairs of each
  /// lane has been reserved; larger nodes reserve their own.
  [[gnu::always_inline]] void descend(const NodePair& pair, const Node& a, const Node& b,
                                      Descent descent) {
    if (descent == Descent::both) {
      a_.require_children(a, posed_), b_.require_children(b, posed_);
      if (a.children + b.children > 4) [[unlikely]]
        return push_all(open_, a, b);
      open_.push({a.first + 1, b.first + 1});
      open_.push({a.first + 1, b.first});
      open_.push({a.first, b.first + 1});
      open_.push({a.first, b.first});
    } else if (descent == Descent::b) {
      open_one(b_, b, [other = pair.a](std::uint32_t child) { return NodePair{other, child}; });
    } else {
      open_one(a_, a, [other = pair.b](std::uint32_t child) { return NodePair{child, other}; });
    }
  }
  /// Called for a or for b, in a branch each: a predicted branch does not wait for the sizes.
  template <class WithChild>
  [[gnu::always_inline]] void open_one(TreeBody& body, const Node& node,
                                       const WithChild& with_child) {
    body.require_children(node, posed_);
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
  const VolumeTests<Query> tests_;
  TreeBody& a_;
  TreeBody& b_;
  std::size_t posed_ = 0;
  OpenPairs& open_;
};

}  // namespace bvlab
