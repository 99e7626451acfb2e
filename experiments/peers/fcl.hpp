// SPDX-License-Identifier: BSD-3-Clause
/// FCL 0.7's mesh against mesh, by its bounding volume.
#pragma once

#include "experiments/peers/peers.hpp"

namespace bvlab {

enum class FclModel { obb, obbrss, kios, rss, aabb, kdop16, kdop18, kdop24 };

/// Volume tests and triangle tests of obb, obbrss and kios are FCL's own count, where they are
/// asked for; otherwise its public functions are called and nothing is counted.
template <FclModel model>
ReplayResult replay_fcl(std::span<const TriangleMesh>, const Trace&, std::string_view query,
                        const ReplayOptions&);

}  // namespace bvlab
