// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/tori.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "experiments/scenes/named_mesh.hpp"
#include "experiments/replay/touches_any.hpp"

namespace bvlab {
namespace {

struct Fall {
  Array<double> trace;
  std::size_t touching = 0;
};

Fall fall(const Tori& scene) {
  std::vector<TriangleMesh> meshes;
  std::vector<Extent> extents;
  for (auto& [name, mesh] : named_meshes(std::string(Tori::meshes), 500)) {
    extents.push_back(extent_of(mesh));
    meshes.push_back(std::move(mesh));
  }
  Fall result{scene.generate(extents, {})};
  const auto touches = touches_any(meshes, 2);
  for (std::size_t frame = 0; frame < scene.frames; ++frame) {
    const double* p = &result.trace.data[14 * frame + 7];
    const Pose poses[] = {Pose{}, *pose_from({p[0], p[1], p[2]}, p[3], p[4], p[5], p[6])};
    result.touching += touches(0, poses);
  }
  return result;
}

TEST(Tori, HaveTheSizesThatTheyAreSaidToHave) {
  const auto meshes = named_meshes(std::string(Tori::meshes), 500);
  ASSERT_EQ(meshes.size(), 2u);
  EXPECT_NEAR(static_cast<double>(meshes[0].mesh.triangles.size()), 3200, 10);
  EXPECT_NEAR(static_cast<double>(meshes[1].mesh.triangles.size()), 1300, 10);
}

TEST(Tori, OneFallsThroughTheOthersHole) {
  const Tori scene;
  const auto [trace, touching] = fall(scene);
  EXPECT_EQ(trace.shape, (std::vector<std::size_t>{2000, 2, 7}));
  EXPECT_NEAR(trace.data[9], 0.3, 1e-12);
  EXPECT_NEAR(trace.data[trace.data.size() - 5], -0.3, 1e-12);
  // Near for most of the way, touching now and then.
  EXPECT_GT(touching, 100u);
  EXPECT_LT(touching, 1000u);
  Tori straight;
  straight.wobble = {0, Length::Unit::mesh};
  EXPECT_EQ(fall(straight).touching, 0u);
}

TEST(Tori, MoveALittleInAFrame) {
  const auto [trace, touching] = fall(Tori{});
  for (std::size_t frame = 1; frame < trace.shape[0]; ++frame) {
    const double *now = &trace.data[14 * frame + 7], *before = now - 14;
    double squared = 0, cosine = 0;
    for (int d = 0; d < 3; ++d) squared += (now[d] - before[d]) * (now[d] - before[d]);
    for (int d = 3; d < 7; ++d) cosine += now[d] * before[d];
    EXPECT_LT(std::sqrt(squared), 0.005) << frame;
    EXPECT_GT(std::abs(cosine), std::cos(0.01 * 3.2)) << frame;
  }
}

}  // namespace
}  // namespace bvlab
