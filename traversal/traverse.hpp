// SPDX-License-Identifier: BSD-3-Clause
/// The loop: pairs of nodes are tested W at a time; a pair that the query culls is an end, a
/// pair of leaves hands its primitives to the query, any other is replaced by two pairs, the larger
/// node being descended, or by the four pairs of all children.
///
/// Started from the two roots it is the recursive algorithm, depth first up to W - 1 pairs; started
/// from a front it visits the front's entries in order and keeps the front up to date (one that can
/// rise is raised first); from a front with margins only those entries that have to be looked at.
/// Volume, query, counter, width and what is kept are template parameters; nothing here knows
/// which.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "traversal/body.hpp"
#include "traversal/fronts.hpp"
#include "traversal/gather.hpp"
#include "traversal/queries/candidate.hpp"

namespace bvlab {

/// A query says which pairs of volumes need no further look, and takes the primitives of the rest.
///   culls(p, q)           a mask over posed volumes p of body a and q of body b; where no bound is
///                         wanted, a matter of the volumes alone
///   primitives(pending)   takes one candidate or more; says whether the traversal can end
///   buffer_size           the most candidates that are held back before `primitives` is called
///   wants_bound           if there and true: one pair of near leaves is handed over first, near
///                         pairs are looked at before far ones, and `culls(gap)` says the same
/// The bvlab program makes it by `asked(options)` and takes `answer()`, true or false or a number;
/// or makes it by `asked(options, found)`, and it appends pairs of primitives to `found`. And for
/// strategies that keep margins:
///   primitives(pending, verdicts)   the same, saying of each candidate what was found
///   limit()                         surfaces farther apart than this matter to the query no more
///   known(a, b)                     two triangles still share a point; says whether that is enough
template <class Q, class P>
concept Query = requires(Q query, const P& p, std::span<const Candidate> pending) {
  { Q::name } -> std::convertible_to<std::string_view>;
  { Q::description } -> std::convertible_to<std::string_view>;
  query.culls(p, p);
  { query.primitives(pending) } -> std::same_as<Outcome>;
  { Q::buffer_size } -> std::convertible_to<std::size_t>;
};

template <class Q>
constexpr bool wants_bound() {
  if constexpr (requires { Q::wants_bound; }) return Q::wants_bound;
  return false;
}

/// Pairs waiting to be tested, last in, first out: `reserve` once, then `push` without a check.
class OpenPairs {
 public:
  void clear() { size_ = 0; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  /// Makes room for this number of further entries.
  void reserve(std::size_t more) {
    if (pairs_.size() < size_ + more) pairs_.resize(2 * (size_ + more));
  }
  void push(const NodePair& pair) {
    pairs_[size_++] = static_cast<std::uint64_t>(pair.b) << 32 | pair.a;
  }
  NodePair pop() {
    const std::uint64_t pair = pairs_[--size_];
    return {static_cast<std::uint32_t>(pair), static_cast<std::uint32_t>(pair >> 32)};
  }

 private:
  // Each pair is written as it is read, at once: a read that spans two writes waits until both
  // have reached the cache, and so for all volumes posed before.
  std::vector<std::uint64_t> pairs_;
  std::size_t size_ = 0;
};

/// Room that is used again from one traversal to the next.
struct Workspace {
  OpenPairs open;
  std::vector<Candidate> pending;
  std::vector<Verdict> verdicts;
  std::vector<std::uint32_t> due;
  std::vector<SiblingPair> sibling_pairs;
};

namespace detail {

/// Which pairs of volumes the query culls, as bits; the gaps to `gaps` where they are wanted.
template <bool kGaps, class P, class Query, class T>
[[gnu::always_inline]] inline std::uint64_t excluded(const P& p, const P& q, Query& query,
                                                     [[maybe_unused]] T* gaps) {
  if constexpr (kGaps) {
    const auto apart = gap(p, q);
    if constexpr (Batched<std::remove_const_t<decltype(apart)>>)
      apart.copy_to(gaps, stdx::element_aligned);
    else
      gaps[0] = apart;
    if constexpr (wants_bound<Query>()) return bits(query.culls(apart));
  }
  return bits(query.culls(p, q));
}

/// The same by itself, so that it is compiled once for all strategies and counters.
template <bool kGaps, class P, class Query, class T>
[[gnu::noinline]] std::uint64_t excluded_one(const P& p, const P& q, Query& query, T* gaps) {
  return excluded<kGaps>(p, q, query, gaps);
}
template <class P>
[[gnu::noinline]] auto gap_between(const P& p, const P& q) {
  return gap(p, q);
}

/// And of as many nodes as there are lanes.
template <class Some, bool kGaps, class P, class Query, class T>
[[gnu::noinline]] std::uint64_t excluded_of(const P* a, const std::uint32_t* nodes_a, const P* b,
                                            const std::uint32_t* nodes_b, Query& query, T* gaps) {
  return excluded<kGaps>(gather<Some>(a, nodes_a), gather<Some>(b, nodes_b), query, gaps);
}

template <class B, class V, class Query, class Counter, class FrontPolicy>
class Traversal {
  static constexpr int W = width<B>();
  using Node = typename Hierarchy<V>::Node;

