// SPDX-License-Identifier: BSD-3-Clause
/// The recorder of a traversal that starts from a TrackedFront, for the gathered kernel: each lane
/// of a step is an entry of its own. FrontSweep is what a front may call in its sweep.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "traversal/first_bound.hpp"
#include "traversal/tracked_front.hpp"
#include "traversal/traversal.hpp"

namespace bvlab {

/// The lanes of a step are pairs that are no entries yet.
template <class Front>
struct NewEntries {
  Front& front;

  /// Makes the pair in a lane an entry; returns its slot.
  template <class Pairs>
  [[gnu::always_inline]] std::size_t keep(const Pairs& pairs, std::size_t lane, EntryState state,
                                          double gap) const {
    return front.add(pairs[lane], state, gap);
  }
  /// The pair in a lane is replaced by its children.
  static void replace(std::size_t) {}
};

/// The pair in lane i of a step is the entry in slot(i).
template <class Front, class Slot>
struct EntriesInSlots {
  Front& front;
  const Slot& slot;

  template <class Pairs>
  [[gnu::always_inline]] std::size_t keep(const Pairs&, std::size_t lane, EntryState state,
                                          double gap) const {
    front.keep(slot(lane), state, gap);
    return slot(lane);
  }
  void replace(std::size_t lane) const { front.open(slot(lane)); }
};

/// A traversal as a front sees it in its sweep. Members that return bool return whether the query
/// is satisfied.
template <class Traversal>
class FrontSweep {
  using Pair = typename Traversal::Pair;
  using Step = typename Pair::template StepFor<Traversal::wanted>;

 public:
  using Query = typename Traversal::Query;
  using Node = typename Pair::Node;
  static constexpr std::size_t W = Pair::W;  ///< pairs tested at once

  explicit FrontSweep(Traversal& traversal) : traversal_(traversal) {}

  const auto& a() const { return pair().a().tree(); }
  const auto& b() const { return pair().b().tree(); }
  Query& query() const { return traversal_.query(); }
  auto& workspace() const { return traversal_.workspace(); }

  /// Tests the entries in slots slot(0), slot(1), ..., and descends below them as far as that fills
  /// whole batches.
  template <class Slot>
  [[gnu::always_inline]] bool test_entries(std::size_t count, Slot&& slot) {
    bool satisfied = false;
    for (std::size_t next = 0, some; next < count && !satisfied; next += some) {
      some = std::min(W, count - next);
      satisfied = test_batch_of_entries(some, [&](std::size_t i) { return slot(next + i); });
      satisfied = satisfied || fill_batches();
    }
    return satisfied;
  }
  /// Tests one entry, and its primitives without delay: a witness decides most queries.
  bool test_entry(std::size_t slot) {
    return test_batch_of_entries(1, [slot](std::size_t) { return slot; }) || flush();
  }
  /// Takes steps from the open pairs as long as each fills a batch.
  [[gnu::always_inline]] bool fill_batches() {
    bool satisfied = false;
    while (pair().open().size() >= W && !satisfied) satisfied = traversal_.next();
    return satisfied;
  }

  /// Pushes a pair that is no entry; it is tested later.
  void push(const NodePair& nodes) {
    require(nodes);
    pair().open().reserve(1);
    pair().open().push(nodes);
  }
  /// Descends below a pair that is no entry and is known not to be culled.
  void enter(const NodePair& nodes) {
    pair().open().reserve(4);
    Step step;
    step.pairs.put(0, nodes);
    pair().open_up(step.pairs, 0, traversal_.recorder().no_entries(), traversal_.recorder(),
                   traversal_.leaves());
  }

  /// Which of the pairs nodes(0), nodes(1), ..., at most W, the query culls, as bits.
  template <class Nodes>
  std::uint64_t culled(std::size_t count, Nodes&& nodes) {
    Step step = gathered(count, nodes);
    traversal_.count_tests(count);
    return pair().template test<Traversal::wanted>(step, query(), traversal_.counter()).apart;
  }
  /// Of the pairs nodes(0), nodes(1), ..., the one whose volumes are nearest to each other, by
  /// lower bounds on their distances: the first if there are several.
  template <class Nodes>
  NodePair nearest(std::size_t count, Nodes&& nodes) {
    NodePair nearest = nodes(0);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t next = 0, some; next < count; next += some) {
      some = std::min(W, count - next);
      Step step = gathered(some, [&](std::size_t i) { return nodes(next + i); });
      traversal_.count_tests(some);
      pair().template test<Traversal::wanted>(step, query(), traversal_.counter());
      for (std::size_t i = 0; i < some; ++i)
        if (step.pairs.gap(i) < least) least = step.pairs.gap(i), nearest = step.pairs[i];
    }
    return nearest;
  }

