// SPDX-License-Identifier: BSD-3-Clause
/// The query whether two surfaces share a point; stops at the first pair of triangles that do.
#pragma once

#include <bit>
#include <cstddef>
#include <span>
#include <string_view>

#include "hierarchies/bounding_volume.hpp"
#include "traversal/primitives/triangle_intersection.hpp"
#include "traversal/queries/candidate.hpp"

namespace bvlab {

class Touching {
 public:
  static constexpr std::string_view name = "touching";
  static constexpr std::string_view description = "do the two surfaces share a point, yes or no";
  static constexpr bool culls_disjoint = true;
  static constexpr std::size_t buffer_size = 3;
  static constexpr bool one_hit_is_enough = true;

  explicit Touching(TriangleTest test = intersect_batch<Exact>) : test_(test) {}

  static Touching from_options(const QueryOptions& options) { return Touching(options.test); }

  template <class P>
  auto culls(const P& a, const P& b) const {
    return disjoint(a, b);
  }

  Outcome primitives(std::span<const Candidate> pending) {
    const std::size_t first = for_each_hit(pending, test_, [](std::size_t) { return true; });
    if (first == pending.size()) return {};
    touching_ = true;
    return {.witness = first, .satisfied = true};
  }

  /// Of several hits the one with the largest margin is the witness.
  Outcome primitives(std::span<const Candidate> pending, std::span<Verdict> verdicts) {
    Outcome outcome;
    with_margins(pending, verdicts, test_, [&](std::size_t first, std::size_t, std::uint64_t hits) {
      for (; hits; hits &= hits - 1) {
        const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(hits));
        if (!outcome.satisfied || verdicts[i].margin > verdicts[outcome.witness].margin)
          outcome = {.witness = i, .satisfied = true};
      }
      return outcome.satisfied;
    });
    touching_ = touching_ || outcome.satisfied;
    return outcome;
  }

  double limit() const { return 0; }
  bool known(std::uint32_t, std::uint32_t) { return touching_ = true; }

  bool touching() const { return touching_; }
  bool answer() const { return touching_; }

 private:
  TriangleTest test_;
  bool touching_ = false;
};

}  // namespace bvlab
