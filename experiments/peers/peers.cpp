// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/peers/peers.hpp"

#include <algorithm>
#include <iterator>

#include "experiments/closest_features/closest_features.hpp"
#include "experiments/peers/bullet.hpp"
#include "experiments/peers/cgal.hpp"
#include "experiments/peers/coal.hpp"
#include "experiments/peers/embree.hpp"
#include "experiments/peers/fcl.hpp"
#include "experiments/peers/fcl_convex.hpp"
#include "experiments/peers/ode.hpp"
#include "experiments/peers/opcode.hpp"

namespace bvlab {
namespace {

constexpr std::string_view all_three = "touching contacts distance", yes_or_no = "touching",
                           meeting = "touching contacts";

// The libraries are Debian's, compiled for plain x86-64 (-O2), or those of BVLAB_PEERS, compiled as
// we are; a record's machine.json says which. What they have in headers is compiled as we are, but
// for FCL's, which are as the library is. Settings are the libraries' own, but for what a
// description names.
constexpr Peer list[] = {
#if BVLAB_FCL
    {"fcl-obb", "FCL 0.7: oriented boxes, recursive", meeting, replay_fcl<FclModel::obb>},
    {"fcl-obbrss",
     "FCL 0.7: oriented boxes and swept rectangles, recursive; distances without error", all_three,
     replay_fcl<FclModel::obbrss>},
    {"fcl-kios",
     "FCL 0.7: spheres intersected with oriented boxes, recursive; distances without error",
     all_three, replay_fcl<FclModel::kios>},
    {"fcl-rss",
     "FCL 0.7: swept rectangles, recursive; distances without error; copies both meshes at every "
     "question that is not a distance",
     all_three, replay_fcl<FclModel::rss>},
    {"fcl-aabb", "FCL 0.7: aligned boxes; copies both meshes at every question", meeting,
     replay_fcl<FclModel::aabb>},
    {"fcl-kdop16", "FCL 0.7: 16-DOPs; copies both meshes at every question", meeting,
     replay_fcl<FclModel::kdop16>},
    {"fcl-kdop18", "FCL 0.7: 18-DOPs; copies both meshes at every question", meeting,
     replay_fcl<FclModel::kdop18>},
    {"fcl-kdop24", "FCL 0.7: 24-DOPs; copies both meshes at every question", meeting,
     replay_fcl<FclModel::kdop24>},
#endif
#if BVLAB_COAL
    {"coal-obb", "Coal 3.0: oriented boxes; touching is less than 1e-12 apart", meeting,
     replay_coal<CoalModel::obb>},
    {"coal-obbrss", "Coal 3.0: oriented boxes and swept rectangles; touching likewise", all_three,
     replay_coal<CoalModel::obbrss>},
    {"coal-rss", "Coal 3.0: swept rectangles", "distance", replay_coal<CoalModel::rss>},
#endif
#if BVLAB_BULLET
    {"bullet", "Bullet 3.24: GImpact, float32, margins 0; looks for all contacts", yes_or_no,
     replay_bullet},
#endif
#if BVLAB_ODE
    {"ode", "ODE 0.16.2: trimesh (OPCODE), boxes in float32; one contact, not refined", yes_or_no,
     replay_ode},
#endif
#if BVLAB_HAS_OPCODE
    {"opcode", "OPCODE 1.3, called directly, float32: no-leaf trees, boxes as they lie", meeting,
     replay_opcode<OpcodeCoherence::off>},
    {"opcode-coherent", "the same; the pair of triangles that met last is tried first", yes_or_no,
     replay_opcode<OpcodeCoherence::on>},
#endif
#if BVLAB_EMBREE
    {"embree",
     "Embree 3.13.5: rtcCollide, one thread, with our exact test of triangles; the scene of a body "
     "that moved is refitted",
     meeting, replay_embree},
#endif
#if BVLAB_CGAL
    {"cgal", "CGAL 5.5: Rigid_triangle_mesh_collision_detection", yes_or_no, replay_cgal},
#endif
#if BVLAB_FCL
    {"fcl-gjk", "FCL 0.7: its own GJK, from the last direction, to 1e-10; convex solids only",
     "distance", replay_fcl_gjk, true},
    {"libccd-gjk", "FCL 0.7 on libccd 2.1: GJK from scratch, to 1e-10; convex solids only",
     "distance", replay_libccd_gjk, true},
#endif
    // Ours, but no hierarchy: beside them, on convex meshes.
    {"gjk", "GJK over all vertices, from scratch; convex solids only", "touching distance",
     replay_closest_features<ClosestFeatures::gjk>, true},
    {"gjk-coherent", "Cameron's GJK: climbs from the last answer; convex solids only",
     "touching distance", replay_closest_features<ClosestFeatures::gjk_coherent>, true},
    {"v-clip", "V-Clip: closest features, from the last answer; convex solids only",
     "touching distance", replay_closest_features<ClosestFeatures::v_clip>, true},
};

// Names of the above that are left out, by library; an empty one ends the list.
constexpr std::string_view absent[] = {
#if !BVLAB_FCL
    "fcl-obb",    "fcl-obbrss",      "fcl-kios",   "fcl-rss", "fcl-aabb",
    "fcl-kdop16", "fcl-kdop18",      "fcl-kdop24", "fcl-gjk", "libccd-gjk",
#endif
#if !BVLAB_COAL
    "coal-obb",   "coal-obbrss",     "coal-rss",
#endif
#if !BVLAB_BULLET
    "bullet",
#endif
#if !BVLAB_ODE
    "ode",
#endif
#if !BVLAB_HAS_OPCODE
    "opcode",     "opcode-coherent",
#endif
#if !BVLAB_EMBREE
    "embree",
#endif
#if !BVLAB_CGAL
    "cgal",
#endif
    "",
};

}  // namespace

std::span<const Peer> peers() { return list; }

std::string_view absent_peer_libraries() { return BVLAB_ABSENT_PEERS; }

std::string peer_names() {
  std::string names;
  for (const auto& each : list) names += (names.empty() ? "" : ", ") + std::string(each.name);
  return names;
}

bool is_absent_peer(std::string_view name) {
  return !name.empty() && std::find(std::begin(absent), std::end(absent), name) != std::end(absent);
}

const Peer* peer(std::string_view name) {
  for (const auto& each : list)
    if (each.name == name) return &each;
  return nullptr;
}

}  // namespace bvlab
