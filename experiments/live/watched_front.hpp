// SPDX-License-Identifier: BSD-3-Clause
/// A front that tells which of its entries a run has tested: those that a page lights. The members
/// are those of any tracked front (tracked_front.hpp). A run that nobody watches pays a comparison
/// for each entry.
#pragma once

#include <span>
#include <vector>

#include "traversal/tracked_front.hpp"

namespace bvlab {

template <class Front>
class WatchedFront {
 public:
  static constexpr bool measures_gaps = Front::measures_gaps;
  static constexpr std::size_t held_at_least = Front::held_at_least;

  /// Entries are noted in `tested`, null where nobody watches; as pairs, since slots change when
  /// the run ends.
  WatchedFront(Front& front, std::vector<NodePair>* tested) : front_(front), tested_(tested) {}

  template <class Traversal>
  bool sweep(Traversal& traversal) {
    return front_.sweep(traversal);
  }
  decltype(auto) operator[](std::size_t slot) const { return front_[slot]; }
  void keep(std::size_t slot, EntryState state, double gap) {
    front_.keep(slot, state, gap);
    if (tested_ && state != EntryState::not_yet) tested_->push_back(front_[slot]);
  }
  void open(std::size_t slot) { front_.open(slot); }
  std::size_t add(const NodePair& pair, EntryState state, double gap) {
    if (tested_ && state != EntryState::not_yet) tested_->push_back(pair);
    return front_.add(pair, state, gap);
  }
  void finish(std::size_t witness, bool satisfied) { front_.finish(witness, satisfied); }
  bool witnessed() const { return front_.witnessed(); }
  template <class Query, class Node>
  bool opens(const Query& query, const Node& a, const Node& b, double gap) {
    return front_.opens(query, a, b, gap);
  }
  template <class Node>
  Descent descent(const Node& a, const Node& b) const {
    return front_.descent(a, b);
  }
  template <class Query>
  Outcome primitives(Query& query, std::span<const Candidate> pending, Workspace& workspace) {
    return front_.primitives(query, pending, workspace);
  }

 private:
  Front& front_;
  std::vector<NodePair>* tested_;
};

}  // namespace bvlab
