// SPDX-License-Identifier: BSD-3-Clause
/// A buffer of primitive pairs from leaves whose volumes overlap, held until there are enough to be
/// tested together. Two leaves with more than `portion` pairs are not buffered but tested
/// immediately, `portion` pairs at a time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "traversal/body.hpp"
#include "traversal/queries/query.hpp"
#include "traversal/tracked_front.hpp"

namespace bvlab {

template <class Query, class Counter, class F>
class HeldPrimitives {
 public:
  using Node = Tree::Node;

  HeldPrimitives(TreeBody& a, TreeBody& b, Query& query, Counter& counter, Workspace& workspace,
                 F& front)
      : a_(a),
        b_(b),
        query_(query),
        counter_(counter),
        workspace_(workspace),
        front_(front),
        pending_(workspace.pending) {}
  /// The leaf stage of a traversal from a front (see traversal.hpp).
  template <class Pair, class Recorder>
  HeldPrimitives(TreeBody& a, TreeBody& b, const Pair&, Query& query, Counter& counter,
                 Workspace& workspace, const Recorder& recorder)
      : HeldPrimitives(a, b, query, counter, workspace, recorder.front()) {
    pending_.clear();
  }

  /// Holds the primitive pairs of two leaves, from the entry in `slot` (Outcome::none: no entry).
  void hold(const Node& a, const Node& b, std::size_t slot) {
    if (is_large(a, b)) [[unlikely]] {
      const Portions done =
          in_portions(a_, b_, query_, counter_, workspace_, front_, a, b, slot, satisfied_);
      satisfied_ = done.satisfied;
      triangles_ += done.triangles;
      if (done.witness != Outcome::none) witness_ = done.witness;
      return;
    }
    for (std::uint32_t i = a.first; i < a.first + a.count; ++i)
      for (std::uint32_t j = b.first; j < b.first + b.count; ++j) hold_pair(i, j, slot);
  }

  static bool is_large(const Node& a, const Node& b) {
    return std::size_t{a.count} * b.count > portion;
  }

  /// Flushes if enough are held.
  [[gnu::always_inline]] bool test_due() { return full() && flush(); }
  /// Flushes at the end of a run.
  [[gnu::always_inline]] bool finish() { return flush(); }

  /// Tests the held pairs and returns whether the query is satisfied. Where two large leaves have
  /// satisfied it already, nothing is tested: the entries of later leaves stay untested until the
  /// next run.
  [[gnu::always_inline]] bool flush() {
    if (!satisfied_) return test();
    for (const Candidate& candidate : pending_)
      if (candidate.slot != Outcome::none) front_.keep(candidate.slot, EntryState::not_yet, 0);
    pending_.clear();
    return true;
  }

  /// Pairs of primitives tested.
  std::size_t tested() const { return triangles_; }
  /// The slot of the entry to test first in the next run, or Outcome::none.
  std::size_t witness() const { return witness_; }
  void forget_witness() { witness_ = Outcome::none; }

 private:
  static constexpr std::size_t portion = 512;

  bool full() const {
    return satisfied_ ||
           pending_.size() > std::max<std::size_t>(Query::buffer_size, F::held_at_least);
  }

  struct Portions {
    bool satisfied;
    std::size_t triangles, witness;
  };

  /// Tests all held pairs, then the triangles of two large leaves until the query is satisfied.
  /// It uses a second object on the same buffer, so that the caller's stays in registers in the
  /// usual case.
  [[gnu::noinline]] static Portions in_portions(TreeBody& body_a, TreeBody& body_b, Query& query,
                                                Counter& counter, Workspace& workspace, F& front,
                                                const Node& a, const Node& b, std::size_t slot,
                                                bool satisfied) {
    HeldPrimitives own(body_a, body_b, query, counter, workspace, front);
    satisfied = satisfied || own.test();
    for (std::uint32_t i = a.first; i < a.first + a.count && !satisfied; ++i)
      for (std::uint32_t j = b.first; j < b.first + b.count && !satisfied; ++j) {
        own.hold_pair(i, j, slot);
        if (own.pending_.size() == portion) satisfied = own.test();
      }
    satisfied = satisfied || own.test();
    if (satisfied && slot != Outcome::none) front.keep(slot, EntryState::not_yet, 0);
    return {satisfied, own.triangles_, own.witness_};
  }

  void hold_pair(std::uint32_t i, std::uint32_t j, std::size_t slot) {
    pending_.push_back(
        {&a_.triangle(i), &b_.triangle(j), a_.tree().primitive(i), b_.tree().primitive(j), slot});
  }

  // Small for most fronts; inlined, it lets the whole traversal stay in registers.
  [[gnu::always_inline]] bool test() {
    if (pending_.empty()) return false;
    const Outcome outcome = front_.primitives(query_, pending_, workspace_);
    if (outcome.witness != Outcome::none) witness_ = pending_[outcome.witness].slot;
    const std::size_t tested = outcome.satisfied ? outcome.witness + 1 : pending_.size();
    triangles_ += tested;
    counter_.primitives(tested);
    pending_.clear();
    return outcome.satisfied;
  }

  TreeBody& a_;
  TreeBody& b_;
  Query& query_;
  Counter& counter_;
  Workspace& workspace_;
  F& front_;
  std::vector<Candidate>& pending_;
  bool satisfied_ = false;  // two large leaves have satisfied the query
  std::size_t triangles_ = 0;
  std::size_t witness_ = Outcome::none;
};

}  // namespace bvlab
