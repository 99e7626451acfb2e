// SPDX-License-Identifier: BSD-3-Clause
/// Runs queries on several threads and delivers their answers to one, in an order that does not
/// depend on the threads. Each thread keeps copies of its answered queries in a list; a table by
/// slot says which thread has an answer, and where.
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
  /// One thread delivers each answer as it is found.
  template <class Pairs, class Slots, class Counter, class MakeQuery, class Take>
  void run_pairs(Pairs& pairs, Threads& threads, const Slots& slots, std::size_t count,
                 Counter& counter, MakeQuery& make_query, Take&& take) {
    using Query = std::remove_cvref_t<decltype(make_query(std::uint32_t{}, ObjectPair{}))>;
    if (threads.count() == 1) return pairs.run(slots, 0, counter, make_query, take);
    const auto at = [&slots](std::size_t k) {
      return std::ranges::begin(slots) + static_cast<std::ptrdiff_t>(k);
    };
    run<Query>(
        threads, slots.size(), count, counter, [&](std::size_t k) { return *at(k); },
        [&](std::size_t begin, std::size_t end, std::size_t worker, Counter& own, auto&& answer) {
          pairs.run(std::ranges::subrange(at(begin), at(end)), worker, own, make_query,
                    [&](std::uint32_t slot, const ObjectPair&, const Query& query) {
                      answer(slot, query);
                    });
        },
        [&](std::uint32_t slot, const Query& query) { take(slot, pairs.pairs()[slot], query); });
  }

 private:
  /// Runs `count` queries on the threads: `run_some(begin, end, worker, counter, take)` runs those
  /// from begin to end, each with a key below `keys`, and calls take(key, query). Then, on the
  /// calling thread and in order, calls `take(key, query)` for key_of(0) to key_of(count - 1).
  /// Counters are added up.
  template <class Query, class Counter, class KeyOf, class RunSome, class Take>
  void run(Threads& threads, std::size_t count, std::size_t keys, Counter& counter, KeyOf&& key_of,
           RunSome&& run_some, Take&& take) {
    struct alignas(128) Own {  // written by one thread, in cache lines of its own
      std::vector<Query> answered;
      Counter counter;
    };
    std::vector<Own> all(threads.count());
    for (Own& own : all) own.answered.reserve(2 * count / all.size());
    positions_.resize(keys);
    // Small shares where there are few pairs: some may take much longer than others.
    const std::size_t least = std::clamp<std::size_t>(count / (8 * all.size()), 1, largest_share);
    threads.share_out(count, least, [&](std::size_t begin, std::size_t end, std::size_t worker) {
      Own& own = all[worker];
      run_some(begin, end, worker, own.counter, [&](std::size_t key, const Query& query) {
        positions_[key] = {static_cast<std::uint32_t>(worker),
                           static_cast<std::uint32_t>(own.answered.size())};
        own.answered.push_back(query);
      });
    });
    for (std::size_t k = 0; k < count; ++k) {
      const auto key = key_of(k);
      const auto [worker, index] = positions_[key];
      take(key, std::as_const(all[worker].answered[index]));
    }
    for (const Own& own : all) counter.add(own.counter);
  }

  /// A share of this size makes the cost of handing it out negligible.
  static constexpr std::size_t largest_share = 32;

  struct Position {
    std::uint32_t worker, index;  ///< who has it, and where
  };
  LargeVector<Position> positions_;  // of each key, while they are taken
};

}  // namespace bvlab