 public:
  Traversal(Body<V>& a, Body<V>& b, Query& query, Counter& counter, FrontPolicy front_policy,
            Workspace& workspace)
      : a_(a),
        b_(b),
        query_(query),
        counter_(counter),
        front_policy_(front_policy),
        workspace_(workspace),
        open_(workspace.open),
        pending_(workspace.pending),
        verdicts_(workspace.verdicts),
        due_(workspace.due),
        sibling_pairs_(workspace.sibling_pairs) {}

  /// From the roots where no front is kept, or from what is below them.
  TraversalStatistics run(Start start = Start::roots) {
    open_.clear();
    pending_.clear();
    bool stopped = false;
    if constexpr (wants_bound()) stopped = find_bound();
    if constexpr (FrontPolicy::margins) {
      stopped = stopped || sweep_due();
    } else if constexpr (FrontPolicy::kept) {
      stopped = stopped || sweep();
    } else if (start == Start::below_roots) {
      open_.reserve(4);
      enter<false>({0, 0}, Outcome::none);
    } else {
      a_.require(0, counter_);
      b_.require(0, counter_);
      open_.reserve(1);
      open_.push({0, 0});
    }
    while (!open_.empty() && !stopped) stopped = look_at<false>(take_open(), 0);
    stopped = stopped || flush_unless_enough();
    if constexpr (FrontPolicy::kept) {
      // What was pushed but not reached stays to be looked at next time.
      while (!open_.empty()) front_policy_.front.add(open_.pop());
      if (witness_ != Outcome::none) front_policy_.front.bring_forward(witness_);
      if constexpr (FrontPolicy::margins)
        if (stopped) front_policy_.front.leave_rest();
    }
    statistics_.everything = !stopped;
    return statistics_;
  }

 private:
  static constexpr bool wants_bound() { return bvlab::wants_bound<Query>(); }

  static constexpr bool keeps_gaps() { return FrontPolicy::margins || wants_bound(); }

  /// All entries of the front, the witness by itself.
  bool sweep() requires FrontPolicy::kept {
    bool stopped = false;
    std::size_t next = 0, end = front_policy_.front.size();
    if constexpr (FrontPolicy::rises) {
      if (front_policy_.front.witnessed() && (look_at<true>(take_front(0, 1), 0) || flush()))
        return true;
      end = raise();
      next = front_policy_.front.witnessed();
    }
    while (next < end && !stopped) {
      const int count = take_front(next, end);
      stopped =
          look_at<true>(count, next) || (next == 0 && front_policy_.front.witnessed() && flush());
      next += static_cast<std::size_t>(count);
      while (open_.size() >= W && !stopped) stopped = look_at<false>(take_open(), 0);
    }
    return stopped;
  }

