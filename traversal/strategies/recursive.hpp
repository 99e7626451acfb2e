// SPDX-License-Identifier: BSD-3-Clause
/// The basic recursive algorithm: every run starts from the two roots, and nothing is kept.
/// A run without a hit that ends in n pairs makes 2n - 1 tests on binary trees, and n + (n - 1) /
/// (F - 1) where every opened pair is replaced by F others.
#pragma once

#include <string_view>

#include "traversal/no_front.hpp"

namespace bvlab {

namespace detail {

template <class Roots>
struct FromTheRoots {
  template <class Pair>
  void run(const Pair& pair) {
    pair.template from_roots<Roots>();
  }

  static bool starts_at_roots() { return true; }
  static void roots_are_apart() {}
  template <class Pair>
  void run_below_roots(const Pair& pair) {
    pair.template from_roots<Roots>(Start::below_roots);
  }

  std::size_t front_size() const { return 0; }
};

}  // namespace detail

struct Recursive : detail::FromTheRoots<NoFront> {
  static constexpr std::string_view name = "recursive";
  static constexpr std::string_view description = "from the roots in every run";
};

/// Opens both nodes of a pair at once (NoFrontBoth). With batches that is better: half as many
/// steps wait for each other, and on binary trees where most overlapping pairs have overlapping
/// children, up to a third fewer tests are made ((4n - 1) / 3 for n leaves).
struct RecursiveBoth : detail::FromTheRoots<NoFrontBoth> {
  static constexpr std::string_view name = "recursive-both";
  static constexpr std::string_view description =
      "from the roots in every run, both nodes of a pair descended at once";
};

}  // namespace bvlab
