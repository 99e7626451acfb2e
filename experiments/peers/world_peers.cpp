// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/peers/world_peers.hpp"

#include <algorithm>
#include <vector>

namespace bvlab {
namespace {

struct Entry {
  std::string_view name;
  std::unique_ptr<WorldEngine> (*make)(std::span<const TriangleMesh>, std::size_t);
};

const std::vector<Entry> list {
#if BVLAB_FCL
  {"fcl-world", make_fcl_world<FclPairs::all>},              // dynamic tree of boxes, OBB trees
      {"fcl-world-moved", make_fcl_world<FclPairs::moved>},  // of pairs at rest the last answer
#endif
#if BVLAB_BULLET
      {"bullet-world", make_bullet_world},  // dynamic trees of boxes, GImpact
#endif
};

}  // namespace

std::unique_ptr<WorldEngine> make_world_peer(std::string_view name,
                                             std::span<const TriangleMesh> meshes,
                                             std::size_t objects) {
  for (const auto& each : list)
    if (each.name == name) return each.make(meshes, objects);
  return nullptr;
}

bool is_world_peer(std::string_view name) {
  return std::any_of(std::begin(list), std::end(list),
                     [&](const Entry& each) { return each.name == name; });
}

std::string world_peer_names() {
  std::string names;
  for (const auto& each : list) names += (names.empty() ? "" : ", ") + std::string(each.name);
  return names;
}

}  // namespace bvlab
