// SPDX-License-Identifier: BSD-3-Clause
/// A kinetic separation list (weller2006kinetic, with bounds on motion in place of flight plans):
/// the entries stand in a heap, ordered by the motion at which their gaps may be closed, and a run
/// tests those whose time has come. The second example of traversal/adding_a_strategy.md, with a
/// front of a kind of its own; it is compiled and keeps all laws, but is not in the list.
#pragma once

#include <functional>
#include <limits>
#include <queue>
#include <string_view>
#include <utility>
#include <vector>

#include "traversal/front.hpp"

namespace bvlab {

/// Every entry rests until the bodies have moved by its gap; one of two leaves never does.
class KineticFront : public Front {
 public:
  static constexpr bool measures_gaps = true;

  /// How far the bodies have moved in all.
  void move(double displacement) { displacement_ = displacement; }

  /// Tests the entries that may be within the query's limit; the others are known to be farther
  /// apart.
  template <class Traversal>
  bool sweep(Traversal& traversal) {
    due_.clear();
    const double reached = displacement_ + traversal.query().limit();
    for (; !waiting_.empty() && !(waiting_.top().first > reached); waiting_.pop())
      due_.push_back(waiting_.top().second), waits_[due_.back()] = false;
    rested_ += waiting_.size();
    return traversal.test_entries(due_.size(), [this](std::size_t i) { return due_[i]; });
  }

  /// An entry is kept twice only where it is of two leaves.
  void keep(std::size_t slot, EntryState state, double gap) {
    if (waits_[slot]) return;
    waiting_.emplace(until(state, gap), slot);
    waits_[slot] = true;
  }

  std::size_t add(const NodePair& pair, EntryState state, double gap) {
    const std::size_t slot = Front::add(pair);
    waits_.resize(size());
    keep(slot, state, gap);
    return slot;
  }

  /// Without a witness. Entries that a hit left untested remain due.
  void finish(std::size_t, bool) {
    for (const std::size_t slot : due_)
      if (!waits_[slot]) keep(slot, EntryState::not_yet, 0);
  }

  void restart() {
    Front::restart();
    waiting_ = {}, waits_.assign(1, false);
    keep(0, EntryState::not_yet, 0);
  }

  /// How many times an entry has survived a run untested.
  std::size_t rested() const { return rested_; }

 private:
  static constexpr double never = -std::numeric_limits<double>::infinity();

  /// Rounded here and where displacements are added up.
  double until(EntryState state, double gap) const {
    if (state != EntryState::culled) return never;
    return (displacement_ + gap) * (1 - 8 * unit_roundoff<double>);
  }

  using Expiry = std::pair<double, std::size_t>;  // the displacement at which it ends; the slot
  std::priority_queue<Expiry, std::vector<Expiry>, std::greater<>> waiting_;
  std::vector<bool> waits_;  // whether the entry in a slot stands in the heap
  std::vector<std::size_t> due_;
  double displacement_ = 0;
  std::size_t rested_ = 0;
};

class KineticList {
 public:
  static constexpr std::string_view name = "kinetic-list";
  static constexpr std::string_view description =
      "separation list in a heap: entries rest until the bodies have moved by their gaps; rebuilt "
      "every k runs (kinetic-list:k)";

  explicit KineticList(unsigned k = 50) : period_(k) {}

  template <class Pair>
  void run(const Pair& pair) {
    if (front_.empty() || ++age_ >= period_) front_.restart(), age_ = 0;
    front_.move(pair.a().displacement_bound() + pair.b().displacement_bound());
    pair.from_front(front_);
  }
  const KineticFront& front() const { return front_; }
  std::size_t front_size() const { return front_.size(); }

 private:
  KineticFront front_;
  unsigned period_, age_ = 0;
};

}  // namespace bvlab
