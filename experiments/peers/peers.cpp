// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/peers/peers.hpp"

#include "experiments/peers/cgal.hpp"
#include "experiments/peers/fcl.hpp"

namespace bvlab {
namespace {

constexpr Peer list[] = {
    {"fcl-obb", "FCL: oriented boxes, recursive", replay_fcl_obb, true},
    {"fcl-obbrss", "FCL: oriented boxes and swept rectangles, recursive", replay_fcl_obbrss, true},
    {"cgal", "CGAL: Rigid_triangle_mesh_collision_detection", replay_cgal, false},
};

}  // namespace

std::span<const Peer> peers() { return list; }

std::string peer_names() {
  std::string names;
  for (const auto& each : list) names += (names.empty() ? "" : ", ") + std::string(each.name);
  return names;
}

const Peer* peer(std::string_view name) {
  for (const auto& each : list)
    if (each.name == name) return &each;
  return nullptr;
}

}  // namespace bvlab
