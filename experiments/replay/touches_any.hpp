// SPDX-License-Identifier: BSD-3-Clause
/// The engine as a scene's sense of touch: exact, recursive, over sphere trees.
#pragma once

#include <span>

#include "experiments/scenes/scene.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// Object i is meshes[i mod their number]; the meshes must outlive what is returned.
TouchesAny touches_any(std::span<const TriangleMesh> meshes, std::size_t objects);

}  // namespace bvlab
