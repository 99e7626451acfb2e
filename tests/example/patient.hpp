// SPDX-License-Identifier: BSD-3-Clause
/// A separation list whose entries are not tested again before the bodies can have closed their
/// gaps. The second example of traversal/adding_a_strategy.md, with a front of a kind of its own;
/// it is compiled and keeps all laws, but is not in the list.
#pragma once

#include <algorithm>
#include <limits>
#include <string_view>
#include <vector>

#include "traversal/front.hpp"

namespace bvlab {

/// Every entry rests until the bodies have moved by its gap; one of two leaves never does.
class PatientFront : public Front {
 public:
  static constexpr bool measures_gaps = true;

  /// How far the bodies have moved in all.
  void move(double displacement) { displacement_ = displacement; }

  /// Tests the entries that may be within the query's limit; the others are known to be farther
  /// apart.
  template <class Traversal>
  bool sweep(Traversal& traversal) {
    auto& due = traversal.workspace().template scratch<std::vector<std::size_t>>();
    due.clear();
    for (std::size_t slot = 0; slot < size(); ++slot)
      if (!(rests_until_[slot] > displacement_ + traversal.query().limit())) due.push_back(slot);
    rested_ += size() - due.size();
    return traversal.test_entries(due.size(), [&](std::size_t i) { return due[i]; });
  }

  void keep(std::size_t slot, EntryState state, double gap) {
    rests_until_[slot] = until(state, gap);
  }

  std::size_t add(const NodePair& pair, EntryState state, double gap) {
    const std::size_t slot = Front::add(pair);
    rests_until_.resize(size());
    keep(slot, state, gap);
    return slot;
  }

  void restart() {
    Front::restart();
    rests_until_.assign(1, never);
  }

  /// Without a witness.
  static void finish(std::size_t, bool) {}

  /// How many times an entry has survived a run untested.
  std::size_t rested() const { return rested_; }

 private:
  static constexpr double never = -std::numeric_limits<double>::infinity();

  /// Rounded here and where displacements are added up.
  double until(EntryState state, double gap) const {
    if (state != EntryState::culled) return never;
    return (displacement_ + gap) * (1 - 8 * unit_roundoff<double>);
  }

  std::vector<double> rests_until_;  // of each entry, as a displacement
  double displacement_ = 0;
  std::size_t rested_ = 0;
};

class Patient {
 public:
  static constexpr std::string_view name = "patient";
  static constexpr std::string_view description =
      "separation list whose entries rest until the bodies have moved by their gaps, rebuilt every "
      "k runs (patient:k)";
  using OwnFronts = TypeList<PatientFront>;

  explicit Patient(unsigned k = 50) : period_(k) {}

  template <class Pair>
  void run(const Pair& pair) {
    if (front_.empty() || ++age_ >= period_) front_.restart(), age_ = 0;
    front_.move(pair.a().displacement_bound() + pair.b().displacement_bound());
    pair.from_front(front_);
  }
  const PatientFront& front() const { return front_; }
  std::size_t front_size() const { return front_.size(); }

 private:
  PatientFront front_;
  unsigned period_, age_ = 0;
};

}  // namespace bvlab
