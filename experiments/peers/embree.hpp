// SPDX-License-Identifier: BSD-3-Clause
/// Embree's collision of two scenes of user geometry. It knows no moving scene: the triangles of a
/// body that moved get new boxes in the world and its tree is refitted, which is part of its time.
#pragma once

#include "experiments/peers/peers.hpp"

namespace bvlab {

ReplayResult replay_embree(std::span<const TriangleMesh>, const Trace&, std::string_view query,
                           const ReplayOptions&);

}  // namespace bvlab
