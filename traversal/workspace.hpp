// SPDX-License-Identifier: BSD-3-Clause
/// Room that is used again from one traversal to the next, for all pairs of bodies.
#pragma once

#include <any>
#include <deque>
#include <utility>
#include <vector>

#include "traversal/open_pairs.hpp"
#include "traversal/queries/candidate.hpp"

namespace bvlab {

struct Workspace {
  OpenPairs open;
  std::vector<Candidate> pending;

  /// What a front needs while it is swept and no longer: one object of each type that is asked for,
  /// as it was left.
  template <class T>
  T& room() {
    for (std::any& each : rooms)
      if (T* found = std::any_cast<T>(&each)) return *found;
    return rooms.emplace_back().emplace<T>();
  }
  std::deque<std::any> rooms;
};

}  // namespace bvlab
