// SPDX-License-Identifier: BSD-3-Clause
/// Where a peer's answers differ from ours, and who is right: decided without any hierarchy, over
/// all pairs of triangles whose boxes overlap, by CGAL's exact predicates. "Right" is meant for the
/// vertices as Pose moves them into float64; a peer that rounds elsewhere may be right about the
/// vertices that it sees.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "experiments/replay/replay.hpp"

namespace bvlab {

struct Disagreement {
  std::uint32_t frame, i, j;
  /// Triangles of i and j, where contacts are compared; empty otherwise.
  std::string triangle_i, triangle_j;
  /// 0 or 1, or a distance.
  std::string theirs, ours, exact;
};

/// How far a distance may be off that was computed in other frames than ours: positions of `reach`
/// from the origin are off by some roundings, and so is what lies between them.
double distance_slack(std::span<const TriangleMesh> meshes, const Trace& trace);

/// How many answers differ; distances by more than 1e-12 of themselves and `slack`.
std::size_t differing(const ReplayResult& theirs, const ReplayResult& ours, double slack);

/// The first `most` of those.
std::vector<Disagreement> disagreements(std::span<const TriangleMesh> meshes, const Trace& trace,
                                        const ReplayResult& theirs, const ReplayResult& ours,
                                        double slack, std::size_t most);

}  // namespace bvlab
