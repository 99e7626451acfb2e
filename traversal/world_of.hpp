// SPDX-License-Identifier: BSD-3-Clause
/// A scene of many bodies. Only pairs whose boxes overlap are queried, and only when one of the two
/// bodies has moved: a broad phase over the bodies' boxes finds them (NearPairs). A pair may keep
/// its last answer or a front, and drops them when the boxes part.
///
/// Bodies that do not move are not posed or queried. Nothing is built for a body that no other has
/// come near.
///
/// With several threads the broad phase, the bodies that moved and the pairs are divided among
/// them; answers, contacts and counts are the same for any number of threads. Serial are moves,
/// pairs that begin and end, the list of pairs to query, and the calls of `take`: together a
/// twentieth of a frame in which ten thousand bodies move.
#pragma once

#include <sched.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "hierarchies/geometry/unless_done.hpp"
#include "traversal/answers_in_order.hpp"
#include "traversal/near_pairs.hpp"
#include "traversal/pair_choice.hpp"
#include "traversal/queries/contacts.hpp"

namespace bvlab {

/// Pairs is StrategyPairs, WidePairs, or a class with the same members:
///   size(), mesh(i)                     of bodies
///   add(shape)                          adds a body; its type is that of Pairs
///   put(slot, pair), drop(slot)         begins to query a pair in later frames, or ends it
///   pairs()                             the pairs, by slot
///   begin<Query>(movers, poses, origin, threads)  begins a frame: who has moved; poses of all
///   set_pose(i)                                   for each mover, on any thread
///   run(slots, worker, counter, make_query, take) queries some of the pairs, on one thread
///   front_size(slot)                    the entries of the front of a pair
/// Method is a broad phase over float boxes that reports changes.
template <class Pairs, class Method>
class WorldOf {
 public:
  explicit WorldOf(Pairs pairs, int threads = 1)
      : pairs_(std::move(pairs)),
        near_(pairs_.size(), threads,
              [this](std::size_t i) -> const TriangleMesh& { return pairs_.mesh(i); }) {}

  /// Only these pairs are queried. To be called before the first update.
  void choose(const PairChoice& choice) { near_.choose(PairFilter(choice)); }
  /// Adds a body at a pose and returns its index, one more than the last; `shape` is what Pairs
  /// has for a body, and what it refers to must outlive the world. O(1), amortised.
  template <class Shape>
  std::uint32_t add(const Shape& shape, const Pose& pose) {
    const std::uint32_t object = add(shape);
    move(object, pose);
    return object;
  }
  /// The same, for a body that enters the scene when it is moved.
  template <class Shape>
  std::uint32_t add(const Shape& shape) {
    pairs_.add(shape);
    return near_.add(pairs_.mesh(pairs_.size() - 1));
  }
  /// The number of bodies, those that were removed included.
  std::size_t size() const { return pairs_.size(); }

  /// Sets a body's pose. A body that was never moved is not in the scene.
  void move(std::uint32_t object, const Pose& pose) { near_.move(object, pose); }
  /// Removes a body from the scene, until it is moved again. No other body gets its index.
  void remove(std::uint32_t object) { near_.take_out(object); }

  /// Queries every pair whose boxes overlap and of which a body has moved since the last update.
  /// `make_query(pair)` returns the query, `take(slot, pair, query)` receives it with its answer,
  /// in any order. All other pairs keep their answers. Before that, `leave(slot)` is called for
  /// pairs whose boxes have parted: the two bodies are apart.
  ///
  /// A slot belongs to a pair as long as its boxes overlap. With one thread, up to two queries are
  /// made before the first of them is taken. With more, all of them are; `make_query` is called on
  /// any thread, concurrently, and may take the slot, too: `make_query(pair, slot)`, or
  /// `make_query(slot, pair)`. `take` and
  /// `leave` are called on the caller's thread. WorldContacts keeps a list of contacts for each
  /// slot.
  ///
  /// After an exception of a query or of `take`, the next update queries all pairs of this one
  /// again, those that were taken too. After any other (std::bad_alloc, std::length_error) the
  /// world must not be used again. `leave` must not throw.
  template <class Counter, class MakeQuery, class Take, class Leave>
  void update(Counter& counter, MakeQuery&& make_query, Take&& take, Leave&& leave) {
    if constexpr (std::is_invocable_v<MakeQuery&, std::uint32_t, const ObjectPair&>)
      update_by_slots(counter, make_query, take, leave);
    else
      update_by_slots(
          counter,
          [&make_query](std::uint32_t slot, const ObjectPair& pair) {
            if constexpr (std::is_invocable_v<MakeQuery&, const ObjectPair&, std::uint32_t>)
              return make_query(pair, slot);
            else
              return make_query(pair);
          },
          take, leave);
  }

