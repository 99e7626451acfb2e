// SPDX-License-Identifier: BSD-3-Clause
/// CGAL's Rigid_triangle_mesh_collision_detection: AABB trees over exact predicates.
#pragma once

#include "experiments/peers/peers.hpp"

namespace bvlab {

ReplayResult replay_cgal(std::span<const TriangleMesh>, const Trace&, std::string_view query,
                         const ReplayOptions&);

}  // namespace bvlab
