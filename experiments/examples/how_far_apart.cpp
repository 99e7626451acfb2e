// SPDX-License-Identifier: BSD-3-Clause
/// How far apart are several bodies, frame after frame? Every pair keeps what it learnt of the last
/// frame.
#include <cstdio>

#include "hierarchies/builds.hpp"
#include "hierarchies/volumes/rss.hpp"
#include "ring.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies/margins.hpp"

using namespace bvlab;
using Volume = Rss<float>;  // made for distances (larsen1999fast)

int main() {
  const TriangleMesh mesh = ring();
  const Hierarchy<Volume> hierarchy(mesh, builds::BottomUpLocal::topology(mesh, 2));
  const std::vector<Shape<Volume>> shapes(3, {&mesh, &hierarchy});
  AllPairs<Batch<float, 8>, Volume, Margins> bodies(shapes, all_object_pairs(3), Margins());

  NotCounting counter;
  for (int frame = 0; frame < 4; ++frame) {
    const std::vector<Pose> poses{*pose_from({0, 0, 0}, 1, 0, 0, 0),
                                  *pose_from({4, 0, 0}, 1, 0, 0, 0),
                                  *pose_from({0, 4 - frame * 0.5, 0}, 1, 0, 0, 0)};
    std::printf("frame %d:", frame);
    bodies.frame(
        poses, counter, [](std::size_t) { return Distance(); },
        [&](std::size_t pair, const Distance& query) {
          const auto& [i, j] = bodies.pairs()[pair];
          std::printf(" %u-%u %.3f", i, j, query.distance());
        });
    std::printf("\n");
  }
}
