// SPDX-License-Identifier: BSD-3-Clause
/// The loop: pairs of nodes are tested W at a time; a pair that the query excludes is an end, a
/// pair of leaves hands its primitives to the query, any other is replaced by two pairs, the larger
/// node being descended, or by the four pairs of all children.
///
/// Started from the two roots it is the recursive algorithm, depth first up to W - 1 pairs; started
/// from a front it visits the front's entries in order and keeps the front up to date. Volume,
/// query, counter, width and whether a front is kept are template parameters; nothing here knows
/// which.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "traversal/body.hpp"
#include "traversal/front.hpp"
#include "traversal/gather.hpp"
#include "traversal/queries/candidate.hpp"

namespace bvlab {

/// A query says which pairs of volumes need no further look, and takes the primitives of the rest.
///   excludes(p, q)        a mask over posed volumes p of body a and q of body b
///   primitives(pending)   takes one candidate or more; says whether the traversal can end
///   patience              so many candidates may be held back before `primitives` must be called
///   wants_bound           if there and true: one pair of near leaves is handed over first
template <class Q, class P>
concept Query = requires(Q query, const P& p, std::span<const Candidate> pending) {
  { Q::name } -> std::convertible_to<std::string_view>;
  { Q::description } -> std::convertible_to<std::string_view>;
  query.excludes(p, p);
  { query.primitives(pending) } -> std::same_as<Outcome>;
  { Q::patience } -> std::convertible_to<std::size_t>;
};

/// Pairs waiting to be tested, last in, first out: `reserve` once, then `push` without a check.
class OpenPairs {
 public:
  void clear() { size_ = 0; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  /// Makes room for so many more.
  void reserve(std::size_t more) {
    if (pairs_.size() < size_ + more) pairs_.resize(2 * (size_ + more));
  }
  void push(const NodePair& pair) { pairs_[size_++] = pair; }
  const NodePair& pop() { return pairs_[--size_]; }

 private:
  std::vector<NodePair> pairs_;
  std::size_t size_ = 0;
};

/// Room that is used again from one traversal to the next.
struct Workspace {
  OpenPairs open;
  std::vector<Candidate> pending;
};

/// For `traverse` where no front is kept.
struct NoFront {
  static constexpr bool kept = false, descends_both = false;
};
struct NoFrontBoth : NoFront {
  static constexpr bool descends_both = true;
};
struct KeptFront {
  static constexpr bool kept = true, descends_both = false;
  Front& front;
};

namespace detail {

template <class B, class V, class Query, class Counter, class Keeping>
class Traversal {
  static constexpr int W = width<B>();
  using Node = typename Hierarchy<V>::Node;

 public:
  Traversal(Body<V>& a, Body<V>& b, Query& query, Counter& counter, Keeping keeping,
            Workspace& workspace)
      : a_(a),
        b_(b),
        query_(query),
        counter_(counter),
        keeping_(keeping),
        open_(workspace.open),
        pending_(workspace.pending) {}

  bool run() {
    open_.clear();
    pending_.clear();
    bool stopped = false;
    if constexpr (wants_bound()) stopped = find_bound();
    if constexpr (Keeping::kept) {
      const std::size_t end = keeping_.front.size();
      for (std::size_t next = 0; next < end && !stopped;) {
        const int count = take_front(next, end);
        stopped =
            look_at<true>(count, next) || (next == 0 && keeping_.front.witnessed() && flush());
        next += static_cast<std::size_t>(count);
        while (open_.size() >= W && !stopped) stopped = look_at<false>(take_open(), 0);
      }
    } else {
      a_.require(0, counter_);
      b_.require(0, counter_);
      open_.reserve(1);
      open_.push({0, 0});
    }
    while (!open_.empty() && !stopped) stopped = look_at<false>(take_open(), 0);
    stopped = stopped || flush();
    if constexpr (Keeping::kept) {
      // What was pushed but not reached stays to be looked at next time.
      while (!open_.empty()) keeping_.front.add(open_.pop());
      if (witness_ != Outcome::none) keeping_.front.bring_forward(witness_);
    }
    return !stopped;
  }

 private:
  static constexpr bool wants_bound() {
    if constexpr (requires { Query::wants_bound; }) return Query::wants_bound;
    return false;
  }

