// SPDX-License-Identifier: BSD-3-Clause
/// The recommended configuration for distances, on any mesh and motion: rectangle swept spheres,
/// which bound the distances of single triangles best (rss.hpp), up to four children per node, and
/// margins from frame to frame. With the published fit: trees of a tight one take six times as
/// long, and frames a tenth less time.
#pragma once

#include "hierarchies/builds.hpp"
#include "hierarchies/volumes/rss.hpp"
#include "traversal/recommended.hpp"
#include "traversal/wide/mixed_kernel.hpp"

namespace bvlab {

/// As the other configurations:
///
///     const auto tree = RecommendedDistances::hierarchy(mesh);
///     const std::vector<RecommendedDistances::Shape> shapes(bodies, {&mesh, &tree});
///     AllPairsOf pairs(RecommendedDistances::Pairs(shapes), all_object_pairs(bodies));
using RecommendedDistances =
    MarginsOver<WideTrees<Rss<float>, 4, MixedKernel, builds::BottomUpLocal, Fit::published, 4>>;

}  // namespace bvlab
