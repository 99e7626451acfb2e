// SPDX-License-Identifier: BSD-3-Clause
/// FCL 0.7's two versions of GJK for convex meshes: its own, which starts from the last direction,
/// and the one built on libccd, which starts afresh. Both compute distances to 1e-10.
#pragma once

#include "experiments/peers/peers.hpp"

namespace bvlab {

ReplayResult replay_fcl_gjk(std::span<const TriangleMesh>, const Trace&, std::string_view query,
                            const ReplayOptions&);
ReplayResult replay_libccd_gjk(std::span<const TriangleMesh>, const Trace&, std::string_view query,
                               const ReplayOptions&);

}  // namespace bvlab
