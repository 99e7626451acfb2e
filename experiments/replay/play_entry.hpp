// SPDX-License-Identifier: BSD-3-Clause
/// A strategy under a query, as the program sees it while it runs: names, and functions that were
/// compiled for it by themselves.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "experiments/replay/replay.hpp"
#include "experiments/replay/volume_entry.hpp"
#include "experiments/replay/world_frames.hpp"

namespace bvlab {

struct PlayEntry {
  std::string_view strategy, strategy_description, query, query_description;
  /// Throws Unusable where the strategy's parameter in "name:parameter" is none.
  void (*check)(std::string_view strategy);
  /// Adds to the result; hierarchies are of the volume.
  void (*play)(const VolumeEntry& volume, std::shared_ptr<const AnyHierarchies> hierarchies,
               std::span<const TriangleMesh> meshes, const Trace& trace, const Variant& variant,
               const ReplayOptions& options, ReplayResult& result);
  /// A whole scene of that strategy; null for a query that is not answered by yes or no.
  std::unique_ptr<WorldEngine> (*world)(const VolumeEntry& volume,
                                        std::shared_ptr<const AnyHierarchies> hierarchies,
                                        std::size_t objects, const Variant& variant, int threads);
};

}  // namespace bvlab
