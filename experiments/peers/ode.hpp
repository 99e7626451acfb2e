// SPDX-License-Identifier: BSD-3-Clause
/// ODE's triangle meshes: OPCODE's trees of boxes in float32, triangles in float64.
#pragma once

#include "experiments/peers/peers.hpp"

namespace bvlab {

ReplayResult replay_ode(std::span<const TriangleMesh>, const Trace&, std::string_view query,
                        const ReplayOptions&);

}  // namespace bvlab
