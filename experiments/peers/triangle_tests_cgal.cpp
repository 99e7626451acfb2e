// SPDX-License-Identifier: BSD-3-Clause
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include "experiments/peers/triangle_tests.hpp"

namespace bvlab::peers {

std::size_t count_touching_cgal(std::span<const std::array<Triangle, 2>> pairs) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  const auto point = [](const Vec3<double>& p) { return Kernel::Point_3(p[0], p[1], p[2]); };
  const auto triangle = [&](const Triangle& t) {
    return Kernel::Triangle_3(point(t[0]), point(t[1]), point(t[2]));
  };
  std::size_t touching = 0;
  for (const auto& [a, b] : pairs) touching += CGAL::do_intersect(triangle(a), triangle(b));
  return touching;
}

}  // namespace bvlab::peers