  /// Tries the parents that the front proposes and, where one is apart, its parent after it. Says
  /// how many entries are still to be looked at: they come first, those just raised last.
  std::size_t raise() requires FrontPolicy::rises {
    front_policy_.front.propose(a_.hierarchy(), b_.hierarchy(), sibling_pairs_);
    for (std::size_t next = 0; next < sibling_pairs_.size();) {
      const int count = static_cast<int>(std::min<std::size_t>(W, sibling_pairs_.size() - next));
      for (int i = 0; i < count; ++i) {
        const NodePair& pair = sibling_pairs_[next + static_cast<std::size_t>(i)].parent;
        nodes_a_[i] = pair.a, nodes_b_[i] = pair.b;
        a_.require(pair.a, counter_);
        b_.require(pair.b, counter_);
      }
      count_tests(static_cast<std::size_t>(count));
      std::uint64_t apart = test(count);
      for (int i = 0; i < count; ++i, ++next, apart >>= 1)
        if (apart & 1)
          front_policy_.front.raise(a_.hierarchy(), b_.hierarchy(), sibling_pairs_, next);
        else
          front_policy_.front.refuse(sibling_pairs_[next]);
    }
    const std::size_t raised = front_policy_.front.settle(sibling_pairs_);
    if (!front_policy_.front.witnessed()) witness_ = Outcome::none;
    return front_policy_.front.size() - raised;
  }

  /// The entries whose deadlines have passed, the witness first where it is one of them or a bound
  /// is wanted.
  bool sweep_due() requires FrontPolicy::margins {
    const double now = front_policy_.clock.now();
    const std::uint32_t witness = front_policy_.front.witness();
    const bool first = front_policy_.front.witnessed() &&
                       (wants_bound() || !(front_policy_.front.deadline(witness) > now));
    if (first) {
      const NodePair& pair = front_policy_.front[witness];
      const Node &a = a_.hierarchy().node(pair.a), &b = b_.hierarchy().node(pair.b);
      if (front_policy_.front.take_brief_look() && hits_still(a, b, witness)) return true;
      hold(a, b, witness);
      if (flush_unless_enough()) return true;
    }
    auto& due = due_;
    front_policy_.front.collect(now + query_.limit(), due);
    // It has its new deadline; where that has passed already, the front must go on to say so.
    const bool still_due = first && std::erase(due, witness) > 0;
    bool stopped = false;
    for (std::size_t next = 0; next < due.size() && !stopped;) {
      const int count = take_front(next, due.size());
      stopped = look_at<true>(count, next);
      next += static_cast<std::size_t>(count);
      while (open_.size() >= W && !stopped) stopped = look_at<false>(take_open(), 0);
    }
    if (still_due) front_policy_.front.leave_rest();
    return stopped;
  }

  /// Whether a witness that never lasts long is one still, found without its margin, which is as
  /// expensive as ten such looks.
  bool hits_still(const Node& a, const Node& b,
                  std::uint32_t witness) requires FrontPolicy::margins {
    if constexpr (Query::one_hit_is_enough && !wants_bound()) {
      if (std::size_t{a.count} * b.count > portion) return false;
      hold(a, b, witness);
      const Outcome outcome = query_.primitives(pending_);
      if (outcome.enough) {
        // Known to bodies that stay where they are; when they have moved it is looked at again.
        const Candidate& hit = pending_[outcome.witness];
        front_policy_.front.add_hit(witness, MarginFront::passed, hit.a, hit.b);
        witness_ = witness;
      }
      count_primitives(outcome);
      return outcome.enough;
    }
    return false;
  }

  /// The slot of the i-th entry of this sweep.
  std::size_t slot_of(std::size_t i) const {
    if constexpr (FrontPolicy::margins)
      return due_[i];
    else
      return i;
  }

  /// Goes down to one pair of leaves, always to the nearer child, and hands their primitives over.
  /// Not where a witness of the last run does that better.
  bool find_bound() {
    if constexpr (FrontPolicy::kept)
      if (front_policy_.front.witnessed()) return false;
    a_.require(0, counter_);
    b_.require(0, counter_);
    NodePair pair{0, 0};
    while (true) {
      const Node& a = a_.hierarchy().node(pair.a);
      const Node& b = b_.hierarchy().node(pair.b);
      if (a.count && b.count) {
        hold(a, b, Outcome::none);
        return flush_unless_enough();
      }
      count_tests(2);
      if (descends_b(a, b)) {
        b_.require(b.first, counter_);
        pair.b = b.first + (gap_of(pair.a, b.first + 1) < gap_of(pair.a, b.first));
      } else {
        a_.require(a.first, counter_);
        pair.a = a.first + (gap_of(a.first + 1, pair.b) < gap_of(a.first, pair.b));
      }
    }
  }

