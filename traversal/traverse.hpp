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

#include "traversal/first_bound.hpp"
#include "traversal/no_front.hpp"
#include "traversal/traversal_steps.hpp"

namespace bvlab {

/// One run. What is public is for fronts to sweep with; a bool says whether the query has had
/// enough. B is the scalar or batch, of W lanes, that volumes are tested in.
template <class B, class V, class Query, class Counter, class Front>
class Traversal : public TraversalSteps<B, V, Query, Counter, Front> {
  using Steps = TraversalSteps<B, V, Query, Counter, Front>;
  using Steps::front_, Steps::open_, Steps::batch_, Steps::held_, Steps::query_, Steps::tests_;

 public:
  using Steps::Steps, Steps::W, Steps::a, Steps::b, Steps::culled, Steps::flush;
  using typename Steps::Node;

  TraversalStatistics run() {
    bool enough = wants_bound<Query>() && !front_.witnessed() && find_first_bound(*this);
    enough = enough || front_.sweep(*this);
    while (!open_.empty() && !enough) enough = look_at_open();
    enough = enough || flush();
    while (!open_.empty()) front_.add(open_.pop(), Seen::not_yet, 0);
    front_.finish(held_.witness(), enough);
    return {!enough, tests_, held_.tested()};
  }

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

  /// A pair that is no entry has been looked at and was not culled.
  void enter(const NodePair& pair) {
    open_.reserve(4);
    batch_.put(0, pair);
    open_up(0, added(), [](std::size_t) {});
  }

 private:
  template <class Slot>
  bool look_at_entries(std::size_t count, Slot&& slot) {
    const std::uint64_t mask = culled(count, [&](std::size_t i) { return front_[slot(i)]; });
    return look(
        count, mask,
        [&](std::size_t i, Seen seen, double gap) {
          front_.stays(slot(i), seen, gap);
          return static_cast<std::size_t>(slot(i));
        },
        [&](std::size_t i) { front_.open(slot(i)); });
  }

  bool look_at_open() {
    const std::size_t count = std::min(W, open_.size());
    for (std::size_t i = 0; i < count; ++i) batch_.put(i, open_.pop());
    return look(count, this->test(count), added(), [](std::size_t) {});
  }

  auto added() {
    return
        [this](std::size_t i, Seen seen, double gap) { return front_.add(batch_[i], seen, gap); };
  }

  /// `keep` makes the pair in a lane an entry, or leaves it one, and says in which slot; `replace`
  /// is told that it is none.
  template <class Keep, class Replace>
  [[gnu::always_inline]] bool look(std::size_t count, std::uint64_t culled, Keep&& keep,
                                   Replace&& replace) {
    open_.reserve(4 * W);
    for (std::uint64_t rest = culled; rest; rest &= rest - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(rest));
      const NodePair pair = batch_[i];
      if (front_.opens(query_, a().node(pair.a), b().node(pair.b), batch_.gap(i)))
        culled &= ~(std::uint64_t{1} << i);
      else
        keep(i, Seen::culled, batch_.gap(i));
    }
    batch_.template for_each_near<Query>(~culled & batch_.all(count),
                                         [&](std::size_t i) { open_up(i, keep, replace); });
    return held_.full() && flush();
  }

  /// Of two leaves the primitives are held; any others are replaced.
  template <class Keep, class Replace>
  [[gnu::always_inline]] void open_up(std::size_t i, Keep&& keep, Replace&& replace) {
    const NodePair pair = batch_[i];
    const Node &a = this->a().node(pair.a), &b = this->b().node(pair.b);
    if (a.count && b.count) {
      held_.hold(a, b, keep(i, Seen::near, 0));
    } else {
      replace(i);
      this->descend(pair, a, b);
    }
  }
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
