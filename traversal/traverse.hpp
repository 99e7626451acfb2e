// SPDX-License-Identifier: BSD-3-Clause
/// The loop: pairs of nodes are tested W at a time; a pair that the query culls is an end, a pair
/// of leaves hands its primitives to the query, any other is replaced by two pairs, or by four.
///
/// Started from the two roots it is the recursive algorithm, depth first up to W - 1 pairs; else it
/// visits entries of a front, as the front wants, and keeps it up to date. Volume, query, counter,
/// width and front are template parameters; nothing here knows which.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <type_traits>

#include "traversal/descent.hpp"
#include "traversal/first_bound.hpp"
#include "traversal/held_primitives.hpp"
#include "traversal/no_front.hpp"
#include "traversal/pair_batch.hpp"

namespace bvlab {

/// One run. What is public is for fronts to sweep with; a bool says whether the query has had
/// enough. B is the scalar or batch, of W lanes, that volumes are tested in.
template <class B, class V, class QueryType, class Counter, class Front>
class Traversal {
 public:
  using Query = QueryType;
  using Node = typename Hierarchy<V>::Node;
  static constexpr std::size_t W = width<B>();

  Traversal(Body<V>& a, Body<V>& b, Query& query, Counter& counter, Workspace& workspace,
            Front& front)
      : a_(a.hierarchy()),
        b_(b.hierarchy()),
        query_(query),
        workspace_(workspace),
        front_(front),
        open_(workspace.open),
        held_(a, b, query, counter, workspace, front),
        batch_(a, b, counter) {}

  TraversalStatistics run() {
    open_.clear();
    workspace_.pending.clear();
    bool enough = wants_bound<Query>() && !front_.witnessed() && find_first_bound(*this);
    enough = enough || front_.sweep(*this);
    while (!open_.empty() && !enough) enough = look_at_open();
    enough = enough || flush();
    while (!open_.empty()) front_.add(open_.pop(), Seen::not_yet, 0);
    front_.finish(held_.witness(), enough);
    return {!enough, batch_.tests(), held_.tested()};
  }

  const Hierarchy<V>& a() const { return a_; }
  const Hierarchy<V>& b() const { return b_; }
  Query& query() { return query_; }
  Workspace& workspace() { return workspace_; }

  /// Looks at the entries in slots slot(0), slot(1), ..., and below them as far as that fills whole
  /// batches.
  template <class Slot>
  bool look_at(std::size_t count, Slot&& slot) {
    bool enough = false;
    for (std::size_t next = 0, some; next < count && !enough; next += some) {
      some = std::min(W, count - next);
      enough = look_at_entries(some, [&](std::size_t i) { return slot(next + i); });
      enough = enough || fill_batches();
    }
    return enough;
  }
  /// Looks at one entry and tests its primitives: most often a witness settles the matter.
  bool look_at_alone(std::size_t slot) {
    return look_at_entries(1, [slot](std::size_t) { return slot; }) || flush();
  }
  bool fill_batches() {
    bool enough = false;
    while (open_.size() >= W && !enough) enough = look_at_open();
    return enough;
  }

  /// A pair that is no entry: is to be looked at; or has been, and was not culled.
  void push(const NodePair& pair) {
    batch_.require(pair);
    open_.reserve(1);
    open_.push(pair);
  }
  void enter(const NodePair& pair) {
    open_.reserve(4);
    batch_.put(0, pair);
    open_up(0, added(), [](std::size_t) {});
  }
  /// Which of the pairs pair(0), pair(1), ..., at most W, the query culls, as bits; and at most how
  /// far apart the volumes of one are.
  template <class Pair>
  std::uint64_t culled(std::size_t count, Pair&& pair) {
    for (std::size_t i = 0; i < count; ++i) {
      batch_.put(i, pair(i));
      batch_.require(batch_[i]);
    }
    return batch_.culled(count, query_);
  }
  auto gap(const NodePair& pair) { return batch_.gap(pair); }

