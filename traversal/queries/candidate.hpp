// SPDX-License-Identifier: BSD-3-Clause
/// A candidate: two primitives whose leaves overlap, held until they are tested; and what queries
/// report about candidates.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>

#include "hierarchies/geometry/triangle_mesh.hpp"
#include "traversal/primitives/triangle_margin.hpp"

namespace bvlab {

struct Candidate {
  const Triangle* triangle_a;  ///< in the world frame
  const Triangle* triangle_b;
  std::uint32_t a, b;  ///< their indices in their meshes
  std::size_t slot;    ///< of the front's entry they come from, if there is a front
};

/// The options of all queries; each uses those that concern it.
struct QueryOptions {
  TriangleTest test = intersect_batch<Exact>;
  double relative_error = 0;  ///< of distances
};

/// The distance of two surfaces, and two triangles that are as far apart.
struct NearestTriangles {
  static constexpr std::uint32_t none = static_cast<std::uint32_t>(-1);
  double distance = std::numeric_limits<double>::infinity();
  std::uint32_t a = none, b = none;  ///< their indices in their meshes; none before any was tested
};

/// What a query found among candidates.
struct Outcome {
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::size_t witness = none;  ///< the index of the one to test first in the next run
  bool satisfied = false;      ///< the query is satisfied by the witness: the traversal can stop
};

/// The verdict on a tested candidate, and its margin: how far the triangles can be moved, relative
/// to each other, before the verdict can change (see triangle_margin.hpp).
struct Verdict {
  double margin = -1;  ///< negative: it was not tested
  bool hit = false;    ///< they share a point
};

/// Calls `hit(i)` for each candidate whose triangles share a point, in order, until it returns
/// true. Returns the index at which it did, or the number of candidates.
template <class Hit>
std::size_t for_each_hit(std::span<const Candidate> pending, TriangleTest test, Hit&& hit) {
  constexpr std::size_t at_once = 16;
  for (std::size_t first = 0; first < pending.size(); first += at_once) {
    const auto block = pending.subspan(first, std::min(at_once, pending.size() - first));
    const Triangle *a[at_once], *b[at_once];
    for (std::size_t i = 0; i < block.size(); ++i)
      a[i] = block[i].triangle_a, b[i] = block[i].triangle_b;
    std::uint64_t hits = test(a, b, static_cast<int>(block.size()));
    for (; hits; hits &= hits - 1) {
      const auto i = first + static_cast<std::size_t>(std::countr_zero(hits));
      if (hit(i)) return i;
    }
  }
  return pending.size();
}

constexpr std::size_t verdicts_at_once = 16;

/// Gives each candidate its verdict, 16 at a time. After each block calls `block(first, count,
/// hits)`, bit i of `hits` being the verdict on candidate `first + i`, until it returns true.
template <class Block>
void with_margins(std::span<const Candidate> pending, std::span<Verdict> verdicts,
                  TriangleTest test, Block&& block) {
  for (std::size_t first = 0; first < pending.size(); first += verdicts_at_once) {
    const std::size_t count = std::min(verdicts_at_once, pending.size() - first);
    const Triangle *a[verdicts_at_once], *b[verdicts_at_once];
    for (std::size_t i = 0; i < count; ++i)
      a[i] = pending[first + i].triangle_a, b[i] = pending[first + i].triangle_b;
    double found[verdicts_at_once];
    const std::uint64_t hits = touching_with_margins(a, b, static_cast<int>(count), test, found);
    for (std::size_t i = 0; i < count; ++i) verdicts[first + i] = {found[i], (hits >> i & 1) != 0};
    if (block(first, count, hits)) return;
  }
}

}  // namespace bvlab
