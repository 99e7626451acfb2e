// SPDX-License-Identifier: BSD-3-Clause
/// The last answer of a pair of bodies, which is valid while neither moves. The parameters of a
/// query must not change between runs.
#pragma once

#include <cstdint>
#include <string_view>

#include "traversal/queries/query.hpp"
#include "traversal/tracked_front.hpp"

namespace bvlab {

class LastAnswer {
 public:
  /// Passes the last answer to the query if it is kept and nothing has moved since; returns whether
  /// that was so. Must be called first in each run, since `remember` keeps an answer for the poses
  /// and the query that were seen here.
  template <class Pair>
  bool repeat(const Pair& pair) {
    using Query = typename Pair::Query;
    const std::uint32_t a = pair.a().epoch(), b = pair.b().epoch();
    const bool same = known_ && a == epoch_a_ && b == epoch_b_ && query_ == &Query::name;
    if constexpr (requires { pair.query().nearest(); }) {
      if (same) pair.query().repeat(nearest_);
    } else if constexpr (YesOrNoByOneHit<Query>) {
      if (same && touching_) pair.query().known(0, 0);  // the triangles are not part of the answer
    }
    epoch_a_ = a, epoch_b_ = b;
    query_ = &Query::name;
    return same;
  }

  /// Keeps the answer if it is a yes or no or a number, or if no triangles were tested.
  template <class Pair>
  void remember(const Pair& pair, const TraversalStatistics& statistics) {
    auto& query = pair.query();
    if constexpr (requires { query.nearest(); })
      known_ = true, nearest_ = query.nearest();
    else if constexpr (YesOrNoByOneHit<typename Pair::Query>)
      known_ = true, touching_ = query.answer();
    else
      known_ = statistics.everything && statistics.triangles == 0;
  }
  void remember_touching() { known_ = touching_ = true; }
  void forget() { known_ = false; }

 private:
  bool known_ = false, touching_ = false;
  std::uint32_t epoch_a_ = 0, epoch_b_ = 0;
  const std::string_view* query_ = nullptr;
  NearestTriangles nearest_;
};

}  // namespace bvlab
