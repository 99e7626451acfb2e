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

struct WorldPeer {
  std::string_view name;
  /// Object i uses mesh i mod meshes.size().
  std::unique_ptr<WorldEngine> (*make)(std::span<const TriangleMesh> meshes, std::size_t objects);
};

/// Nothing where there is no peer of that name.
std::unique_ptr<WorldEngine> make_world_peer(std::string_view name,
                                             std::span<const TriangleMesh> meshes,
                                             std::size_t objects);
bool is_world_peer(std::string_view name);
/// "fcl-world, ..."
std::string world_peer_names();

}  // namespace bvlab