  auto gap_of(std::uint32_t a, std::uint32_t b) const {
    return gap_between(a_.volumes()[a], b_.volumes()[b]);
  }

  int take_open() {
    const int count = static_cast<int>(std::min<std::size_t>(W, open_.size()));
    for (int i = 0; i < count; ++i) {
      const NodePair pair = open_.pop();
      nodes_a_[i] = pair.a, nodes_b_[i] = pair.b;
    }
    return count;
  }

  int take_front(std::size_t next, std::size_t end) requires FrontPolicy::kept {
    // A witness is tested by itself: most often it settles the matter, or most of it.
    const bool alone = !FrontPolicy::margins && next == 0 && front_policy_.front.witnessed();
    const std::size_t most = alone ? 1 : W;
    const int count = static_cast<int>(std::min(most, end - next));
    for (int i = 0; i < count; ++i) {
      const NodePair pair = front_policy_.front[slot_of(next + static_cast<std::size_t>(i))];
      nodes_a_[i] = pair.a, nodes_b_[i] = pair.b;
      a_.require(pair.a, counter_);
      b_.require(pair.b, counter_);
    }
    return count;
  }

  /// Tests the pairs taken; says whether the query has had enough.
  template <bool kFromFront>
  bool look_at(int count, std::size_t first) {
    count_tests(static_cast<std::size_t>(count));
    open_.reserve(4 * W);
    std::uint64_t excluded = test(count);
    if constexpr (FrontPolicy::margins) excluded &= ~worth_opening(excluded);
    if constexpr (FrontPolicy::kept && (FrontPolicy::margins || !kFromFront))
      for (std::uint64_t rest = excluded; rest; rest &= rest - 1) {
        const int i = std::countr_zero(rest);
        if constexpr (!FrontPolicy::margins) {
          front_policy_.front.add({nodes_a_[i], nodes_b_[i]});
        } else {
          const double deadline = front_policy_.clock.deadline(static_cast<double>(gaps_[i]));
          if constexpr (kFromFront)
            front_policy_.front.expire_at(slot_of(first + static_cast<std::size_t>(i)), deadline);
          else
            front_policy_.front.add({nodes_a_[i], nodes_b_[i]}, deadline);
        }
      }
    for_each_near(~excluded & all(count), [&](std::size_t i) {
      const NodePair pair{nodes_a_[i], nodes_b_[i]};
      [[maybe_unused]] std::size_t slot = Outcome::none;
      if constexpr (kFromFront) slot = slot_of(first + i);
      enter<kFromFront>(pair, slot);
    });
    // Margins are found for a batch at once.
    constexpr std::size_t buffer_size =
        std::max<std::size_t>(Query::buffer_size, FrontPolicy::margins ? 7 : 0);
    return (enough_ || pending_.size() > buffer_size) && flush_unless_enough();
  }

  /// A pair that is not excluded: its triangles are held, or it is descended.
  template <bool kFromFront>
  [[gnu::always_inline]] void enter(const NodePair& pair, std::size_t slot) {
    const Node& a = a_.hierarchy().node(pair.a);
    const Node& b = b_.hierarchy().node(pair.b);
    if (a.count && b.count) {
      if constexpr (FrontPolicy::kept && !kFromFront) slot = add_leaves(pair);
      hold(a, b, slot);
    } else {
      if constexpr (kFromFront) front_policy_.front.open(slot);
      descend(pair, a, b);
    }
  }

  /// The lanes of a mask in the order in which they are to be descended: where a bound is wanted
  /// the nearest last, so that it is the first to be looked at.
  template <class Open>
  [[gnu::always_inline]] void for_each_near(std::uint64_t mask, Open&& open) const {
    if constexpr (!wants_bound()) {
      for (; mask; mask &= mask - 1) open(static_cast<std::size_t>(std::countr_zero(mask)));
    } else {
      std::array<std::uint8_t, W> order;
      std::size_t count = 0;
      for (; mask; mask &= mask - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(mask));
        std::size_t at = count++;
        for (; at > 0 && gaps_[order[at - 1]] < gaps_[lane]; --at) order[at] = order[at - 1];
        order[at] = static_cast<std::uint8_t>(lane);
      }
      for (std::size_t k = 0; k < count; ++k) open(order[k]);
    }
  }

