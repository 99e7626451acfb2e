// SPDX-License-Identifier: BSD-3-Clause
/// Runs queries on several threads and delivers their answers to one, in the order of the pairs. On
/// one thread, answers are delivered as they are found. Each thread keeps copies of its answered
/// queries in a list; a table by slot says which thread has an answer, and where.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <ranges>
#include <type_traits>
#include <utility>
#include <vector>

#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "traversal/shape.hpp"

namespace bvlab {

class AnswersInOrder {
 public:
  /// Queries the pairs in `slots`, each below `count`, on the threads: `pairs` is as in WorldOf.
  /// The calling thread then takes the answers in the order of `slots`, and counters are added up.
  /// One thread delivers each answer as it is found.
  template <class Pairs, class Slots, class Counter, class MakeQuery, class Take>
  void run_pairs(Pairs& pairs, Threads& threads, const Slots& slots, std::size_t count,
                 Counter& counter, MakeQuery& make_query, Take&& take) {
    using Query = std::remove_cvref_t<decltype(make_query(std::uint32_t{}, ObjectPair{}))>;
    if (threads.count() == 1) return pairs.run(slots, 0, counter, make_query, take);
    struct alignas(128) Own {  // written by one thread, in cache lines of its own
      std::vector<Query> answered;
      Counter counter;
    };
    std::vector<Own> all(threads.count());
    for (Own& own : all) own.answered.reserve(2 * slots.size() / all.size());
    positions_.resize(count);
    // Small shares where there are few pairs: some may take much longer than others.
    const std::size_t least =
        std::clamp<std::size_t>(slots.size() / (8 * all.size()), 1, largest_share);
    const auto at = [&slots](std::size_t k) {
      return std::ranges::begin(slots) + static_cast<std::ptrdiff_t>(k);
    };
    threads.share_out(
        slots.size(), least, [&](std::size_t begin, std::size_t end, std::size_t worker) {
          Own& own = all[worker];
          pairs.run(std::ranges::subrange(at(begin), at(end)), worker, own.counter, make_query,
                    [&](std::uint32_t slot, const ObjectPair&, const Query& query) {
                      positions_[slot] = {static_cast<std::uint32_t>(worker),
                                          static_cast<std::uint32_t>(own.answered.size())};
                      own.answered.push_back(query);
                    });
        });
    for (const std::uint32_t slot : slots) {
      const auto [worker, index] = positions_[slot];
      take(slot, pairs.pairs()[slot], std::as_const(all[worker].answered[index]));
    }
    for (const Own& own : all) counter.add(own.counter);
  }

 private:
  /// A share of this size makes the cost of handing it out negligible.
  static constexpr std::size_t largest_share = 32;

  struct Position {
    std::uint32_t worker, index;  ///< who has it, and where
  };
  LargeVector<Position> positions_;  // by slot, while answers are taken
};

}  // namespace bvlab
