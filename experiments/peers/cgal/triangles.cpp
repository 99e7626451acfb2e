// SPDX-License-Identifier: BSD-3-Clause
// CGAL's preconditions exclude triangles without area. Its tests are compared on them nevertheless,
// in builds with assertions, too.
#define CGAL_NO_PRECONDITIONS
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/intersections.h>

#include "experiments/peers/triangle_tests.hpp"

namespace bvlab {
namespace {

template <class Kernel>
void decide(TriangleTestPeer::Pairs pairs, std::uint8_t* verdicts) {
  const auto point = [](const Vec3<double>& p) {
    return typename Kernel::Point_3(p[0], p[1], p[2]);
  };
  const auto triangle = [&](const Triangle& t) {
    return typename Kernel::Triangle_3(point(t[0]), point(t[1]), point(t[2]));
  };
  for (const auto& [a, b] : pairs) *verdicts++ = CGAL::do_intersect(triangle(a), triangle(b));
}

void decide_cgal(TriangleTestPeer::Pairs pairs, std::uint8_t* verdicts) {
  decide<CGAL::Exact_predicates_inexact_constructions_kernel>(pairs, verdicts);
}

/// The same algorithm [guigue2003fast] with the signs of plain float64 determinants.
void decide_guigue_devillers(TriangleTestPeer::Pairs pairs, std::uint8_t* verdicts) {
  decide<CGAL::Simple_cartesian<double>>(pairs, verdicts);
}

}  // namespace

std::span<const TriangleTestPeer> cgal_triangles() {
  static constexpr TriangleTestPeer list[] = {
      {"cgal", "CGAL's do_intersect with filtered exact predicates", decide_cgal, false},
      {"guigue-devillers", "Guigue and Devillers' test in float64 (CGAL's, with inexact signs)",
       decide_guigue_devillers, false},
  };
  return list;
}

}  // namespace bvlab
