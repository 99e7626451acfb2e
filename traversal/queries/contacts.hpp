// SPDX-License-Identifier: BSD-3-Clause
/// The query for all contacts: each pair of triangles that share a point, once, in any order.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "hierarchies/bounding_volume.hpp"
#include "traversal/primitives/triangle_intersection.hpp"
#include "traversal/queries/candidate.hpp"

namespace bvlab {

/// The indices of a triangle of the first mesh and one of the second.
using Contact = std::array<std::uint32_t, 2>;

class Contacts {
 public:
  static constexpr std::string_view name = "contacts";
  static constexpr std::string_view description = "all pairs of triangles that share a point";
  static constexpr bool culls_disjoint = true;
  static constexpr std::size_t buffer_size = 15;
  static constexpr bool one_hit_is_enough = false;

  /// Contacts are appended to `found`. Each pair of bodies needs a list of its own, which stays
  /// where it is until the answer is taken: queries of several pairs run interleaved, or at once.
  explicit Contacts(std::vector<Contact>& found, TriangleTest test = intersect_batch<Exact>)
      : test_(test), found_(found) {}

  static Contacts from_options(const QueryOptions& options, std::vector<Contact>& found) {
    return Contacts(found, options.test);
  }

  template <class P>
  auto culls(const P& a, const P& b) const {
    return disjoint(a, b);
  }

  Outcome primitives(std::span<const Candidate> pending) {
    for_each_hit(pending, test_, [&](std::size_t i) {
      found_.push_back({pending[i].a, pending[i].b});
      return false;
    });
    return {};
  }

  Outcome primitives(std::span<const Candidate> pending, std::span<Verdict> verdicts) {
    with_margins(pending, verdicts, test_, [&](std::size_t first, std::size_t, std::uint64_t hits) {
      for (; hits; hits &= hits - 1) {
        const auto& hit = pending[first + static_cast<std::size_t>(std::countr_zero(hits))];
        known(hit.a, hit.b);
      }
      return false;
    });
    return {};
  }

  double limit() const { return 0; }
  bool known(std::uint32_t a, std::uint32_t b) {
    found_.push_back({a, b});
    return false;
  }

 private:
  TriangleTest test_;
  std::vector<Contact>& found_;
};

}  // namespace bvlab
