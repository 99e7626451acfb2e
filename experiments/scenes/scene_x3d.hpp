// SPDX-License-Identifier: BSD-3-Clause
/// A moving scene as X3D (ISO/IEC 19775-1), the successor of VRML: what browsers of such scenes and
/// other 3D programs read. Profile Interchange, thirty frames a second, every frame of the trace.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "experiments/scenes/trace.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// Object i is meshes[i mod their number], in a Transform named `body<i>`; its Material `colour<i>`
/// is red in frames in which it touches another. `touching`: 1 where a pair touches, C order, shape
/// (frames, pairs), or empty where that is not known. Coordinates have nine digits, as float32
/// needs.
std::string scene_x3d(std::span<const TriangleMesh> meshes, const Trace& trace,
                      std::span<const std::uint8_t> touching, const std::string& title);

}  // namespace bvlab