  static constexpr std::uint64_t all(int count) { return (std::uint64_t{2} << (count - 1)) - 1; }

  std::uint64_t test(int count) {
    // A pair by itself is not worth a batch, and four are not worth a wide one.
    if constexpr (W > 4)
      if (count > 1 && count <= 4) return test_as<Batch<Element<B>, 4>>(count);
    if constexpr (W > 1)
      if (count > 1) return test_as<B>(count);
    return excluded_one<keeps_gaps()>(a_.volumes()[nodes_a_[0]], b_.volumes()[nodes_b_[0]], query_,
                                      gaps_.data());
  }

  template <class Some>
  std::uint64_t test_as(int count) {
    for (int i = count; i < width<Some>(); ++i)
      nodes_a_[i] = nodes_a_[0], nodes_b_[i] = nodes_b_[0];
    return excluded_of<Some, keeps_gaps()>(a_.volumes(), nodes_a_.data(), b_.volumes(),
                                           nodes_b_.data(), query_, gaps_.data()) &
           all(count);
  }

  /// Which of the pairs that need no further look are given one all the same, for wider gaps.
  ///
  /// An entry that has a gap of g to spare costs a test in g / step runs, or in every run. One of
  /// two inner nodes that is opened costs two such entries, whose gaps are wider by about a quarter
  /// of the size of the node opened; one of two leaves, whose triangles are as expensive as
  /// `triangle_cost` volumes, is farther from them by about half of both sizes. And all this does
  /// not pay for itself where gaps last for many runs anyway.
  std::uint64_t worth_opening(std::uint64_t excluded) const requires FrontPolicy::margins {
    constexpr double triangle_cost = 3, leaf_gain = 0.5, inner_gain = 0.25, long_enough = 4;
    const double step = front_policy_.step, limit = query_.limit();
    std::uint64_t opened = 0;
    for (std::uint64_t rest = excluded; rest; rest &= rest - 1) {
      const int i = std::countr_zero(rest);
      const auto& a = a_.hierarchy().node(nodes_a_[i]);
      const auto& b = b_.hierarchy().node(nodes_b_[i]);
      const double spare = static_cast<double>(gaps_[i]) - limit;
      const bool leaves = a.count && b.count;
      const double wider = leaves ? leaf_gain * static_cast<double>(a.size + b.size)
                                  : inner_gain * static_cast<double>(std::max(a.size, b.size));
      const double cost = leaves ? 1 + triangle_cost : 2;
      const bool gains = spare < long_enough * step && cost * std::max(spare, step) < spare + wider;
      opened |= std::uint64_t{gains} << i;
    }
    return opened;
  }

  void count_tests(std::size_t tests) {
    statistics_.volumes += tests;
    counter_.tested(tests);
  }

  static bool descends_b(const Node& a, const Node& b) {
    return a.count || (!b.count && b.size > a.size);
  }

  std::size_t add_leaves(const NodePair& pair) requires FrontPolicy::kept {
    // With margins, the deadline is set when the triangles have been tested.
    if constexpr (FrontPolicy::margins)
      return front_policy_.front.add(pair, std::numeric_limits<double>::infinity());
    else
      return front_policy_.front.add(pair);
  }

  void descend(const NodePair& pair, const Node& a, const Node& b) {
    if (FrontPolicy::descends_both && !a.count && !b.count) {
      a_.require(a.first, counter_);
      b_.require(b.first, counter_);
      open_.push({a.first + 1, b.first + 1});
      open_.push({a.first + 1, b.first});
      open_.push({a.first, b.first + 1});
      open_.push({a.first, b.first});
    } else {
      const bool second = descends_b(a, b);
      const std::uint32_t first = second ? b.first : a.first;
      (second ? b_ : a_).require(first, counter_);
      open_.push(second ? NodePair{pair.a, first + 1} : NodePair{first + 1, pair.b});
      open_.push(second ? NodePair{pair.a, first} : NodePair{first, pair.b});
    }
  }

