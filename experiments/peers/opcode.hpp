// SPDX-License-Identifier: BSD-3-Clause
/// OPCODE's mesh against mesh, called directly. Its sources are not ours and not installed by
/// anybody: configure with -DBVLAB_OPCODE=<the folder OPCODE of a checkout of ODE>.
#pragma once

#include "experiments/peers/peers.hpp"

namespace bvlab {

/// Whether the pair of triangles that met last is tried first.
enum class OpcodeCoherence { off, on };

/// Trees without leaves, not quantised, all 15 axes, first contact: what its manual calls fastest.
/// All arithmetic is float32, also of the poses, which are taken relative to the middle of the
/// first frame.
template <OpcodeCoherence coherence>
ReplayResult replay_opcode(std::span<const TriangleMesh>, const Trace&, std::string_view query,
                           const ReplayOptions&);

}  // namespace bvlab
