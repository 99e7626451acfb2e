// SPDX-License-Identifier: BSD-3-Clause
/// A batch of up to W pairs of nodes that are tested together, one pair per lane; with their gaps,
/// if kGaps.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "traversal/node_pair.hpp"
#include "traversal/volume_tests.hpp"

namespace bvlab {

template <std::size_t W, bool kGaps>
class PairBatch {
 public:
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
  template <class Query>
  [[gnu::always_inline]] std::uint64_t culled(const VolumeTests<Query>& tests, std::size_t count,
                                              Query& query) {
    // One pair is tested without a batch, and two to four in a narrow one: that costs less.
    const auto& of = *(kGaps ? tests.culled_with_gaps : tests.culled);
    if (count == 1) return of.one(tests, nodes_a_.data(), nodes_b_.data(), query, gaps_.data());
    const bool few = W > 4 && count <= 4;
    for (std::size_t i = count; i < (few ? 4 : W); ++i)
      nodes_a_[i] = nodes_a_[0], nodes_b_[i] = nodes_b_[0];
    return (few ? of.four : of.all)(tests, nodes_a_.data(), nodes_b_.data(), query, gaps_.data()) &
           all(count);
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
  std::array<std::uint32_t, W> nodes_a_, nodes_b_;
  std::array<float, kGaps ? W : 0> gaps_;
};

}  // namespace bvlab
