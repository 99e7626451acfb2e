// SPDX-License-Identifier: BSD-3-Clause
/// Coal (once HPP-FCL), mesh against mesh, by its bounding volume. No distribution that we know
/// has it: it is found where CMAKE_PREFIX_PATH names an installation, which has to be compiled for
/// the same processor as we are (-march=native), since its types hold Eigen's.
#pragma once

#include "experiments/peers/peers.hpp"

namespace bvlab {

enum class CoalModel { obb, obbrss, rss };

/// One contact and no details of it where a yes or no is asked; functions looked up once; boxes
/// are opened where they meet and not also where they are less than 1e-3 apart, which is its
/// default. Triangles less than 1e-12 apart are touching to it. Nothing is counted.
template <CoalModel model>
ReplayResult replay_coal(std::span<const TriangleMesh>, const Trace&, std::string_view query,
                         const ReplayOptions&);

}  // namespace bvlab
