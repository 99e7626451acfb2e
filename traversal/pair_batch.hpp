// SPDX-License-Identifier: BSD-3-Clause
/// A batch of pairs of nodes that are tested together, one pair per lane.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "hierarchies/relative_placement.hpp"
#include "traversal/gather.hpp"
#include "traversal/node_pair.hpp"
#include "traversal/queries/query.hpp"

namespace bvlab {

namespace detail {

/// Which pairs of volumes the query culls, as bits. Writes the gaps to `gaps` if kGaps.
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

/// The same, out of line, so that it is compiled once for all fronts and counters.
template <bool kGaps, class P, class Query, class T>
[[gnu::noinline, gnu::flatten]] std::uint64_t culled_one(const P& p, const P& q, Query& query,
                                                         T* gaps) {
  return culled<kGaps>(p, q, query, gaps);
}

/// The same for as many pairs of nodes as `Some` has lanes.
template <class Some, bool kGaps, class P, class Query, class T>
[[gnu::noinline, gnu::flatten]] std::uint64_t culled_of(const P* a, const std::uint32_t* nodes_a,
                                                        const P* b, const std::uint32_t* nodes_b,
                                                        Query& query, T* gaps) {
  return culled<kGaps>(gather<Some>(a, nodes_a), gather<Some>(b, nodes_b), query, gaps);
}

/// The same for stored volumes: those of a are posed into the frame of b.
template <bool kGaps, class V, class Query, class T>
[[gnu::noinline]] std::uint64_t culled_one_in_b(const V& a, const V& b,
                                                const bvlab::PlacementOf<V>& placement,
                                                Query& query, T* gaps) {
  const Posed<V> in_b = posed(a, placement);
  return culled<kGaps>(in_b, static_cast<const Posed<V>&>(as_stored<V>(b)), query, gaps);
}
template <class Some, bool kGaps, class V, class Query, class T>
[[gnu::noinline, gnu::flatten]] std::uint64_t culled_of_in_b(
    const V* a, const std::uint32_t* nodes_a, const V* b, const std::uint32_t* nodes_b,
    const bvlab::PlacementOf<V>& placement, Query& query, T* gaps) {
  using Lanes = Over<Posed<V>, Some>;
  const Lanes in_b = posed(gather<Some>(a, nodes_a), placement);
  return culled<kGaps>(in_b, static_cast<const Lanes&>(as_stored<V>(gather<Some>(b, nodes_b))),
                       query, gaps);
}

}  // namespace detail

/// The volumes of two bodies, posed into the world (see frame.hpp).
template <class V>
struct PosedVolumes {
  const Posed<V>*a, *b;

  template <class Some, bool kGaps, class Query, class T>
  [[gnu::always_inline]] std::uint64_t culled(const std::uint32_t* nodes_a,
                                              const std::uint32_t* nodes_b, Query& query,
                                              T* gaps) const {
    return detail::culled_of<Some, kGaps>(a, nodes_a, b, nodes_b, query, gaps);
  }
  template <bool kGaps, class Query, class T>
  [[gnu::always_inline]] std::uint64_t culled(std::uint32_t node_a, std::uint32_t node_b,
                                              Query& query, T* gaps) const {
    return detail::culled_one<kGaps>(a[node_a], b[node_b], query, gaps);
  }
};

/// The volumes of two bodies as stored: those of a are posed into the frame of b when tested.
template <class V>
struct StoredVolumes {
  const V *a, *b;
  const PlacementOf<V>& placement;  ///< of a in the frame of b

  template <class Some, bool kGaps, class Query, class T>
  [[gnu::always_inline]] std::uint64_t culled(const std::uint32_t* nodes_a,
                                              const std::uint32_t* nodes_b, Query& query,
                                              T* gaps) const {
    return detail::culled_of_in_b<Some, kGaps>(a, nodes_a, b, nodes_b, placement, query, gaps);
  }
  template <bool kGaps, class Query, class T>
  [[gnu::always_inline]] std::uint64_t culled(std::uint32_t node_a, std::uint32_t node_b,
                                              Query& query, T* gaps) const {
    return detail::culled_one_in_b<kGaps>(a[node_a], b[node_b], placement, query, gaps);
  }
};

/// B is the scalar or batch, of W lanes, in which volumes are tested.
template <class B, bool kGaps>
class PairBatch {
 public:
  static constexpr std::size_t W = width<B>();

  void put(std::size_t lane, const NodePair& pair) {
    nodes_a_[lane] = pair.a, nodes_b_[lane] = pair.b;
  }
  NodePair operator[](std::size_t lane) const { return {nodes_a_[lane], nodes_b_[lane]}; }
  /// A lower bound on the distance of the volumes in a lane; 0 where gaps are not measured.
  double gap(std::size_t lane) const {
    if constexpr (kGaps) return static_cast<double>(gaps_[lane]);
    return 0;
  }

  /// The mask of the first `count` lanes.
  static constexpr std::uint64_t all(std::size_t count) {
    return (std::uint64_t{2} << (count - 1)) - 1;
  }

  /// Which of the first `count` pairs the query culls, as bits.
  template <class Volumes, class Query>
  [[gnu::always_inline]] std::uint64_t culled(const Volumes& volumes, std::size_t count,
                                              Query& query) {
    // One pair is tested without a batch, and two to four in a narrow one: that costs less.
    if constexpr (W > 4)
      if (count > 1 && count <= 4) return culled_as<Batch<Element<B>, 4>>(volumes, count, query);
    if constexpr (W > 1)
      if (count > 1) return culled_as<B>(volumes, count, query);
    return volumes.template culled<kGaps>(nodes_a_[0], nodes_b_[0], query, gaps_.data());
  }

  /// Calls open(lane) for each lane of a mask. If the query wants a bound, the nearest comes last,
  /// so that its children are tested first.
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
  template <class Some, class Volumes, class Query>
  [[gnu::always_inline]] std::uint64_t culled_as(const Volumes& volumes, std::size_t count,
                                                 Query& query) {
    for (std::size_t i = count; i < std::size_t{width<Some>()}; ++i)
      nodes_a_[i] = nodes_a_[0], nodes_b_[i] = nodes_b_[0];
    return volumes.template culled<Some, kGaps>(nodes_a_.data(), nodes_b_.data(), query,
                                                gaps_.data()) &
           all(count);
  }

  std::array<std::uint32_t, W> nodes_a_, nodes_b_;
  std::array<Element<B>, kGaps ? W : 0> gaps_;
};

}  // namespace bvlab
