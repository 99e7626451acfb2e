// SPDX-License-Identifier: BSD-3-Clause
/// What does a separation list save? The terms of T = N_u C_u + N_v C_v + N_p C_p, counted over
/// small and large steps.
#include <cstdio>

#include "hierarchies/builds.hpp"
#include "hierarchies/volumes/sphere.hpp"
#include "ring.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies/recursive.hpp"
#include "traversal/strategies/separation_list.hpp"

using namespace bvlab;
using Volume = Sphere<float>;

/// Volume tests in a hundred frames, in each of which a ring turns by `step` within another.
template <class Strategy>
std::uint64_t tests(const TriangleMesh& mesh, const Hierarchy<Volume>& hierarchy, double step) {
  const std::vector<Shape<Volume>> shapes(2, {&mesh, &hierarchy});
  AllPairs<Batch<float, 8>, Volume, Strategy> bodies(shapes, all_object_pairs(2), Strategy());
  Counting counter;
  for (int frame = 0; frame < 100; ++frame) {
    const double half = 0.5 * step * frame;
    // About x, after the quarter turn that links the rings.
    const double angle = 0.25 * std::numbers::pi + half;
    const std::vector<Pose> poses{Pose(),
                                  *pose_from({1, 0, 0}, std::cos(angle), std::sin(angle), 0, 0)};
    bodies.frame(
        poses, counter, [](std::size_t) { return Touching(); },
        [](std::size_t, const Touching&) {});
  }
  return counter.n_v;
}

int main() {
  const TriangleMesh mesh = ring();
  const Hierarchy<Volume> hierarchy(mesh, builds::BottomUpLocal::topology(mesh, 1));
  for (const double step : {0.0001, 0.1}) {
    const double roots = static_cast<double>(tests<Recursive>(mesh, hierarchy, step));
    std::printf("step %g: list %.2f, deferred %.2f of the tests from the roots\n", step,
                tests<SeparationList>(mesh, hierarchy, step) / roots,
                tests<Deferred>(mesh, hierarchy, step) / roots);
  }
}
