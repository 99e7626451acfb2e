// SPDX-License-Identifier: BSD-3-Clause
/// The primitives of leaves that could not be told apart, held until there are enough of them to be
/// tested together. Two leaves with more than `portion` pairs of primitives are tested by
/// themselves, so much at a time, where they would be held.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "traversal/body.hpp"
#include "traversal/queries/query.hpp"
#include "traversal/tracked_front.hpp"

namespace bvlab {

template <class V, class Query, class Counter, class F>
class HeldPrimitives {
 public:
  using Node = typename Hierarchy<V>::Node;

  HeldPrimitives(Body<V>& a, Body<V>& b, Query& query, Counter& counter, Workspace& workspace,
                 F& front)
      : a_(a),
        b_(b),
        query_(query),
        counter_(counter),
        workspace_(workspace),
        front_(front),
        pending_(workspace.pending) {}

  /// Those of two leaves, from the entry in `slot` (Outcome::none: from none).
  void hold(const Node& a, const Node& b, std::size_t slot) {
    if (is_large(a, b)) [[unlikely]] {
      const Portions done =
          in_portions(a_, b_, query_, counter_, workspace_, front_, a, b, slot, enough_);
      enough_ = done.enough;
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

  /// Whether to flush now.
  bool full() const {
    return enough_ || pending_.size() > std::max<std::size_t>(Query::buffer_size, F::held_at_least);
  }

  /// Tests what is held and says whether the query has had enough. Where that was so of two large
  /// leaves, nothing is tested: what came after them is to be looked at next time.
  bool flush() {
    if (!enough_) return test();
    for (const Candidate& candidate : pending_)
      if (candidate.slot != Outcome::none) front_.stays(candidate.slot, Seen::not_yet, 0);
    pending_.clear();
    return true;
  }

  /// Pairs of primitives tested.
  std::size_t tested() const { return triangles_; }
  /// The slot of what is worth testing first next time, or Outcome::none.
  std::size_t witness() const { return witness_; }
  void forget_witness() { witness_ = Outcome::none; }

 private:
  static constexpr std::size_t portion = 512;

  struct Portions {
    bool enough;
    std::size_t triangles, witness;
  };

  /// Tests all that is held, then the triangles of two leaves until the query has had enough. By
  /// an object of its own, so that the other one need not stay in memory for what is so rare.
  [[gnu::noinline]] static Portions in_portions(Body<V>& body_a, Body<V>& body_b, Query& query,
                                                Counter& counter, Workspace& workspace, F& front,
                                                const Node& a, const Node& b, std::size_t slot,
                                                bool enough) {
    HeldPrimitives own(body_a, body_b, query, counter, workspace, front);
    enough = enough || own.test();
    for (std::uint32_t i = a.first; i < a.first + a.count && !enough; ++i)
      for (std::uint32_t j = b.first; j < b.first + b.count && !enough; ++j) {
        own.hold_pair(i, j, slot);
        if (own.pending_.size() == portion) enough = own.test();
      }
    enough = enough || own.test();
    if (enough && slot != Outcome::none) front.stays(slot, Seen::not_yet, 0);
    return {enough, own.triangles_, own.witness_};
  }

  void hold_pair(std::uint32_t i, std::uint32_t j, std::size_t slot) {
    pending_.push_back({&a_.triangle(i), &b_.triangle(j), a_.hierarchy().primitive(i),
                        b_.hierarchy().primitive(j), slot});
  }

  // Small in most fronts, and the whole traversal stays in registers if it is inlined.
  [[gnu::always_inline]] bool test() {
    if (pending_.empty()) return false;
    const Outcome outcome = front_.primitives(query_, pending_, workspace_);
    if (outcome.witness != Outcome::none) witness_ = pending_[outcome.witness].slot;
    const std::size_t tested = outcome.enough ? outcome.witness + 1 : pending_.size();
    triangles_ += tested;
    counter_.primitives(tested);
    pending_.clear();
    return outcome.enough;
  }

  Body<V>& a_;
  Body<V>& b_;
  Query& query_;
  Counter& counter_;
  Workspace& workspace_;
  F& front_;
  std::vector<Candidate>& pending_;
  bool enough_ = false;  // the query has had enough of two large leaves
  std::size_t triangles_ = 0;
  std::size_t witness_ = Outcome::none;
};

}  // namespace bvlab
