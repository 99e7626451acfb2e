// SPDX-License-Identifier: BSD-3-Clause
/// Queries that several threads ask and one takes, in an order that does not depend on who asked
/// what: each is copied to its thread's list, and found there by a key.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/threads.hpp"

namespace bvlab {

class AnswersInOrder {
 public:
  /// Has all below `count` asked: `ask(begin, end, worker, counter, take)` asks some of them, each
  /// with a key below `keys`, and calls take(key, query); then, here and in order, `take(key,
  /// query)` for key_of(0) to key_of(count - 1). Counters are added up.
  template <class Query, class Counter, class KeyOf, class Ask, class Take>
  void ask(Threads& threads, std::size_t count, std::size_t keys, Counter& counter, KeyOf&& key_of,
           Ask&& ask, Take&& take) {
    struct alignas(128) Own {  // written to by one thread, beside another's
      std::vector<Query> answered;
      Counter counter;
    };
    std::vector<Own> all(threads.count());
    for (Own& own : all) own.answered.reserve(2 * count / all.size());
    places_.resize(keys);
    // Few pairs may be long ones.
    const std::size_t least = std::clamp<std::size_t>(count / (8 * all.size()), 1, enough);
    threads.share_out(count, least, [&](std::size_t begin, std::size_t end, std::size_t worker) {
      Own& own = all[worker];
      ask(begin, end, worker, own.counter, [&](std::size_t key, const Query& query) {
        places_[key] = {static_cast<std::uint32_t>(worker),
                        static_cast<std::uint32_t>(own.answered.size())};
        own.answered.push_back(query);
      });
    });
    for (std::size_t k = 0; k < count; ++k) {
      const auto key = key_of(k);
      const auto [worker, place] = places_[key];
      take(key, std::as_const(all[worker].answered[place]));
    }
    for (const Own& own : all) counter.add(own.counter);
  }

 private:
  /// So many pairs that to hand them over costs nothing beside asking them.
  static constexpr std::size_t enough = 32;

  struct Place {
    std::uint32_t worker, place;  ///< who has it, and where
  };
  LargeVector<Place> places_;  // of each key, while they are taken
};

}  // namespace bvlab
