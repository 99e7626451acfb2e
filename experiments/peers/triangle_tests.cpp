// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/peers/triangle_tests.hpp"

namespace bvlab {
namespace {

constexpr TriangleTestPeer list[] = {
#if BVLAB_CGAL
    {"cgal", "CGAL's do_intersect with filtered exact predicates", peers::decide_cgal, false},
    {"guigue-devillers", "Guigue and Devillers' test in float64 (CGAL's, with inexact signs)",
     peers::decide_guigue_devillers, false},
#endif
#if BVLAB_FCL
    {"fcl", "separating axes in float64, after PQP", peers::decide_fcl},
#endif
    {"moller", "Moller's interval test in float64, signs below 1e-6 taken as zero",
     peers::decide_moller},
#if BVLAB_BULLET
    {"bullet", "GImpact's clipping in float32", peers::decide_bullet},
#endif
#if BVLAB_ODE
    {"ode", "OPCODE in float32; time includes making a mesh of each triangle", peers::decide_ode},
#endif
};

}  // namespace

std::span<const TriangleTestPeer> triangle_test_peers() { return list; }

const TriangleTestPeer* triangle_test_peer(std::string_view name) {
  for (const auto& each : list)
    if (each.name == name) return &each;
  return nullptr;
}

}  // namespace bvlab
