// SPDX-License-Identifier: BSD-3-Clause
/// Recursion that tests first what decided the last run: two leaves, the witness. They hold the
/// triangles that touched, or those that were nearest to each other. Where the bodies have hardly
/// moved, the witness is a hit again, or its distance is nearly the answer, so that most of the
/// recursion is culled. PQP keeps the last two triangles for the same reason (larsen2000fast).
/// Nothing else is kept, so fast motion costs one test of two leaves at most.
///
/// Both nodes of a pair are descended at once (NoFrontBoth). For contacts there is no witness: all
/// of them are sought.
#pragma once

#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "traversal/no_front.hpp"

namespace bvlab {

/// A front without entries that remembers the leaves which decided a run.
class WitnessedRoots : public NoFrontBoth {
 public:
  Start start = Start::roots;  ///< of the next run

  /// Whether there is a witness: then a query that wants a bound gets it from that.
  bool witnessed() const { return known_; }

  template <class Traversal>
  bool sweep(Traversal& traversal) {
    near_.clear();
    if constexpr (Traversal::Query::one_hit_is_enough)
      if (known_) {
        traversal.hold(witness_, add(witness_, EntryState::near, 0));
        if (traversal.flush()) return true;
      }
    return NoFront(std::exchange(start, Start::roots)).sweep(traversal);
  }

  /// Leaves get a slot for the run, for the query to name the witness by.
  std::size_t add(const NodePair& pair, EntryState state, double) {
    if (state != EntryState::near) return Outcome::none;
    near_.push_back(pair);
    return near_.size() - 1;
  }
  void finish(std::size_t witness, bool) {
    if (witness == Outcome::none) return;
    witness_ = near_[witness], known_ = true;
  }

 private:
  std::vector<NodePair> near_;  // the leaves of this run whose volumes are near each other
  NodePair witness_{};
  bool known_ = false;
};

class Witness {
 public:
  static constexpr std::string_view name = "witness";
  static constexpr std::string_view description =
      "from the roots, both nodes of a pair descended at once, after the two leaves that decided "
      "the last run";

  template <class Pair>
  void run(const Pair& pair) {
    pair.from_front(front_);
  }

  bool starts_at_roots() const { return !front_.witnessed(); }
  static void roots_are_apart() {}
  template <class Pair>
  void run_below_roots(const Pair& pair) {
    front_.start = Start::below_roots;
    pair.from_front(front_);
  }

  std::size_t front_size() const { return 0; }

 private:
  WitnessedRoots front_;
};

}  // namespace bvlab