  /// The triangles of two leaves, to be tested with others; by themselves, `portion` at a time,
  /// where they are too many to be held at once.
  void hold(const Node& a, const Node& b, std::size_t slot) {
    if (std::size_t{a.count} * b.count > portion) [[unlikely]] {
      const Portions done =
          in_portions(a_, b_, query_, counter_, front_policy_, workspace_, a, b, slot, enough_);
      enough_ = done.enough;
      statistics_.triangles += done.triangles;
      if (done.witness != Outcome::none) witness_ = done.witness;
      return;
    }
    for (std::uint32_t i = a.first; i < a.first + a.count; ++i)
      for (std::uint32_t j = b.first; j < b.first + b.count; ++j) hold_pair(i, j, slot);
  }

  void hold_pair(std::uint32_t i, std::uint32_t j, std::size_t slot) {
    pending_.push_back({&a_.triangle(i), &b_.triangle(j), a_.hierarchy().primitive(i),
                        b_.hierarchy().primitive(j), slot});
  }

  struct Portions {
    bool enough;
    std::size_t triangles, witness;
  };

  /// Tests all that is held, then the triangles of two leaves until the query has had enough. By
  /// a traversal of its own, so that no other one has to stay in memory for what is so rare.
  [[gnu::noinline]] static Portions in_portions(Body<V>& body_a, Body<V>& body_b, Query& query,
                                                Counter& counter, FrontPolicy front_policy,
                                                Workspace& workspace, const Node& a, const Node& b,
                                                std::size_t slot, bool enough) {
    Traversal own(body_a, body_b, query, counter, front_policy, workspace);
    enough = enough || own.flush();
    float deadline = std::numeric_limits<float>::infinity();
    const auto test = [&] {
      enough = own.flush();
      // Each portion gives the entry a deadline of its own; the first of them counts.
      if constexpr (FrontPolicy::margins)
        if (slot != Outcome::none) deadline = std::min(deadline, front_policy.front.deadline(slot));
    };
    for (std::uint32_t i = a.first; i < a.first + a.count && !enough; ++i)
      for (std::uint32_t j = b.first; j < b.first + b.count && !enough; ++j) {
        own.hold_pair(i, j, slot);
        if (own.pending_.size() == portion) test();
      }
    if (!enough && !own.pending_.empty()) test();
    if constexpr (FrontPolicy::margins)
      if (slot != Outcome::none)
        front_policy.front.expire_at(slot, enough ? MarginFront::passed : deadline);
    return {enough, own.statistics_.triangles, own.witness_};
  }

  /// Tests what is held; nothing where the query has had enough of two leaves by themselves: what
  /// came after them is to be looked at next time.
  bool flush_unless_enough() {
    if (!enough_) return flush();
    if constexpr (FrontPolicy::margins)
      for (const Candidate& candidate : pending_)
        if (candidate.slot != Outcome::none)
          front_policy_.front.expire_at(candidate.slot, MarginFront::passed);
    pending_.clear();
    return true;
  }

  // Small without margins, and the whole traversal stays in registers if it is inlined.
  [[gnu::always_inline]] bool flush() {
    if (pending_.empty()) return false;
    if constexpr (FrontPolicy::margins) {
      return flush_with_margins();
    } else {
      const Outcome outcome = query_.primitives(pending_);
      if (outcome.witness != Outcome::none) witness_ = pending_[outcome.witness].slot;
      count_primitives(outcome);
      return outcome.enough;
    }
  }

  bool flush_with_margins() requires FrontPolicy::margins {
    verdicts_.assign(pending_.size(), {});
    const Outcome outcome = query_.primitives(pending_, verdicts_);
    settle();
    if (outcome.witness != Outcome::none) {
      witness_ = pending_[outcome.witness].slot;
      front_policy_.front.expect(verdicts_[outcome.witness].margin < lasting * front_policy_.step);
    }
    count_primitives(outcome);
    return outcome.enough;
  }

