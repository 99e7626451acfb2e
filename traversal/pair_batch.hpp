// SPDX-License-Identifier: BSD-3-Clause
/// Pairs of nodes that are tested together, as many as a batch has lanes: volumes are posed where
/// that has not been done, gathered and compared, and all that is counted.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "hierarchies/bounding_volume.hpp"
#include "traversal/body.hpp"
#include "traversal/descent.hpp"
#include "traversal/gather.hpp"
#include "traversal/node_pair.hpp"
#include "traversal/queries/query.hpp"

namespace bvlab {

namespace detail {

/// Which pairs of volumes the query culls, as bits; the gaps to `gaps` where they are wanted.
template <bool kGaps, class P, class Query, class T>
[[gnu::always_inline]] inline std::uint64_t culled(const P& p, const P& q, Query& query,
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

/// The same by itself, so that it is compiled once for all fronts and counters.
template <bool kGaps, class P, class Query, class T>
[[gnu::noinline]] std::uint64_t culled_one(const P& p, const P& q, Query& query, T* gaps) {
  return culled<kGaps>(p, q, query, gaps);
}
template <class P>
[[gnu::noinline]] auto gap_between(const P& p, const P& q) {
  return gap(p, q);
}

/// And of as many nodes as there are lanes.
template <class Some, bool kGaps, class P, class Query, class T>
[[gnu::noinline]] std::uint64_t culled_of(const P* a, const std::uint32_t* nodes_a, const P* b,
                                          const std::uint32_t* nodes_b, Query& query, T* gaps) {
  return culled<kGaps>(gather<Some>(a, nodes_a), gather<Some>(b, nodes_b), query, gaps);
}

}  // namespace detail

/// B is the scalar or batch, of W lanes, that volumes are tested in.
template <class B, class V, class Counter, bool kGaps>
class PairBatch {
 public:
  static constexpr std::size_t W = width<B>();

  PairBatch(Body<V>& a, Body<V>& b, Counter& counter) : a_(a), b_(b), counter_(counter) {}

  /// Poses the volumes of both nodes, or of one of a or b; and of their siblings.
  void require(const NodePair& pair) {
    a_.require(pair.a, counter_);
    b_.require(pair.b, counter_);
  }
  void require_of(Descent body, std::uint32_t node) {
    (body == Descent::b ? b_ : a_).require(node, counter_);
  }

  /// Into a lane; volumes are to be posed before they are tested.
  void put(std::size_t lane, const NodePair& pair) {
    nodes_a_[lane] = pair.a, nodes_b_[lane] = pair.b;
  }
  NodePair operator[](std::size_t lane) const { return {nodes_a_[lane], nodes_b_[lane]}; }

  /// Which of the first `count` pairs the query culls, as bits.
  template <class Query>
  [[gnu::always_inline]] std::uint64_t culled(std::size_t count, Query& query) {
    count_tests(count);
    // A pair by itself is not worth a batch, and four are not worth a wide one.
    if constexpr (W > 4)
      if (count > 1 && count <= 4) return culled_as<Batch<Element<B>, 4>>(count, query);
    if constexpr (W > 1)
      if (count > 1) return culled_as<B>(count, query);
    return detail::culled_one<kGaps>(a_.volumes()[nodes_a_[0]], b_.volumes()[nodes_b_[0]], query,
                                     gaps_.data());
  }
  /// At most the distance between the volumes tested in a lane; 0 where gaps are not measured.
  double gap(std::size_t lane) const {
    if constexpr (kGaps) return static_cast<double>(gaps_[lane]);
    return 0;
  }
  /// The same of any pair.
  auto gap(const NodePair& pair) {
    require(pair);
    count_tests(1);
    return detail::gap_between(a_.volumes()[pair.a], b_.volumes()[pair.b]);
  }

  /// The pairs tested so far.
  std::size_t tests() const { return tests_; }

  /// The lanes below `count` that are not in the mask, in the order in which they are to be opened:
  /// where a bound is wanted the nearest last, so that it is the first to be looked at.
  template <class Query, class Open>
  [[gnu::always_inline]] void for_each_near(std::size_t count, std::uint64_t culled,
                                            Open&& open) const {
    std::uint64_t mask = ~culled & all(count);
    if constexpr (!wants_bound<Query>()) {
      for (; mask; mask &= mask - 1) open(static_cast<std::size_t>(std::countr_zero(mask)));
    } else {
      std::array<std::uint8_t, W> order;
      std::size_t near = 0;
      for (; mask; mask &= mask - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(mask));
        std::size_t at = near++;
        for (; at > 0 && gaps_[order[at - 1]] < gaps_[lane]; --at) order[at] = order[at - 1];
        order[at] = static_cast<std::uint8_t>(lane);
      }
      for (std::size_t k = 0; k < near; ++k) open(order[k]);
    }
  }

 private:
  static constexpr std::uint64_t all(std::size_t count) {
    return (std::uint64_t{2} << (count - 1)) - 1;
  }

  template <class Some, class Query>
  [[gnu::always_inline]] std::uint64_t culled_as(std::size_t count, Query& query) {
    for (std::size_t i = count; i < std::size_t{width<Some>()}; ++i)
      nodes_a_[i] = nodes_a_[0], nodes_b_[i] = nodes_b_[0];
    return detail::culled_of<Some, kGaps>(a_.volumes(), nodes_a_.data(), b_.volumes(),
                                          nodes_b_.data(), query, gaps_.data()) &
           all(count);
  }

  void count_tests(std::size_t count) {
    tests_ += count;
    counter_.tested(count);
  }

  Body<V>& a_;
  Body<V>& b_;
  Counter& counter_;
  std::array<std::uint32_t, W> nodes_a_, nodes_b_;
  std::array<Element<B>, kGaps ? W : 0> gaps_;
  std::size_t tests_ = 0;
};

}  // namespace bvlab
