// SPDX-License-Identifier: BSD-3-Clause
/// All pairs of triangles, one of each surface, that share a point: each once, in any order.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "hierarchies/bounding_volume.hpp"
#include "traversal/primitives/triangle_intersection.hpp"
#include "traversal/queries/candidate.hpp"

namespace bvlab {

/// Triangle of the first mesh, triangle of the second.
using Contact = std::array<std::uint32_t, 2>;

class Contacts {
 public:
  static constexpr std::string_view name = "contacts";
  static constexpr std::string_view description = "all pairs of triangles that share a point";
  static constexpr std::size_t patience = 15;

  /// Contacts are appended to `found`.
  explicit Contacts(std::vector<Contact>& found, TriangleTest test = intersect_batch<Exact>)
      : test_(test), found_(found) {}

  template <class P>
  auto excludes(const P& a, const P& b) const {
    return disjoint(a, b);
  }

  Outcome primitives(std::span<const Candidate> pending) {
    for_each_hit(pending, test_, [&](std::size_t i) {
      found_.push_back({pending[i].a, pending[i].b});
      return false;
    });
    return {};
  }

 private:
  TriangleTest test_;
  std::vector<Contact>& found_;
};

}  // namespace bvlab
