// SPDX-License-Identifier: BSD-3-Clause
/// How far apart are several bodies, frame after frame? Each pair begins with the triangles that
/// were nearest in the last frame.
#include <cstdio>

#include "ring.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/recommended_distances.hpp"

using namespace bvlab;

int main() {
  const TriangleMesh mesh = ring();
  const auto hierarchy = RecommendedDistances::hierarchy(mesh);
  const std::vector<RecommendedDistances::Shape> shapes(3, {&mesh, &hierarchy});
  AllPairsOf bodies(RecommendedDistances::Pairs(shapes), all_object_pairs(3));

  NotCounting counter;
  for (int frame = 0; frame < 4; ++frame) {
    const std::vector<Pose> poses{pose_from({0, 0, 0}, 1, 0, 0, 0).value(),
                                  pose_from({4, 0, 0}, 1, 0, 0, 0).value(),
                                  pose_from({0, 4 - frame * 0.5, 0}, 1, 0, 0, 0).value()};
    // Pairs are answered in any order.
    std::vector<double> distances(bodies.pairs().size());
    bodies.frame(
        poses, counter, [](std::size_t) { return Distance(); },
        [&](std::size_t pair, const Distance& query) { distances[pair] = query.distance(); });
    std::printf("frame %d:", frame);
    for (std::size_t pair = 0; pair < distances.size(); ++pair) {
      const auto& [i, j] = bodies.pairs()[pair];
      std::printf(" %u-%u %.3f", i, j, distances[pair]);
    }
    std::printf("\n");
  }
}