  void count_primitives(const Outcome& outcome) {
    const std::size_t tested = outcome.enough ? outcome.witness + 1 : pending_.size();
    statistics_.triangles += tested;
    counter_.primitives(tested);
    pending_.clear();
  }

  /// A pair of leaves is next looked at when the first of its verdicts can change.
  void settle() requires FrontPolicy::margins {
    for (std::size_t first = 0; first < pending_.size();) {
      const std::size_t slot = pending_[first].slot;
      double least = std::numeric_limits<double>::infinity();
      std::size_t i = first;
      for (; i < pending_.size() && pending_[i].slot == slot; ++i) {
        const Verdict& verdict = verdicts_[i];
        least = std::min(least, verdict.margin);
        if (verdict.hit && slot != Outcome::none)
          front_policy_.front.add_hit(slot, front_policy_.clock.deadline(verdict.margin),
                                      pending_[i].a, pending_[i].b);
      }
      if (slot != Outcome::none)
        front_policy_.front.expire_at(
            slot, least < 0 ? MarginFront::passed : front_policy_.clock.deadline(least));
      first = i;
    }
  }

  /// Two leaves with more candidates are tested by themselves, `portion` at a time.
  static constexpr std::size_t portion = 512;
  bool enough_ = false;  // the query has had enough of two such leaves

  static constexpr double lasting = 8;  // runs for which a witness is worth its margin

  Body<V>& a_;
  Body<V>& b_;
  Query& query_;
  Counter& counter_;
  FrontPolicy front_policy_;
  Workspace& workspace_;
  OpenPairs& open_;
  std::vector<Candidate>& pending_;
  std::vector<Verdict>& verdicts_;
  std::vector<std::uint32_t>& due_;          // slots to be looked at, where margins are kept
  std::vector<SiblingPair>& sibling_pairs_;  // siblings tried, where the front rises
  std::array<std::uint32_t, W> nodes_a_, nodes_b_;
  std::array<Element<B>, keeps_gaps() ? W : 0> gaps_;
  TraversalStatistics statistics_;
  std::size_t witness_ = Outcome::none;
};

}  // namespace detail

/// Runs the query over two bodies from their roots. B is the scalar or batch that volumes are
/// tested in. Says whether everything was seen: false where the query stopped it.
template <class B, class Roots = NoFront, class V, class Query, class Counter>
TraversalStatistics traverse_from_roots(Body<V>& a, Body<V>& b, Query& query, Counter& counter,
                                        Workspace& workspace, Start start = Start::roots) {
  return detail::Traversal<B, V, Query, Counter, Roots>(a, b, query, counter, {}, workspace)
      .run(start);
}

/// The same from a front, which is kept up to date: it never shrinks, and stays a partition also
/// when the query stops the traversal. The entry at which it stopped is the first one then.
template <class B, class V, class Query, class Counter>
TraversalStatistics traverse(Body<V>& a, Body<V>& b, Query& query, Counter& counter,
                             Workspace& workspace, Front& front) {
  return detail::Traversal<B, V, Query, Counter, KeptFront>(a, b, query, counter, {{}, front},
                                                            workspace)
      .run();
}

/// The same from a front that rises where it can, which the strategy decides: parents are tried
/// when the witness has been looked at and did not settle the matter, before all other entries.
template <class B, class V, class Query, class Counter>
TraversalStatistics traverse(Body<V>& a, Body<V>& b, Query& query, Counter& counter,
                             Workspace& workspace, RisingFront& front) {
  return detail::Traversal<B, V, Query, Counter, KeptRising>(a, b, query, counter, {{}, front},
                                                             workspace)
      .run();
}

/// The same from a front with margins: looks at the entries whose deadlines have passed, and gives
/// them new ones.
template <class B, class V, class Query, class Counter>
TraversalStatistics traverse(Body<V>& a, Body<V>& b, Query& query, Counter& counter,
                             Workspace& workspace, const KeptMargins& margins) {
  return detail::Traversal<B, V, Query, Counter, KeptMargins>(a, b, query, counter, margins,
                                                              workspace)
      .run();
}

}  // namespace bvlab
