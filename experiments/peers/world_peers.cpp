// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/peers/world_peers.hpp"

#include <algorithm>

#include "experiments/files/joined.hpp"
#include "experiments/peers/collected.hpp"
#include "experiments/peers/found.hpp"

namespace bvlab {

#define BVLAB_DECLARED(library) std::span<const WorldPeer> library##_worlds();
#define BVLAB_LISTED(library) library##_worlds,
BVLAB_WORLD_PEERS(BVLAB_DECLARED)

namespace {

const std::vector<WorldPeer>& list() {
  static const auto all = collected<WorldPeer>({BVLAB_WORLD_PEERS(BVLAB_LISTED)});
  return all;
}

}  // namespace

std::unique_ptr<WorldEngine> make_world_peer(std::string_view name,
                                             std::span<const TriangleMesh> meshes,
                                             std::size_t objects) {
  for (const auto& each : list())
    if (each.name == name) return each.make(meshes, objects);
  return nullptr;
}

bool is_world_peer(std::string_view name) {
  return std::any_of(list().begin(), list().end(),
                     [&](const WorldPeer& each) { return each.name == name; });
}

std::string world_peer_names() { return joined(list(), &WorldPeer::name); }

}  // namespace bvlab
