// SPDX-License-Identifier: BSD-3-Clause
/// The basic recursive algorithm: from the two roots in every run, nothing kept.
/// A run without a hit that ends in n pairs makes 2n - 1 tests.
#pragma once

#include <string_view>

#include "traversal/traverse.hpp"

namespace bvlab {

struct Recursive {
  static constexpr std::string_view name = "recursive";
  static constexpr std::string_view description = "from the roots in every run";

  template <class B, class V, class Query, class Counter>
  void run(Body<V>& a, Body<V>& b, Query& query, Counter& counter, Workspace& workspace) {
    traverse<B>(a, b, query, counter, workspace);
  }

  std::size_t front_size() const { return 0; }
};

}  // namespace bvlab
