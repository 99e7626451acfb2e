// SPDX-License-Identifier: BSD-3-Clause
/// Our engine for whole scenes, chosen by name while the program runs.
#pragma once

#include <memory>

#include "experiments/replay/world_frames.hpp"

namespace bvlab {

/// A World for the variant's tree, volume and strategy, with the query `touching`; the meshes must
/// outlive it. Throws Unusable for unknown names.
std::unique_ptr<WorldEngine> make_world(std::span<const TriangleMesh> meshes, std::size_t objects,
                                        const Variant& variant, int threads = 1);

}  // namespace bvlab
