// SPDX-License-Identifier: BSD-3-Clause
/// What is best where nothing is known, for asking whether and where bodies touch: boxes with a
/// slab in wide trees, as many children a node as a register has lanes, compared in the bodies' own
/// frames, with margins from frame to frame. `bvlab replay --recommended` is the same; distances
/// are best bounded by swept rectangles in binary trees (see rss.hpp).
#pragma once

#include <algorithm>
#include <span>

#include "hierarchies/builds.hpp"
#include "hierarchies/wide/slab_box_facing.hpp"
#include "traversal/wide/wide_pairs.hpp"

namespace bvlab {

struct Recommended {
  using Volume = SlabBox<float>;
  /// A wider node would be tested in several steps; none is narrower than two.
  static constexpr int fan_out = std::clamp(native_width<float>, 2, 16);
  using Hierarchy = WideHierarchy<Volume, fan_out>;
  using Shape = WideShape<Volume, fan_out>;
  using Pairs = WidePairs<Volume, fan_out, RelativeFrame, WideMargins>;

  /// One for each mesh, whatever number of bodies has it.
  static Hierarchy hierarchy(const TriangleMesh& mesh, int threads = 1) {
    Threads several(threads);
    return Hierarchy(mesh, builds::TopDownSurfaceArea::topology(mesh, 1, several), Fit::published,
                     fan_out, several);
  }
};

}  // namespace bvlab
