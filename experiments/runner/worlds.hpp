// SPDX-License-Identifier: BSD-3-Clause
/// Our engine for whole scenes, chosen by name while the program runs.
#pragma once

#include <memory>

#include "experiments/runner/world_frames.hpp"

namespace bvlab {

/// A World for the variant's volume and strategy, with the query `touching`; the meshes must
/// outlive it. Throws Unusable for unknown names.
std::unique_ptr<WorldEngine> make_world(std::span<const TriangleMesh> meshes, std::size_t objects,
                                        const Variant& variant);

/// The same for one volume; the variant's names have been checked. Each is compiled by itself.
template <BoundingVolume V>
std::unique_ptr<WorldEngine> make_world_of(std::span<const TriangleMesh> meshes,
                                           std::size_t objects, const Variant& variant);

}  // namespace bvlab