  /// Goes down to one pair of leaves, always to the nearer child, and hands their primitives over.
  /// Not where a witness of the last run does that better.
  bool find_bound() {
    if constexpr (Keeping::kept)
      if (keeping_.front.witnessed()) return false;
    a_.require(0, counter_);
    b_.require(0, counter_);
    NodePair pair{0, 0};
    while (true) {
      const Node& a = a_.hierarchy().node(pair.a);
      const Node& b = b_.hierarchy().node(pair.b);
      if (a.count && b.count) {
        hold(a, b, Outcome::none);
        return flush();
      }
      counter_.tested(2);
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
    return gap(a_.volumes()[a], b_.volumes()[b]);
  }

  int take_open() {
    const int count = static_cast<int>(std::min<std::size_t>(W, open_.size()));
    for (int i = 0; i < count; ++i) {
      const NodePair pair = open_.pop();
      nodes_a_[i] = pair.a, nodes_b_[i] = pair.b;
    }
    return count;
  }

  int take_front(std::size_t next, std::size_t end) requires Keeping::kept {
    // A witness is tested by itself: most often it settles the matter, or most of it.
    const std::size_t most = next == 0 && keeping_.front.witnessed() ? 1 : W;
    const int count = static_cast<int>(std::min(most, end - next));
    for (int i = 0; i < count; ++i) {
      const NodePair pair = keeping_.front[next + static_cast<std::size_t>(i)];
      nodes_a_[i] = pair.a, nodes_b_[i] = pair.b;
      a_.require(pair.a, counter_);
      b_.require(pair.b, counter_);
    }
    return count;
  }

  /// Tests the pairs taken; says whether the query has had enough.
  template <bool kFromFront>
  bool look_at(int count, std::size_t first_slot) {
    counter_.tested(static_cast<std::uint64_t>(count));
    open_.reserve(4 * W);
    const std::uint64_t excluded = test(count);
    if constexpr (Keeping::kept && !kFromFront)
      for (std::uint64_t rest = excluded; rest; rest &= rest - 1) {
        const int i = std::countr_zero(rest);
        keeping_.front.add({nodes_a_[i], nodes_b_[i]});
      }
    for (std::uint64_t rest = ~excluded & all(count); rest; rest &= rest - 1) {
      const int i = std::countr_zero(rest);
      const NodePair pair{nodes_a_[i], nodes_b_[i]};
      const auto& a = a_.hierarchy().node(pair.a);
      const auto& b = b_.hierarchy().node(pair.b);
      [[maybe_unused]] const std::size_t slot = first_slot + static_cast<std::size_t>(i);
      if (a.count && b.count) {
        std::size_t from = 0;
        if constexpr (Keeping::kept) from = kFromFront ? slot : keeping_.front.add(pair);
        hold(a, b, from);
      } else {
        if constexpr (Keeping::kept && kFromFront) keeping_.front.open(slot);
        descend(pair, a, b);
      }
    }
    return pending_.size() > Query::patience && flush();
  }

  static constexpr std::uint64_t all(int count) { return (std::uint64_t{2} << (count - 1)) - 1; }

  std::uint64_t test(int count) {
    // A pair by itself is not worth a batch.
    if (count == 1) {
      return bits(query_.excludes(a_.volumes()[nodes_a_[0]], b_.volumes()[nodes_b_[0]]));
    } else {
      for (int i = count; i < W; ++i) nodes_a_[i] = nodes_a_[0], nodes_b_[i] = nodes_b_[0];
      return bits(query_.excludes(gather<B>(a_.volumes(), nodes_a_.data()),
                                  gather<B>(b_.volumes(), nodes_b_.data()))) &
             all(count);
    }
  }

  static bool descends_b(const Node& a, const Node& b) {
    return a.count || (!b.count && b.size > a.size);
  }

  void descend(const NodePair& pair, const Node& a, const Node& b) {
    if (Keeping::descends_both && !a.count && !b.count) {
      a_.require(a.first, counter_);
      b_.require(b.first, counter_);
      open_.push({a.first + 1, b.first + 1});
      open_.push({a.first + 1, b.first});
      open_.push({a.first, b.first + 1});
      open_.push({a.first, b.first});
    } else if (descends_b(a, b)) {
      b_.require(b.first, counter_);
      open_.push({pair.a, b.first + 1});
      open_.push({pair.a, b.first});
    } else {
      a_.require(a.first, counter_);
      open_.push({a.first + 1, pair.b});
      open_.push({a.first, pair.b});
    }
  }

  void hold(const Node& a, const Node& b, std::size_t slot) {
    for (std::uint32_t i = a.first; i < a.first + a.count; ++i)
      for (std::uint32_t j = b.first; j < b.first + b.count; ++j)
        pending_.push_back({&a_.triangle(i), &b_.triangle(j), a_.hierarchy().primitive(i),
                            b_.hierarchy().primitive(j), slot});
  }

  bool flush() {
    if (pending_.empty()) return false;
    const Outcome outcome = query_.primitives(pending_);
    if (outcome.witness != Outcome::none) witness_ = pending_[outcome.witness].slot;
    counter_.primitives(outcome.enough ? outcome.witness + 1 : pending_.size());
    pending_.clear();
    return outcome.enough;
  }

  Body<V>& a_;
  Body<V>& b_;
  Query& query_;
  Counter& counter_;
  Keeping keeping_;
  OpenPairs& open_;
  std::vector<Candidate>& pending_;
  std::array<std::uint32_t, W> nodes_a_, nodes_b_;
  std::size_t witness_ = Outcome::none;
};

}  // namespace detail

/// Runs the query over two bodies from their roots. B is the scalar or batch that volumes are
/// tested in. Says whether everything was seen: false where the query stopped it.
template <class B, class Roots = NoFront, class V, class Query, class Counter>
bool traverse(Body<V>& a, Body<V>& b, Query& query, Counter& counter, Workspace& workspace) {
  return detail::Traversal<B, V, Query, Counter, Roots>(a, b, query, counter, {}, workspace).run();
}

/// The same from a front, which is kept up to date: it never shrinks, and stays a partition also
/// when the query stops the traversal. The entry at which it stopped is the first one then.
template <class B, class V, class Query, class Counter>
bool traverse(Body<V>& a, Body<V>& b, Query& query, Counter& counter, Workspace& workspace,
              Front& front) {
  return detail::Traversal<B, V, Query, Counter, KeptFront>(a, b, query, counter, {front},
                                                            workspace)
      .run();
}

}  // namespace bvlab
