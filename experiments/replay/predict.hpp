// SPDX-License-Identifier: BSD-3-Clause
/// What each strategy would cost on a trace, from recursions and the fronts they leave, without
/// playing the strategy.
///
/// Recursion is counted in every frame. In every `stride`-th frame the front it leaves is kept and
/// run through again in the frames that follow, until every rule for rebuilding would have replaced
/// it. That gives, for each pair of bodies and each rule, the cost of a cycle from one rebuild to
/// the next and its length; the mean cost of a run is the ratio of their sums (the renewal reward
/// theorem; exact for stationary motion and where rebuilds fall on any frame alike). A list that
/// nothing replaces is followed for `longest` runs.
///
/// Margins: of the same fronts the gaps are measured, and an entry of gap g comes up in every
/// (g / step)-th run.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "experiments/replay/replay.hpp"

namespace bvlab {

struct Predicted {
  std::string_view strategy;
  double n_v = 0;      ///< pairs of volumes tested, all frames and pairs
  double n_p = 0;      ///< pairs of triangles
  double seconds = 0;  ///< by the unit costs of `Adaptive`
};

struct PredictOptions {
  std::size_t stride = 4;
  std::size_t longest = 128;
};

/// For the variant's volume, query (touching or contacts), build and leaf size; its strategy does
/// not matter. In the order recursive, recursive-both, separation-list, deferred, by-cost, margins.
std::vector<Predicted> predict(std::span<const TriangleMesh> meshes, const Trace& trace,
                               const Variant& variant, const PredictOptions& options = {});

}  // namespace bvlab
