// SPDX-License-Identifier: BSD-3-Clause
/// Distances of convex meshes by closest features: baselines for what hierarchies do, called like
/// peers. They know solids: where one is inside the other the answer is 0, while surfaces may be
/// apart. Their counts are vertices looked at (n_v) and features or simplices tried (n_p).
#pragma once

#include "experiments/replay/replay.hpp"

namespace bvlab {

enum class ClosestFeatures { gjk, gjk_coherent, v_clip };

template <ClosestFeatures method>
ReplayResult replay_closest_features(std::span<const TriangleMesh>, const Trace&,
                                     std::string_view query, const ReplayOptions&);

}  // namespace bvlab
