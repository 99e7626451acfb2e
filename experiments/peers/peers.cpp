// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/peers/peers.hpp"

#include <algorithm>
#include <iterator>

#include "experiments/closest_features/closest_features.hpp"
#include "experiments/files/joined.hpp"
#include "experiments/peers/collected.hpp"
#include "experiments/peers/found.hpp"

namespace bvlab {

#define BVLAB_DECLARED(library) std::span<const Peer> library##_peers();
#define BVLAB_LISTED(library) library##_peers,
BVLAB_MESH_PEERS(BVLAB_DECLARED)

namespace {

/// Ours, but no hierarchy: beside the others, on convex meshes.
std::span<const Peer> closest_features_peers() {
  static constexpr Peer list[] = {
      {"gjk", "GJK over all vertices, from scratch; convex solids only", "touching distance",
       replay_closest_features<ClosestFeatures::gjk>, true},
      {"gjk-coherent", "Cameron's GJK: climbs from the last answer; convex solids only",
       "touching distance", replay_closest_features<ClosestFeatures::gjk_coherent>, true},
      {"v-clip", "V-Clip: closest features, from the last answer; convex solids only",
       "touching distance", replay_closest_features<ClosestFeatures::v_clip>, true},
  };
  return list;
}

}  // namespace

bool Peer::answers(std::string_view query) const {
  const std::string padded = " " + std::string(queries) + " ";
  return padded.find(" " + std::string(query) + " ") != std::string::npos;
}

std::span<const Peer> peers() {
  static const auto all = collected<Peer>({BVLAB_MESH_PEERS(BVLAB_LISTED) closest_features_peers});
  return all;
}

std::string_view absent_peer_libraries() { return BVLAB_ABSENT_LIBRARIES; }

std::string peer_names() { return joined(peers(), &Peer::name); }

bool is_absent_peer(std::string_view name) {
  static constexpr std::string_view absent[] = {BVLAB_ABSENT_PEERS};
  return !name.empty() && std::find(std::begin(absent), std::end(absent), name) != std::end(absent);
}

const Peer* peer(std::string_view name) {
  for (const auto& each : peers())
    if (each.name == name) return &each;
  return nullptr;
}

}  // namespace bvlab