  /// The number of chosen pairs whose boxes overlap.
  std::size_t near() const { return near_.size(); }
  /// The number of pairs that the last update queried.
  std::size_t queried() const { return queried_; }
  /// The number of entries of all fronts. O(slots).
  std::size_t front_size() const {
    std::size_t sum = 0;
    for (std::uint32_t slot = 0; slot < near_.slots(); ++slot)
      if (near_.taken(slot)) sum += pairs_.front_size(slot);
    return sum;
  }

 private:
  template <class Counter, class MakeQuery, class Take, class Leave>
  void update_by_slots(Counter& counter, MakeQuery&& make, Take& take, Leave& leave) {
    using Query = std::remove_cvref_t<decltype(make(0, ObjectPair()))>;
    pairs_.template begin<Query>(near_.movers(), near_.poses(), near_.origin(), near_.threads());
    near_.update([&](std::uint32_t i) { pairs_.set_pose(i); },
                 [&](std::uint32_t slot, const ObjectPair& pair) { pairs_.put(slot, pair); },
                 [&](std::uint32_t slot) { leave(slot), pairs_.drop(slot); });
    answers_.run_pairs(pairs_, near_.threads(), near_.due(), near_.slots(), counter, make, take);
    queried_ = near_.due().size();
    near_.settle();
  }

  Pairs pairs_;
  NearPairs<Method> near_;
  AnswersInOrder answers_;
  std::size_t queried_ = 0;
};

/// The touching pairs, as a list that changes only where answers change.
class TouchingPairs {
 public:
  void put(std::uint32_t slot, const ObjectPair& pair, bool touching) {
    if (slot >= index_.size()) index_.resize(slot + 1, none);
    if (touching == (index_[slot] != none)) return;
    if (!touching) return drop(slot);
    index_[slot] = static_cast<std::uint32_t>(pairs_.size());
    pairs_.push_back(pair);
    slots_.push_back(slot);
  }
  void drop(std::uint32_t slot) {
    if (slot >= index_.size() || index_[slot] == none) return;
    const std::uint32_t index = index_[slot];
    pairs_[index] = pairs_.back(), slots_[index] = slots_.back();
    index_[slots_[index]] = index;
    index_[slot] = none;
    pairs_.pop_back(), slots_.pop_back();
  }
  /// The touching pairs, in any order.
  std::span<const ObjectPair> pairs() const { return pairs_; }

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  std::vector<std::uint32_t> index_;  // the index of each slot's pair
  std::vector<ObjectPair> pairs_;
  std::vector<std::uint32_t> slots_;
};

/// The contacts of all pairs of a world. Pairs of which no body has moved keep theirs:
///
///   world.update(
///       counter,
///       [&](const ObjectPair& pair, std::uint32_t slot) { return contacts.query(pair, slot); },
///       [](std::uint32_t, const ObjectPair&, const Contacts&) {},
///       [&](std::uint32_t slot) { contacts.drop(slot); });
///
/// After an exception the contacts are incomplete until the next update.
class WorldContacts {
 public:
  /// The query for the contacts of the pair in a slot. May be called on any thread; all else only
  /// between updates, or by `leave`.
  Contacts query(const ObjectPair& pair, std::uint32_t slot,
                 TriangleTest test = intersect_batch<Exact>) {
    OfPair& of_pair = [&]() -> OfPair& {
      while (busy_.test_and_set(std::memory_order_acquire)) sched_yield();
      const UnlessDone release([&] { busy_.clear(std::memory_order_release); });
      if (slot >= of_slot_.size()) of_slot_.resize(slot + 1);
      return of_slot_[slot];
    }();
    of_pair.pair = pair;
    of_pair.contacts.clear();
    return Contacts(of_pair.contacts, test);
  }
  void drop(std::uint32_t slot) {
    if (slot < of_slot_.size()) of_slot_[slot].contacts.clear();
  }
  /// Calls visit(pair, contacts) for each pair that touches, in any order; contacts is a span of
  /// Contact.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (const OfPair& each : of_slot_)
      if (!each.contacts.empty()) visit(each.pair, std::span<const Contact>(each.contacts));
  }

 private:
  struct OfPair {
    ObjectPair pair;
    std::vector<Contact> contacts;
  };
  std::atomic_flag busy_;  // libc++ has no std::mutex where it has no threads
  std::deque<OfPair> of_slot_;  // a deque: queries refer to its elements while it grows
};

}  // namespace bvlab
