// SPDX-License-Identifier: BSD-3-Clause
/// The tests of all pairs of triangles of two leaves, in the lanes of a step. They are inlined: a
/// function that is called waits for the pair of nodes to be in memory, and touching on `siblings`
/// takes up to 1.66 of the time (AVX-512).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hierarchies/wide/lanes.hpp"
#include "traversal/primitives/triangle_filter.hpp"
#include "traversal/primitives/triangle_gap.hpp"

namespace bvlab {

/// The lanes whose triangles certainly meet, or certainly do not.
struct VerdictLanes {
  std::uint64_t meeting = 0, apart = 0;
};

/// `triangles` has the members of a kernel's triangles (siblings_kernel.hpp), whose coordinates are
/// off by `off`. S are the registers of their lanes.
template <Batched S, std::size_t parts, class Triangles>
[[gnu::always_inline]] inline VerdictLanes verdicts(const Triangles& triangles, float off) {
  VerdictLanes found;
  for_each_part<S, parts>(
      triangles.lanes(), [&](std::size_t part) __attribute__((always_inline)) {
        const auto [x, y] = triangles.corners(part);
        const auto verdict = certainly_within<S>(x, y, S(off));
        found.meeting |= bits(verdict.meeting) << (part * S::size());
        found.apart |= bits(verdict.apart) << (part * S::size());
      });
  return found;
}

/// Lower bounds on the distances, as by triangle_gap. Registers without a lane in use may be left
/// as they are.
template <Batched S, std::size_t parts, class Triangles>
[[gnu::always_inline]] inline std::array<S, parts> triangle_gaps(const Triangles& triangles,
                                                                 float off) {
  std::array<S, parts> gaps;
  for_each_part<S, parts>(
      triangles.lanes(), [&](std::size_t part) __attribute__((always_inline)) {
        const auto [x, y] = triangles.corners(part);
        gaps[part] = triangle_gap<S>(x, y, S(off));
      });
  return gaps;
}

}  // namespace bvlab
