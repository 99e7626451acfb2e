// SPDX-License-Identifier: BSD-3-Clause
/// Other libraries' complete pipelines: broad phase, cached pairs, mesh against mesh. Each is told
/// which bodies moved, as ours is, and may do with that what it knows to do.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "experiments/replay/world_frames.hpp"

namespace bvlab {

/// Object i uses mesh i mod meshes.size(). Nothing where there is no peer of that name.
std::unique_ptr<WorldEngine> make_world_peer(std::string_view name,
                                             std::span<const TriangleMesh> meshes,
                                             std::size_t objects);
bool is_world_peer(std::string_view name);
/// "fcl-tree-obb, ..."
std::string world_peer_names();

// One translation unit a library.
/// Which pairs that are near FCL is asked about in a frame: all, or those of which a body moved.
enum class FclPairs { all, moved };
template <FclPairs which>
std::unique_ptr<WorldEngine> make_fcl_world(std::span<const TriangleMesh> meshes,
                                            std::size_t objects);
std::unique_ptr<WorldEngine> make_bullet_world(std::span<const TriangleMesh> meshes,
                                               std::size_t objects);

}  // namespace bvlab
