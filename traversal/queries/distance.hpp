// SPDX-License-Identifier: BSD-3-Clause
/// The query for the distance of two surfaces; 0 where they touch.
///
/// A pair of volumes is culled once its gap cannot make the answer smaller by more than the
/// relative error allowed (quinlan1994efficient): the answer d satisfies D <= d <= (1 + a) D for
/// the true distance D, up to 2^-45 of it and the rounding of one triangle distance (see
/// triangle_distance.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <span>
#include <string_view>

#include "hierarchies/bounding_volume.hpp"
#include "traversal/primitives/gathered_corners.hpp"
#include "traversal/primitives/triangle_distance.hpp"
#include "traversal/primitives/triangle_distance_bound.hpp"
#include "traversal/queries/candidate.hpp"

namespace bvlab {

class Distance {
 public:
  static constexpr std::string_view name = "distance";
  static constexpr std::string_view description =
      "how far apart the two surfaces are; within --relative-error above the truth";
  static constexpr std::size_t buffer_size = 7;
  static constexpr bool one_hit_is_enough = true;
  /// The traversal looks for a small upper bound before it starts.
  static constexpr bool wants_bound = true;

  explicit Distance(double relative_error = 0) : relative_error_(relative_error) {}

  static Distance from_options(const QueryOptions& options) {
    return Distance(options.relative_error);
  }

  template <class P>
  auto culls(const P& a, const P& b) const {
    return culls(gap(a, b));
  }
  /// The same by the gap of two volumes.
  template <Scalar S>
  auto culls(const S& gap) const {
    return gap >= S(rounded_up<Element<S>>(limit_));
  }

  Outcome primitives(std::span<const Candidate> pending) {
    Outcome outcome;
    for (std::size_t first = 0; first < pending.size() && !outcome.satisfied; first += at_once) {
      const std::size_t count = std::min(at_once, pending.size() - first);
      std::array<double, at_once> lower{};
      if (limit_ < std::numeric_limits<double>::infinity()) lower = bounds(&pending[first], count);
      measure(pending, first, std::span(lower).first(count), outcome);
    }
    return outcome;
  }

  /// Margins are lower bounds of distances: candidates whose margin cannot improve the answer are
  /// not measured.
  Outcome primitives(std::span<const Candidate> pending, std::span<Verdict> verdicts) {
    Outcome outcome;
    with_margins(pending, verdicts, intersect_batch<Exact>,
                 [&](std::size_t first, std::size_t count, std::uint64_t hits) {
                   if (hits) {
                     const auto i = first + static_cast<std::size_t>(std::countr_zero(hits));
                     outcome = {.witness = i, .satisfied = known(pending[i].a, pending[i].b)};
                     return true;
                   }
                   std::array<double, verdicts_at_once> lower{};
                   for (std::size_t i = 0; i < count; ++i) lower[i] = verdicts[first + i].margin;
                   measure(pending, first, std::span(lower).first(count), outcome);
                   return outcome.satisfied;
                 });
    return outcome;
  }

  double limit() const { return limit_; }
  bool known(std::uint32_t a, std::uint32_t b) {
    nearest_ = {0, a, b};
    limit_ = 0;
    return true;
  }
  /// Sets the answer to the last one; nothing has moved since.
  void repeat(const NearestTriangles& nearest) { nearest_ = nearest; }

  /// In units of the meshes; infinity before any candidate was tested.
  double distance() const { return nearest_.distance; }
  double answer() const { return nearest_.distance; }
  /// Triangles of the two bodies that are distance() apart; of several such pairs any. Their
  /// nearest points: nearest_points.hpp.
  const NearestTriangles& nearest() const { return nearest_; }

 private:
  static constexpr std::size_t at_once = native_width<double>;
  /// Distances that differ by less than this relative amount count as equal: the nearest point of a
  /// mesh is most often a corner of six triangles, which would otherwise all be measured.
  static constexpr double alike = 0x1p-45;

  /// Measures candidates in the order of their lower bounds, until the least bound cannot improve
  /// the answer.
  void measure(std::span<const Candidate> pending, std::size_t first, std::span<double> lower,
               Outcome& outcome) {
    while (!outcome.satisfied) {
      const std::size_t i =
          static_cast<std::size_t>(std::min_element(lower.begin(), lower.end()) - lower.begin());
      if (!(lower[i] < limit_)) return;
      lower[i] = std::numeric_limits<double>::infinity();
      const auto& candidate = pending[first + i];
      const double d = bvlab::distance(*candidate.triangle_a, *candidate.triangle_b).distance;
      if (!(d < nearest_.distance)) continue;
      nearest_ = {d, candidate.a, candidate.b};
      limit_ = std::max(d / (1 + relative_error_) * (1 - alike),
                        std::numeric_limits<double>::denorm_min());
      outcome = {.witness = first + i, .satisfied = d == 0};
    }
  }

  static std::array<double, at_once> bounds(const Candidate* candidates, std::size_t count) {
    using S = Batch<double, at_once>;
    const Triangle *a[at_once], *b[at_once];
    for (std::size_t lane = 0; lane < at_once; ++lane) {
      const Candidate& candidate = candidates[std::min(lane, count - 1)];
      a[lane] = candidate.triangle_a, b[lane] = candidate.triangle_b;
    }
    std::array<double, at_once> lower;
    distance_bound<S>(detail::gathered<S>(a), detail::gathered<S>(b))
        .copy_to(lower.data(), stdx::element_aligned);
    return lower;
  }

  double relative_error_;
  NearestTriangles nearest_;
  double limit_ = std::numeric_limits<double>::infinity();
};

}  // namespace bvlab
