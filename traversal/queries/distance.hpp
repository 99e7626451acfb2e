// SPDX-License-Identifier: BSD-3-Clause
/// How far apart are the two surfaces? 0 where they touch.
///
/// A pair of volumes is left alone once its gap cannot make the answer smaller by more than the
/// relative error allowed (quinlan1994efficient): the answer d satisfies D <= d <= (1 + a) D for
/// the true distance D, up to the rounding of one triangle distance (see triangle_distance.hpp).
#pragma once

#include <limits>
#include <span>
#include <string_view>

#include "hierarchies/bounding_volume.hpp"
#include "traversal/primitives/triangle_distance.hpp"
#include "traversal/queries/candidate.hpp"

namespace bvlab {

class Distance {
 public:
  static constexpr std::string_view name = "distance";
  static constexpr std::string_view description =
      "how far apart the two surfaces are; within --relative-error above the truth";
  static constexpr std::size_t patience = 0;
  /// The traversal looks for a small upper bound before it starts.
  static constexpr bool wants_bound = true;

  explicit Distance(double relative_error = 0) : relative_error_(relative_error) {}

  template <class P>
  auto excludes(const P& a, const P& b) const {
    using S = decltype(gap(a, b));
    return gap(a, b) >= S(rounded_up<Element<S>>(limit_));
  }

  Outcome primitives(std::span<const Candidate> pending) {
    Outcome outcome;
    for (std::size_t i = 0; i < pending.size() && !outcome.enough; ++i) {
      const double d = bvlab::distance(*pending[i].triangle_a, *pending[i].triangle_b).distance;
      if (!(d < distance_)) continue;
      distance_ = d;
      // The factor pays for the two roundings, so that no pair is left alone too early.
      limit_ = d / (1 + relative_error_) * (1 + 4 * unit_roundoff<double>);
      outcome = {.witness = i, .enough = d == 0};
    }
    return outcome;
  }

  /// In units of the meshes; infinity before anything was seen.
  double distance() const { return distance_; }

 private:
  double relative_error_;
  double distance_ = std::numeric_limits<double>::infinity();
  double limit_ = std::numeric_limits<double>::infinity();
};

}  // namespace bvlab
