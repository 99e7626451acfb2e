// SPDX-License-Identifier: BSD-3-Clause
/// A trace played through the engine with a budget of volume tests for each pair and frame, and no
/// more: see traversal/budgeted.hpp.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "experiments/replay/replay.hpp"

namespace bvlab {

struct BudgetedResult {
  double seconds = 0;        ///< posing and answering every frame
  double first_seconds = 0;  ///< the first frame alone
  double build_seconds = 0;
  std::uint64_t n_u = 0, n_v = 0, n_p = 0;
  std::uint64_t touching = 0, apart = 0, unknown = 0;
  double deepest = 0;       ///< the largest bound where it is not known, in units of the mesh
  double mean_deepest = 0;  ///< over all answers; 0 where it is known
  std::vector<std::uint8_t> known;  ///< (frames, pairs): 0 apart, 1 touching, 2 not yet known
  std::vector<double> bounds;       ///< (frames, pairs)
};

/// Of the variant, strategy and query play no part. Throws Unusable for unknown names.
BudgetedResult replay_budgeted(std::span<const TriangleMesh> meshes, const Trace& trace,
                               const Variant& variant, std::uint64_t budget, Count count);

}  // namespace bvlab