  /// Holds the primitives of two leaves, from the entry in `slot` if from one; tests what is held.
  void hold(const NodePair& pair, std::size_t slot = Outcome::none) {
    held_.hold(a_.node(pair.a), b_.node(pair.b), slot);
  }
  [[gnu::always_inline]] bool flush() { return held_.flush(); }
  /// Entries are in other slots than when the query last named a witness.
  void forget_witness() { held_.forget_witness(); }

 private:
  template <class Slot>
  bool look_at_entries(std::size_t count, Slot&& slot) {
    const std::uint64_t mask = culled(count, [&](std::size_t i) { return front_[slot(i)]; });
    const auto stays = [&](std::size_t i, Seen seen, double gap) {
      front_.stays(slot(i), seen, gap);
      return static_cast<std::size_t>(slot(i));
    };
    return look(count, mask, stays, [&](std::size_t i) { front_.open(slot(i)); });
  }
  bool look_at_open() {
    const std::size_t count = std::min(W, open_.size());
    for (std::size_t i = 0; i < count; ++i) batch_.put(i, open_.pop());
    return look(count, batch_.culled(count, query_), added(), [](std::size_t) {});
  }
  auto added() {
    return
        [this](std::size_t i, Seen seen, double gap) { return front_.add(batch_[i], seen, gap); };
  }

  /// `keep` makes the pair in a lane an entry, or leaves it one, and says in which slot; `replace`
  /// is told that it is none any more.
  template <class Keep, class Replace>
  [[gnu::always_inline]] bool look(std::size_t count, std::uint64_t culled, Keep&& keep,
                                   Replace&& replace) {
    open_.reserve(4 * W);
    for (std::uint64_t rest = culled; rest; rest &= rest - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(rest));
      if (front_.opens(query_, a_.node(batch_[i].a), b_.node(batch_[i].b), batch_.gap(i)))
        culled &= ~(std::uint64_t{1} << i);
      else
        keep(i, Seen::culled, batch_.gap(i));
    }
    batch_.template for_each_near<Query>(count, culled,
                                         [&](std::size_t i) { open_up(i, keep, replace); });
    return held_.full() && flush();
  }

  /// Of two leaves the primitives are held; any others are replaced.
  template <class Keep, class Replace>
  [[gnu::always_inline]] void open_up(std::size_t i, Keep&& keep, Replace&& replace) {
    const NodePair pair = batch_[i];
    const Node &a = a_.node(pair.a), &b = b_.node(pair.b);
    if (a.count && b.count) return held_.hold(a, b, keep(i, Seen::near, 0));
    replace(i);
    descend(pair, a, b, front_.descent(a, b), batch_, open_);
  }

  const Hierarchy<V>& a_;
  const Hierarchy<V>& b_;
  Query& query_;
  Workspace& workspace_;
  Front& front_;
  OpenPairs& open_;
  HeldPrimitives<V, Query, Counter, Front> held_;
  PairBatch<B, V, Counter, Front::measures_gaps || wants_bound<Query>()> batch_;
};

/// Asks the query of two bodies, from a front, which is kept up to date and stays a partition also
/// where the query ends the run. Says what that cost, and whether everything was seen.
template <class B, class V, class Query, class Counter, class Front>
TraversalStatistics traverse(Body<V>& a, Body<V>& b, Query& query, Counter& counter,
                             Workspace& workspace, Front&& front) {
  using Run = Traversal<B, V, Query, Counter, std::remove_reference_t<Front>>;
  static_assert(TrackedFront<std::remove_cvref_t<Front>, Run>);
  return Run(a, b, query, counter, workspace, front).run();
}

/// The same from the two roots, with nothing kept.
template <class B, class V, class Query, class Counter>
TraversalStatistics traverse_from_roots(Body<V>& a, Body<V>& b, Query& query, Counter& counter,
                                        Workspace& workspace) {
  return traverse<B>(a, b, query, counter, workspace, NoFront());
}

}  // namespace bvlab
