// SPDX-License-Identifier: BSD-3-Clause
/// FCL 0.7's mesh against mesh, by its bounding volume.
#pragma once

#include "experiments/peers/peers.hpp"

namespace bvlab {

ReplayResult replay_fcl_obb(std::span<const TriangleMesh>, const Trace&, std::string_view query,
                            const ReplayOptions&);
ReplayResult replay_fcl_obbrss(std::span<const TriangleMesh>, const Trace&, std::string_view query,
                               const ReplayOptions&);

}  // namespace bvlab
