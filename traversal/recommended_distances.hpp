// SPDX-License-Identifier: BSD-3-Clause
/// The recommended configuration for distances, on any mesh and motion: rectangle swept spheres,
/// which bound the distances of single triangles best (rss.hpp), in binary trees; volumes compared
/// in the frame of one body; and recursion that tests first the leaves that were nearest in the
/// last frame (strategies/witness.hpp). No front pays here: most of what it keeps is nearer than
/// the answer.
#pragma once

#include <span>

#include "hierarchies/builds.hpp"
#include "hierarchies/volumes/rss.hpp"
#include "traversal/strategies/witness.hpp"
#include "traversal/strategy_pairs.hpp"

namespace bvlab {

/// Has the members of the other configurations (recommended.hpp):
///
///     const auto tree = RecommendedDistances::hierarchy(mesh);
///     const std::vector<RecommendedDistances::Shape> shapes(bodies, {&mesh, &tree});
///     AllPairsOf pairs(RecommendedDistances::Pairs(shapes), all_object_pairs(bodies));
struct RecommendedDistances {
  using Volume = Rss<float>;
  using Build = builds::BottomUpLocal;
  using Strategy = Witness;
  static constexpr Fit fit = Fit::tight;
  static constexpr std::uint32_t leaf_size = 1;
  static constexpr Frame frame = Frame::body;
  using Hierarchy = bvlab::Hierarchy<Volume>;
  using Shape = bvlab::Shape<Volume>;

  class Pairs : public StrategyPairs<Bodies<NativeBatch<Volume::scalar>, Volume>, Strategy> {
   public:
    /// One body for each shape; meshes and hierarchies must outlive this.
    explicit Pairs(std::span<const Shape> shapes)
        : StrategyPairs(Bodies<NativeBatch<Volume::scalar>, Volume>(shapes, frame), Strategy()) {}
  };

  /// The hierarchy of a mesh. One serves all bodies of that mesh.
  static Hierarchy hierarchy(const TriangleMesh& mesh, int threads = 1) {
    Threads several(threads);
    return Hierarchy(mesh, Build::topology(mesh, leaf_size, several), fit, several);
  }
};

}  // namespace bvlab
