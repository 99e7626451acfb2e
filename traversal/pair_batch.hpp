// SPDX-License-Identifier: BSD-3-Clause
/// Pairs of nodes that are tested together, as many as a batch has lanes.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "hierarchies/bounding_volume.hpp"
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
template <class B, bool kGaps>
class PairBatch {
 public:
  static constexpr std::size_t W = width<B>();

  void put(std::size_t lane, const NodePair& pair) {
    nodes_a_[lane] = pair.a, nodes_b_[lane] = pair.b;
  }
  NodePair operator[](std::size_t lane) const { return {nodes_a_[lane], nodes_b_[lane]}; }
  /// At most the distance between the volumes tested in a lane; 0 where gaps are not measured.
  double gap(std::size_t lane) const {
    if constexpr (kGaps) return static_cast<double>(gaps_[lane]);
    return 0;
  }

  /// As many lanes as were put.
  static constexpr std::uint64_t all(std::size_t count) {
    return (std::uint64_t{2} << (count - 1)) - 1;
  }

  /// Which of the first `count` pairs the query culls, as bits. All volumes have been posed.
  template <class P, class Query>
  [[gnu::always_inline]] std::uint64_t culled(const P* a, const P* b, std::size_t count,
                                              Query& query) {
    // A pair by itself is not worth a batch, and four are not worth a wide one.
    if constexpr (W > 4)
      if (count > 1 && count <= 4) return culled_as<Batch<Element<B>, 4>>(a, b, count, query);
    if constexpr (W > 1)
      if (count > 1) return culled_as<B>(a, b, count, query);
    return detail::culled_one<kGaps>(a[nodes_a_[0]], b[nodes_b_[0]], query, gaps_.data());
  }

  /// The lanes of a mask in the order in which they are to be opened: where a bound is wanted the
  /// nearest last, so that it is the first to be looked at.
  template <class Query, class Open>
  [[gnu::always_inline]] void for_each_near(std::uint64_t mask, Open&& open) const {
    if constexpr (!wants_bound<Query>()) {
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

 private:
  template <class Some, class P, class Query>
  [[gnu::always_inline]] std::uint64_t culled_as(const P* a, const P* b, std::size_t count,
                                                 Query& query) {
    for (std::size_t i = count; i < std::size_t{width<Some>()}; ++i)
      nodes_a_[i] = nodes_a_[0], nodes_b_[i] = nodes_b_[0];
    return detail::culled_of<Some, kGaps>(a, nodes_a_.data(), b, nodes_b_.data(), query,
                                          gaps_.data()) &
           all(count);
  }

  std::array<std::uint32_t, W> nodes_a_, nodes_b_;
  std::array<Element<B>, kGaps ? W : 0> gaps_;
};

}  // namespace bvlab
