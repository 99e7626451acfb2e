// SPDX-License-Identifier: BSD-3-Clause
/// What a live page can play, made by name: the program's own players (experiments/replay/played.hpp)
/// over fewer types, since a page is to be small. Volumes and strategies meet as in AnyBodies, so
/// that answers and counts are those of `bvlab replay`.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "experiments/replay/player.hpp"
#include "experiments/replay/volume_entry.hpp"
#include "hierarchies/geometry/type_list.hpp"
#include "hierarchies/volumes/obb.hpp"
#include "hierarchies/volumes/slab_box.hpp"
#include "hierarchies/volumes/sphere.hpp"
#include "traversal/strategies/margins.hpp"
#include "traversal/strategies/raise.hpp"
#include "traversal/strategies/recursive.hpp"
#include "traversal/strategies/separation_list.hpp"
#include "traversal/wide/kernels.hpp"

namespace bvlab::live {

using Volumes = TypeList<Sphere<float>, Obb<float>>;
using Strategies = TypeList<Recursive, SeparationList, Deferred, Raise, Margins>;
/// Volumes of the kernels for wide trees, which take the strategies Recursive and Margins.
using WideVolumes = TypeList<SlabBox<float>>;

/// What is played, frame after frame; it must not move.
struct Run {
  Variant variant;
  ReplayOptions options;
  ReplayResult result;
  std::unique_ptr<AnyHierarchies> hierarchies;  ///< whose volumes are drawn
  std::unique_ptr<detail::Player> player;
  std::size_t watched = static_cast<std::size_t>(-1);  ///< the number of a pair
  std::vector<NodePair> front, tested;                 ///< of that pair, after a frame: its entries
  std::array<double, 6> counts{};       ///< of the last frame, as engine.cpp has them
  std::array<std::uint64_t, 6> sums{};  ///< of all frames so far
};

/// One for each query. Null where there is no such volume, strategy or kernel.
template <class Query>
std::unique_ptr<detail::Player> player(std::span<const TriangleMesh> meshes, const Trace& trace,
                                       Run& run);

}  // namespace bvlab::live
