// SPDX-License-Identifier: BSD-3-Clause
/// The planner's robot moves among obstacles that stand, in steps no longer than it was told; the
/// pile falls, meets and comes to rest.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "experiments/files/unusable.hpp"
#include "experiments/replay/touches_any.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "experiments/scenes/pile.hpp"
#include "experiments/scenes/planner.hpp"
#include "experiments/scenes/recorded.hpp"

namespace bvlab {
namespace {

std::vector<TriangleMesh> some_meshes() { return {formula_mesh("knot", 96)}; }

std::vector<Extent> extents_of(const std::vector<TriangleMesh>& meshes) {
  std::vector<Extent> extents;
  for (const auto& mesh : meshes) extents.push_back(extent_of(mesh));
  return extents;
}

const double* row(const Array<double>& trace, std::size_t frame, std::size_t object) {
  return trace.data.data() + (frame * trace.shape[1] + object) * 7;
}

Vec3<double> centre(const Array<double>& trace, std::size_t frame, std::size_t object,
                    const Extent& mesh) {
  const double* r = row(trace, frame, object);
  return Eigen::Quaterniond(r[3], r[4], r[5], r[6]) * mesh.centre + Vec3<double>(r[0], r[1], r[2]);
}

Planner small_planner() {
  Planner planner;
  planner.objects = 8;
  planner.frames = 400;
  planner.side = {5, Length::Unit::body};
  planner.step = {0.05, Length::Unit::body};
  planner.degrees = 5;
  return planner;
}

TEST(Planner, ObstaclesStandAndTheRobotMostlySteps) {
  const auto meshes = some_meshes();
  const auto extents = extents_of(meshes);
  const Planner planner = small_planner();
  const auto trace = planner.generate(extents, touches_any(meshes, planner.objects));
  ASSERT_EQ(trace.shape, std::vector<std::size_t>({400, 8, 7}));
  std::size_t steps = 0;
  for (std::size_t frame = 1; frame < planner.frames; ++frame) {
    for (std::size_t object = 0; object + 1 < planner.objects; ++object)
      EXPECT_TRUE(
          std::equal(row(trace, 0, object), row(trace, 0, object) + 7, row(trace, frame, object)));
    const double moved =
        (centre(trace, frame, 7, extents[0]) - centre(trace, frame - 1, 7, extents[0])).norm();
    const double *a = row(trace, frame - 1, 7), *b = row(trace, frame, 7);
    const double turned = Eigen::Quaterniond(a[3], a[4], a[5], a[6])
                              .angularDistance(Eigen::Quaterniond(b[3], b[4], b[5], b[6]));
    // Everything else starts a new run, somewhere else in the tree.
    steps += moved <= 0.05 * extents[0].radius * 1.0001 && turned <= 5.1 * 3.1416 / 180;
  }
  EXPECT_GT(steps, planner.frames / 2);
  EXPECT_LT(steps, planner.frames - 1);
}

TEST(Planner, DependsOnTheSeedAlone) {
  const auto meshes = some_meshes();
  Planner planner = small_planner();
  const auto first = planner.generate(extents_of(meshes), touches_any(meshes, planner.objects));
  EXPECT_EQ(planner.generate(extents_of(meshes), touches_any(meshes, planner.objects)).data,
            first.data);
  planner.seed = 2;
  EXPECT_NE(planner.generate(extents_of(meshes), touches_any(meshes, planner.objects)).data,
            first.data);
}

TEST(Pile, FallsMeetsAndComesToRest) {
  const auto meshes = some_meshes();
  const auto extents = extents_of(meshes);
  Pile pile;
  pile.objects = 20;
  pile.frames = 1500;
  pile.side = {5, Length::Unit::body};
  const auto trace = pile.generate(extents, {});
  ASSERT_EQ(trace.shape, std::vector<std::size_t>({1500, 20, 7}));
  const auto moved = [&](std::size_t frame) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < pile.objects; ++i)
      count +=
          !std::equal(row(trace, frame, i), row(trace, frame, i) + 7, row(trace, frame - 1, i));
    return count;
  };
  EXPECT_EQ(moved(1), 20u);
  EXPECT_EQ(moved(1499), 0u);
  // At rest: above the floor, lower than at the start, and some lie on others.
  double highest = 0, lowest = 1e9, start = 0;
  for (std::size_t i = 0; i < pile.objects; ++i) {
    const double z = centre(trace, 1499, i, extents[0])[2];
    highest = std::max(highest, z), lowest = std::min(lowest, z);
    start = std::max(start, centre(trace, 0, i, extents[0])[2]);
  }
  const double ball = pile.core * extents[0].radius;
  EXPECT_NEAR(lowest, ball, 0.05 * ball);
  EXPECT_GT(highest, 1.5 * ball);
  EXPECT_LT(highest, start);
  for (std::size_t i = 0; i < pile.objects; ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_GT((centre(trace, 1499, i, extents[0]) - centre(trace, 1499, j, extents[0])).norm(),
                1.8 * ball);
}

TEST(Recorded, IsTheFirstOfAFile) {
  const auto path = std::filesystem::temp_directory_path() / "bvlab-recorded-test.npy";
  const std::size_t shape[] = {3, 2, 7};
  std::vector<double> values(3 * 2 * 7);
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = static_cast<double>(k + 1);
  write_npy<double>(path, shape, values);
  Recorded scene;
  scene.trace = path.string(), scene.objects = 1, scene.frames = 2;
  const auto part = scene.generate({}, {});
  EXPECT_EQ(part.shape, std::vector<std::size_t>({2, 1, 7}));
  std::vector<double> first(values.begin(), values.begin() + 7);
  first.insert(first.end(), values.begin() + 14, values.begin() + 21);
  EXPECT_EQ(part.data, first);
  scene.frames = 0, scene.objects = 0;
  EXPECT_EQ(scene.generate({}, {}).shape, std::vector<std::size_t>({3, 2, 7}));
  EXPECT_EQ(scene.generate({}, {}).data, values);
  scene.frames = 4;
  EXPECT_THROW(scene.generate({}, {}), Unusable);
  scene.frames = 2, scene.objects = 3;
  EXPECT_THROW(scene.generate({}, {}), Unusable);
  scene.trace = "";
  EXPECT_THROW(scene.generate({}, {}), Unusable);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace bvlab
