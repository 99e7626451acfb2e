// SPDX-License-Identifier: BSD-3-Clause
/// Do the two surfaces share a point? Stops at the first pair of triangles that do.
#pragma once

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
  static constexpr std::size_t patience = 0;

  template <class P>
  auto excludes(const P& a, const P& b) const {
    return disjoint(a, b);
  }

  std::size_t primitives(std::span<const Candidate> pending) {
    for (std::size_t i = 0; i < pending.size(); ++i)
      if (intersect(*pending[i].triangle_a, *pending[i].triangle_b)) {
        touching_ = true;
        return i;
      }
    return pending.size();
  }

  bool touching() const { return touching_; }

 private:
  bool touching_ = false;
};

}  // namespace bvlab
