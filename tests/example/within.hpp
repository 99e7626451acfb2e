// SPDX-License-Identifier: BSD-3-Clause
/// A query from outside the list: whether two surfaces are within a distance of each other. The
/// program asks about 0.05, in units of the meshes.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "hierarchies/bounding_volume.hpp"
#include "traversal/primitives/triangle_distance.hpp"
#include "traversal/queries/candidate.hpp"

namespace bvlab {

class Within {
 public:
  static constexpr std::string_view name = "within";
  static constexpr std::string_view description = "are the surfaces within d of each other";
  static constexpr std::size_t buffer_size = 7;
  static constexpr bool one_hit_is_enough = true;

  explicit Within(double d) : d_(d) {}
  static Within from_options(const QueryOptions&) { return Within(0.05); }

  template <class P>
  auto culls(const P& a, const P& b) const {
    using S = decltype(gap(a, b));
    return gap(a, b) > S(rounded_up<Element<S>>(d_));
  }
  Outcome primitives(std::span<const Candidate> pending) {
    std::vector<Verdict> verdicts(pending.size());
    return primitives(pending, verdicts);
  }
  /// The margin of a verdict is how far the distance is from the limit.
  Outcome primitives(std::span<const Candidate> pending, std::span<Verdict> verdicts) {
    for (std::size_t i = 0; i < pending.size(); ++i) {
      const double x = distance(*pending[i].triangle_a, *pending[i].triangle_b).distance;
      verdicts[i] = {std::abs(x - d_) * (1 - 1e-12), x <= d_};
      if (x <= d_) return {.witness = i, .satisfied = within_ = true};
    }
    return {};
  }
  double limit() const { return d_; }
  bool known(std::uint32_t, std::uint32_t) { return within_ = true; }
  bool answer() const { return within_; }

 private:
  double d_;
  bool within_ = false;
};

}  // namespace bvlab