  /// `hold` buffers the primitive pairs of two leaves, from the entry in `slot` (Outcome::none: no
  /// entry). `flush` tests the buffer.
  void hold(const NodePair& nodes, std::size_t slot = Outcome::none) {
    traversal_.leaves().hold(a().node(nodes.a), b().node(nodes.b), slot);
  }
  [[gnu::always_inline]] bool flush() { return traversal_.leaves().flush(); }
  /// For sweeps that have moved entries to other slots since the query last named a witness.
  void forget_witness() { traversal_.leaves().forget_witness(); }

 private:
  Pair& pair() const { return traversal_.pair(); }
  void require(const NodePair& nodes) { pair().require(nodes); }

  template <class Nodes>
  [[gnu::always_inline]] Step gathered(std::size_t count, Nodes&& nodes) {
    Step step;
    step.count = count;
    for (std::size_t i = 0; i < count; ++i) {
      step.pairs.put(i, nodes(i));
      require(step.pairs[i]);
    }
    return step;
  }

  template <class Slot>
  [[gnu::always_inline]] bool test_batch_of_entries(std::size_t count, const Slot& slot) {
    auto& front = traversal_.recorder().front();
    Step step = gathered(count, [&](std::size_t i) { return front[slot(i)]; });
    traversal_.visit(step,
                     EntriesInSlots<std::remove_reference_t<decltype(front)>, Slot>{front, slot});
    return traversal_.leaves().test_due();
  }

  Traversal& traversal_;
};

template <class FrontType>
class FrontRecorder {
 public:
  using Front = FrontType;
  static constexpr bool measures_gaps = Front::measures_gaps;

  /// The front is updated and remains a partition even if the query ends the run early.
  explicit FrontRecorder(Front& front) : front_(front) {}

  Front& front() const { return front_; }
  template <class Pair>
  static void begin(Pair&) {}
  bool sweep_is_due() const { return !swept_; }
  template <class Traversal>
  [[gnu::always_inline]] bool sweep(Traversal& traversal) {
    static_assert(TrackedFront<std::remove_const_t<Front>, FrontSweep<Traversal>>);
    swept_ = true;
    FrontSweep<Traversal> sweep(traversal);
    if constexpr (wants_bound<typename Traversal::Query>())
      if (!front_.witnessed() && find_first_bound(sweep)) return true;
    return front_.sweep(sweep);
  }

  NewEntries<Front> no_entries() const { return {front_}; }
  template <class Entries>
  static constexpr std::uint64_t tested(const Entries&) {
    return ~std::uint64_t{0};
  }
  template <class Node>
  Descent descent(const Node& a, const Node& b) const {
    return front_.descent(a, b);
  }

  /// Keeps the lanes that are culled, except those that the front opens nevertheless.
  template <class Pair, class Step, class Entries, class Query>
  [[gnu::always_inline]] std::uint64_t record(Pair& pair, const Step& step, LanesApart found,
                                              std::uint64_t near, const Entries& entries,
                                              Query& query) const {
    // In two loops, since opens() is unpredictable: its result becomes a bit, not a branch.
    std::uint64_t opened = 0;
    for (std::uint64_t rest = found.apart; rest; rest &= rest - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(rest));
      const NodePair nodes = step.pairs[i];
      const bool opens = front_.opens(query, pair.a().tree().node(nodes.a),
                                      pair.b().tree().node(nodes.b), step.pairs.gap(i));
      opened |= std::uint64_t{opens} << i;
    }
    for (std::uint64_t rest = found.apart & ~opened; rest; rest &= rest - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(rest));
      entries.keep(step.pairs, i, EntryState::culled, step.pairs.gap(i));
    }
    return near | opened;
  }

  /// Pairs that were not tested become entries.
  template <class Pair, class Leaves>
  void finish(Pair& pair, const Leaves& leaves, bool satisfied) const {
    while (!pair.done()) front_.add(pair.open().pop(), EntryState::not_yet, 0);
    front_.finish(leaves.witness(), satisfied);
  }

 private:
  Front& front_;
  bool swept_ = false;
};

}  // namespace bvlab
