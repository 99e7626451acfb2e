// SPDX-License-Identifier: BSD-3-Clause
/// A query, as the program sees it while it runs: what is done with pairs of any kind under it.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "experiments/replay/made_pairs.hpp"
#include "experiments/replay/world_frames.hpp"

namespace bvlab {

class Trials;

struct QueryEntry {
  std::string_view query;
  /// A replay; all must outlive it.
  std::unique_ptr<detail::Player> (*player)(std::unique_ptr<PairsUnderSome> pairs,
                                            std::span<const TriangleMesh> meshes,
                                            const Trace& trace, const Variant& variant,
                                            const ReplayOptions& options, ReplayResult& result);
  /// A whole scene; null for a query that is not answered by yes or no.
  std::unique_ptr<WorldEngine> (*world)(std::unique_ptr<PairsUnderSome> pairs,
                                        const Variant& variant, int threads);
  /// Pairs of several variants, of which the run finds out the fastest (PairsInTurn).
  std::unique_ptr<PairsUnderSome> (*in_turn)(Trials trials, std::shared_ptr<PairsFrom> from,
                                             std::vector<Variant> variants);
};

}  // namespace bvlab
