// SPDX-License-Identifier: BSD-3-Clause
/// Buffers that are reused from one traversal to the next, for all pairs of bodies.
#pragma once

#include <any>
#include <deque>
#include <vector>

#include "traversal/open_pairs.hpp"
#include "traversal/queries/candidate.hpp"

namespace bvlab {

struct Workspace {
  OpenPairs open;
  std::vector<Candidate> pending;

  /// Scratch space: one object per type T, in the state in which it was last left; valid until the
  /// next traversal with this workspace.
  template <class T>
  T& scratch() {
    for (std::any& each : rooms)
      if (T* found = std::any_cast<T>(&each)) return *found;
    return rooms.emplace_back().emplace<T>();
  }
  std::deque<std::any> rooms;
};

}  // namespace bvlab
