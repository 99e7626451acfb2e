// SPDX-License-Identifier: BSD-3-Clause
/// Decides exactly whether two closed triangles share a point, for any finite corners, including
/// coplanar triangles and those of zero area (segments and points).
///
/// Three stages: a float64 filter (triangle_filter.hpp), double the digits for open pairs of a
/// batch (triangle_refinement.hpp), and exact integers for the rest (exact_intersection.hpp).
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <type_traits>

#include "traversal/primitives/exact_intersection.hpp"
#include "traversal/primitives/gathered_corners.hpp"
#include "traversal/primitives/precisions.hpp"
#include "traversal/primitives/triangle_filter.hpp"
#include "traversal/primitives/triangle_refinement.hpp"

namespace bvlab {

namespace detail {

/// The pairs of a batch that the first stage left open, and their bits in the answer.
struct OpenPairs64 {
  const Triangle *a[64], *b[64];
  std::uint8_t place[64];
  int count = 0;
};

/// Whether registers are wide enough to make the second stage cheaper than integers.
constexpr bool refines_in_batches = native_width<double> >= 8;

/// The second stage, and integers for the rest: bit place[i] is set where pair i shares a point. A
/// template so that it is compiled only where it is needed.
template <int width = 8>
std::uint64_t refined_hits(const OpenPairs64& open) {
  using S = Batch<double, width>;
  std::uint64_t hits = 0;
  for (int first = 0; first < open.count; first += width) {
    const int used = std::min(width, open.count - first);
    std::uint64_t left = (1u << used) - 1;
    // A single pair is faster exactly, and so are all where registers are narrow.
    if (refines_in_batches && used > 1) {
      const Triangle *a[width], *b[width];
      for (int lane = 0; lane < width; ++lane) {
        a[lane] = open.a[first + std::min(lane, used - 1)];
        b[lane] = open.b[first + std::min(lane, used - 1)];
      }
      const auto verdict = certainly_refined<S>(gathered<S>(a), gathered<S>(b));
      for (std::uint64_t meeting = bits(verdict.meeting) & left; meeting; meeting &= meeting - 1)
        hits |= std::uint64_t{1} << open.place[first + std::countr_zero(meeting)];
      left &= ~(bits(verdict.meeting) | bits(verdict.apart));
    }
    for (; left; left &= left - 1) {
      const int i = first + std::countr_zero(left);
      if (exactly_intersect(*open.a[i], *open.b[i])) hits |= std::uint64_t{1} << open.place[i];
    }
  }
  return hits;
}

}  // namespace detail

/// Whether two closed triangles with finite corners share a point. Exact at `Exact`; at a cheaper
/// precision `false` is certain, but `true` may be a pair that it could not decide.
template <class Precision = Exact>
bool intersect(const Triangle& a, const Triangle& b) {
  if constexpr (Precision::has_fallback) {
    return detail::exactly_intersect(a, b);
  } else if constexpr (std::is_same_v<typename Precision::Number, double>) {
    return !certainly<double>(detail::corners_of(a), detail::corners_of(b)).apart;
  } else {
    using Number = typename Precision::Number;
    const auto rounded = [](const Triangle& t) {
      Corners<Number> corners;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) corners[i][j] = static_cast<Number>(t[i][j]);
      return corners;
    };
    return !certainly<Number, CornersAre::rounded>(rounded(a), rounded(b)).apart;
  }
}

/// The number of pairs decided at once in one vector register.
template <class Precision>
constexpr int batch_width = native_width<typename Precision::Number>;

/// The same for `count` (at most 64) pairs (*a[i], *b[i]): bit i is pair i's answer.
template <class Precision = Exact>
std::uint64_t intersect_batch(const Triangle* const* a, const Triangle* const* b, int count) {
  using Number = typename Precision::Number;
  constexpr int width = batch_width<Precision>;
  using S = Batch<Number, width>;
  constexpr auto corners = std::is_same_v<Number, double> ? CornersAre::given : CornersAre::rounded;
  std::uint64_t hits = 0;
  detail::OpenPairs64 open;
  for (int first = 0; first < count; first += width) {
    const Triangle *a_lanes[width], *b_lanes[width];
    const int used = std::min(width, count - first);
    for (int lane = 0; lane < width; ++lane) {
      a_lanes[lane] = a[first + std::min(lane, used - 1)];
      b_lanes[lane] = b[first + std::min(lane, used - 1)];
    }
    const auto verdict =
        certainly<S, corners>(detail::gathered<S>(a_lanes), detail::gathered<S>(b_lanes));
    const std::uint64_t lanes = (std::uint64_t{1} << used) - 1;
    const std::uint64_t met = bits(verdict.meeting) & lanes;
    std::uint64_t left = ~(bits(verdict.apart) | met) & lanes;
    hits |= met << first;
    if constexpr (Precision::has_fallback) {
      for (; left; left &= left - 1) {
        const int lane = std::countr_zero(left);
        open.a[open.count] = a_lanes[lane], open.b[open.count] = b_lanes[lane];
        open.place[open.count++] = static_cast<std::uint8_t>(first + lane);
      }
    } else {
      hits |= left << first;
    }
  }
  if constexpr (Precision::has_fallback)
    if (open.count > 0) hits |= detail::refined_hits(open);
  return hits;
}

}  // namespace bvlab
