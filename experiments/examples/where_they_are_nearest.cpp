// SPDX-License-Identifier: BSD-3-Clause
/// Where are two bodies nearest to each other? A query for the distance knows the two triangles;
/// their nearest points are computed when they are asked for.
#include <cstdio>

#include "ring.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/nearest_points.hpp"
#include "traversal/queries.hpp"
#include "traversal/recommended_distances.hpp"

using namespace bvlab;

int main() {
  const TriangleMesh mesh = ring();
  const auto hierarchy = RecommendedDistances::hierarchy(mesh);
  const std::vector<RecommendedDistances::Shape> shapes(2, {&mesh, &hierarchy});
  AllPairsOf bodies(RecommendedDistances::Pairs(shapes), all_object_pairs(2));

  NotCounting counter;
  for (const double x : {4.0, 3.0, 2.3}) {
    const std::vector<Pose> poses{pose_from({0, 0, 0}, 1, 0, 0, 0).value(),
                                  pose_from({x, 0, 0}, 1, 0, 0, 0).value()};
    bodies.frame(
        poses, counter, [](std::size_t) { return Distance(); },
        [&](std::size_t, const Distance& query) {
          const auto [triangles, points] =
              nearest_points(query.nearest(), mesh, poses[0], mesh, poses[1]);
          const auto& [on_a, on_b] = points;
          if (query.distance() > 0)
            std::printf("apart by %.3f: (%.2f, %.2f, %.2f) and (%.2f, %.2f, %.2f)\n",
                        query.distance(), on_a[0], on_a[1], on_a[2], on_b[0], on_b[1], on_b[2]);
          else
            std::printf("touching: %s\n", on_a == on_b ? "one point" : "two points");
        });
  }
}
