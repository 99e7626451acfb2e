// SPDX-License-Identifier: BSD-3-Clause
/// The fronts without entries: every run starts from the roots.
#pragma once

#include <cstddef>

#include "traversal/tracked_front.hpp"

namespace bvlab {

/// Whether the two roots are to be tested, or are known to overlap.
enum class Start { roots, below_roots };

class NoFront : public FrontDefaults {
 public:
  explicit NoFront(Start start = Start::roots) : start_(start) {}

  template <class Traversal>
  [[gnu::always_inline]] bool sweep(Traversal& traversal) const {
    if (start_ == Start::below_roots)
      traversal.enter({0, 0});
    else
      traversal.push({0, 0});
    return false;
  }

  // There are no entries.
  NodePair operator[](std::size_t) const { return {}; }
  static void open(std::size_t) {}
  static std::size_t add(const NodePair&, EntryState, double) { return Outcome::none; }

 private:
  Start start_;
};

/// The same, but a pair of inner nodes is replaced by all pairs of their children (four on binary
/// trees).
class NoFrontBoth : public NoFront {
 public:
  using NoFront::NoFront;

  template <class Node>
  static constexpr Descent descent(const Node& a, const Node& b) {
    return !a.count && !b.count ? Descent::both : into_larger(a, b);
  }
};

}  // namespace bvlab
