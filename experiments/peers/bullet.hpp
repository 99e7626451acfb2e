// SPDX-License-Identifier: BSD-3-Clause
/// Bullet's GImpact meshes: float32, boxes quantised to 16 bits. It has no way to stop at the first
/// contact.
#pragma once

#include "experiments/peers/peers.hpp"

namespace bvlab {

ReplayResult replay_bullet(std::span<const TriangleMesh>, const Trace&, std::string_view query,
                           const ReplayOptions&);

}  // namespace bvlab
