// SPDX-License-Identifier: BSD-3-Clause
/// Many bodies, of which only pairs that are near each other are asked, and only when one of the
/// two has moved: a broad phase over the bodies' boxes in front (NearPairs), and behind it pairs
/// that remember what they want of their last answers, forgotten when the pair parts.
///
/// What stays costs nothing, and what nobody came near is not even made.
///
/// With several threads the broad phase, the bodies that moved and the pairs are shared; answers,
/// contacts and counts are the same for any number of them. What is one thread's: moves, pairs that
/// begin and end, the list of those to ask, and takes, together a twentieth of a frame in which ten
/// thousand bodies move.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "traversal/answers_in_order.hpp"
#include "traversal/near_pairs.hpp"

namespace bvlab {

/// Pairs are StrategyPairs, WidePairs, or what offers the same:
///   size(), mesh(i)                     of bodies
///   put(slot, pair), drop(slot)         a pair that is to be asked from now on, or no more
///   begin<Query>(movers, poses, origin, threads)  of a frame: who has moved; poses are of all
///   stand(i)                                      for each of them, on any thread
///   ask(slots, worker, counter, ask, take)        asks some of the pairs, as one of the threads
///   front_size(slot)
/// Method is a broad phase over float boxes that reports changes.
template <class Pairs, class Method>
class WorldOf {
 public:
  explicit WorldOf(Pairs pairs, int threads = 1)
      : pairs_(std::move(pairs)),
        near_(pairs_.size(), threads,
              [this](std::size_t i) -> const TriangleMesh& { return pairs_.mesh(i); }) {}

  /// Says where a body is from now on. A body that never was moved is not in the scene.
  void move(std::uint32_t object, const Pose& pose) { near_.move(object, pose); }
  /// Takes a body out of the scene until it is moved again.
  void take_out(std::uint32_t object) { near_.take_out(object); }

  /// Asks every pair whose boxes meet and of which a body has moved since the last update:
  /// `ask(pair)` makes the query, `take(slot, pair, query)` gets it back with its answer, in any
  /// order. All other pairs have the answers they had. `leave(slot)` is told before of pairs whose
  /// boxes have parted: nothing of the two bodies meets.
  ///
  /// A slot is a pair's as long as its boxes meet. With one thread, up to two queries are asked
  /// before the first of them is taken; with more, all of them are, `ask` is called on any thread,
  /// for several pairs at once, and may be given the slot, too: `ask(pair, slot)`. `take` and
  /// `leave` are called on the caller's.
  template <class Counter, class Ask, class Take, class Leave>
  void update(Counter& counter, Ask&& ask, Take&& take, Leave&& leave) {
    const auto make = [&ask](std::uint32_t slot, const ObjectPair& pair) {
      if constexpr (std::is_invocable_v<Ask&, const ObjectPair&, std::uint32_t>)
        return ask(pair, slot);
      else
        return ask(pair);
    };
    using Query = std::remove_cvref_t<decltype(make(0, ObjectPair()))>;
    pairs_.template begin<Query>(near_.movers(), near_.poses(), near_.origin(), near_.threads());
    near_.update([&](std::uint32_t i) { pairs_.stand(i); },
                 [&](std::uint32_t slot, const ObjectPair& pair) { pairs_.put(slot, pair); },
                 [&](std::uint32_t slot) { leave(slot), pairs_.drop(slot); });
    if (near_.threads().count() == 1)
      pairs_.ask(near_.due(), 0, counter, make, take);
    else
      ask_on_threads<Query>(counter, make, take);
    asked_ = near_.due().size();
    near_.settle();
  }

  std::size_t objects() const { return pairs_.size(); }
  /// Pairs whose boxes meet.
  std::size_t near() const { return near_.size(); }
  /// Pairs that the last update asked.
  std::size_t asked() const { return asked_; }
  /// The entries of all fronts together; looks at every pair.
  std::size_t front_size() const {
    std::size_t sum = 0;
    for (std::uint32_t slot = 0; slot < near_.slots(); ++slot)
      if (near_.taken(slot)) sum += pairs_.front_size(slot);
    return sum;
  }

 private:
  template <class Query, class Counter, class Make, class Take>
  void ask_on_threads(Counter& counter, Make& make, Take& take) {
    const auto due = near_.due();
    answers_.ask<Query>(
        near_.threads(), due.size(), near_.slots(), counter, [&](std::size_t k) { return due[k]; },
        [&](std::size_t begin, std::size_t end, std::size_t worker, Counter& own, auto&& answer) {
          pairs_.ask(due.subspan(begin, end - begin), worker, own, make,
                     [&](std::uint32_t slot, const ObjectPair&, const Query& query) {
                       answer(slot, query);
                     });
        },
        [&](std::uint32_t slot, const Query& query) { take(slot, near_.pair(slot), query); });
  }

  Pairs pairs_;
  NearPairs<Method> near_;
  AnswersInOrder answers_;
  std::size_t asked_ = 0;
};

/// Which pairs touch, as a list that changes only where answers do.
class TouchingPairs {
 public:
  void put(std::uint32_t slot, const ObjectPair& pair, bool touching) {
    if (slot >= place_.size()) place_.resize(slot + 1, none);
    if (touching == (place_[slot] != none)) return;
    if (!touching) return drop(slot);
    place_[slot] = static_cast<std::uint32_t>(pairs_.size());
    pairs_.push_back(pair);
    slots_.push_back(slot);
  }
  void drop(std::uint32_t slot) {
    if (slot >= place_.size() || place_[slot] == none) return;
    const std::uint32_t place = place_[slot];
    pairs_[place] = pairs_.back(), slots_[place] = slots_.back();
    place_[slots_[place]] = place;
    place_[slot] = none;
    pairs_.pop_back(), slots_.pop_back();
  }
  /// In any order.
  std::span<const ObjectPair> pairs() const { return pairs_; }

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  std::vector<std::uint32_t> place_;  // of each slot, in the two others
  std::vector<ObjectPair> pairs_;
  std::vector<std::uint32_t> slots_;
};

}  // namespace bvlab
