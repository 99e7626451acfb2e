// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "experiments/scenes/formula_mesh.hpp"
#include "experiments/scenes/random_walk.hpp"
#include "experiments/replay/touches_any.hpp"
#include "traversal/primitives/triangle_intersection.hpp"

namespace bvlab {
namespace {

std::vector<Triangle> placed(const TriangleMesh& mesh, const double* row) {
  const Pose pose = *pose_from({row[0], row[1], row[2]}, row[3], row[4], row[5], row[6]);
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    Triangle triangle = mesh.corners(i);
    for (auto& corner : triangle) corner = pose(corner);
    triangles.push_back(triangle);
  }
  return triangles;
}

/// By brute force, from the trace as it is written: no pair of surfaces ever shares a point.
TEST(RandomWalk, RejectionWithTheEngineLeavesNothingTouching) {
  const std::vector<TriangleMesh> meshes = {formula_mesh("torus", 60), formula_mesh("star", 60),
                                            formula_mesh("knot", 144)};
  std::vector<Extent> extents;
  for (const auto& mesh : meshes) extents.push_back(extent_of(mesh));
  RandomWalk walk;
  walk.objects = 5;
  walk.frames = 150;
  walk.side = {2, Length::Unit::body};
  walk.step = {0.1, Length::Unit::body};
  walk.degrees = 20;
  walk.contact = "reject";
  walk.teleport = 0.1;
  const auto trace = walk.generate(extents, touches_any(meshes, walk.objects));
  walk.contact = "pass";
  const auto passing = walk.generate(extents, {});
  const auto touching = [&](const Array<double>& poses) {
    std::size_t pairs = 0;
    for (std::size_t frame = 0; frame < walk.frames; ++frame)
      for (std::size_t i = 0; i < walk.objects; ++i)
        for (std::size_t j = 0; j < i; ++j) {
          const double* row = poses.data.data() + frame * walk.objects * 7;
          const auto a = placed(meshes[i % 3], row + i * 7), b = placed(meshes[j % 3], row + j * 7);
          pairs += std::any_of(a.begin(), a.end(), [&](const Triangle& s) {
            return std::any_of(b.begin(), b.end(),
                               [&](const Triangle& t) { return intersect(s, t); });
          });
        }
    return pairs;
  };
  EXPECT_EQ(touching(trace), 0u);
  EXPECT_GT(touching(passing), 50u);
}

}  // namespace
}  // namespace bvlab
