// SPDX-License-Identifier: BSD-3-Clause
/// Distances between meshes: brute force over all pairs of triangles, coherent against fresh, and
/// the promise of a relative error.
#include <gtest/gtest.h>

#include "experiments/replay/registry.hpp"
#include "experiments/replay/replay.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "experiments/scenes/random_walk.hpp"
#include "tests/oracles/nearest_laws.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/primitives/triangle_distance.hpp"

namespace bvlab {
namespace {

struct Scenery {
  std::vector<TriangleMesh> meshes;
  Trace trace;
};

Scenery scenery(std::size_t frames, double side, double step) {
  Scenery result;
  std::vector<Extent> extents;
  for (const auto& [name, polygons] : {std::pair("star", 60), std::pair("torus", 64)}) {
    result.meshes.push_back(formula_mesh(name, static_cast<std::size_t>(polygons)));
    extents.push_back(extent_of(result.meshes.back()));
  }
  RandomWalk walk;
  walk.objects = 4;
  walk.frames = frames;
  walk.side = {side, Length::Unit::body};
  walk.step = {step, Length::Unit::body};
  walk.teleport = 0.02;
  auto array = walk.generate(extents, {});
  result.trace = {array.shape[0], array.shape[1], std::move(array.data)};
  return result;
}

std::vector<double> distances(const Scenery& scenery, std::string_view volume,
                              const std::string& strategy, double relative_error = 0) {
  Variant variant;
  variant.volume = volume;
  variant.strategy = strategy;
  variant.query = "distance";
  variant.relative_error = relative_error;
  return replay(scenery.meshes, scenery.trace, variant, {}).distances;
}

TEST(DistanceQuery, IsTheLeastOverAllPairsOfTriangles) {
  const Scenery scene = scenery(40, 4, 0.2);
  const auto measured = distances(scene, "sphere", "recursive");
  std::vector<Pose> poses(scene.trace.objects);
  std::size_t cell = 0, touching = 0;
  for (std::size_t frame = 0; frame < scene.trace.frames; ++frame) {
    scene.trace.poses(frame, poses);
    for (const auto& [i, j] : all_object_pairs(static_cast<std::uint32_t>(poses.size()))) {
      const auto& a = scene.meshes[i % 2];
      const auto& b = scene.meshes[j % 2];
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t s = 0; s < a.triangles.size(); ++s)
        for (std::size_t t = 0; t < b.triangles.size(); ++t) {
          Triangle one = a.corners(s), other = b.corners(t);
          for (auto& corner : one) corner = poses[i](corner);
          for (auto& corner : other) corner = poses[j](corner);
          least = std::min(least, distance(one, other).distance);
        }
      ASSERT_NEAR(measured[cell], least, 1e-12 * least) << "frame " << frame;
      ++cell, touching += least == 0;
    }
  }
  EXPECT_GT(touching, 5u);
  EXPECT_LT(touching, cell - 20);
}

TEST(DistanceQuery, CoherentIsFreshForEveryVolume) {
  for (const double step : {0.002, 0.3}) {
    const Scenery scene = scenery(1500, 4, step);
    const auto fresh = distances(scene, "sphere", "recursive");
    for (const auto& [volume, description] : volumes())
      for (const auto& [strategy, same] : strategies()) {
        const auto kept = distances(scene, volume, strategy);
        ASSERT_EQ(kept.size(), fresh.size());
        for (std::size_t i = 0; i < fresh.size(); ++i)
          ASSERT_NEAR(kept[i], fresh[i], 1e-12 * fresh[i]) << strategy << ' ' << volume;
      }
  }
}

/// Frames in threes, of which the last two are alike: bodies rest now and then.
void let_rest(Trace& trace) {
  const std::size_t row = trace.objects * 7;
  for (std::size_t frame = 2; frame < trace.frames; frame += 3)
    std::copy_n(trace.values.begin() + static_cast<std::ptrdiff_t>((frame - 1) * row), row,
                trace.values.begin() + static_cast<std::ptrdiff_t>(frame * row));
}

/// The nearest pairs hold their laws, and are the same for any number of threads.
void expect_nearest_pairs(const Scenery& scene, const Variant& variant) {
  ReplayOptions options;
  options.keep_nearest = true;
  const ReplayResult found = replay(scene.meshes, scene.trace, variant, options);
  ASSERT_EQ(found.nearest.size(), found.distances.size());
  options.threads = 3;
  const ReplayResult again = replay(scene.meshes, scene.trace, variant, options);
  EXPECT_EQ(again.distances, found.distances);
  std::vector<Pose> poses(scene.trace.objects);
  std::size_t cell = 0;
  for (std::size_t frame = 0; frame < scene.trace.frames; ++frame) {
    scene.trace.poses(frame, poses);
    for (const auto& [i, j] : object_pairs(scene.trace)) {
      expect_nearest(found.nearest[cell], found.distances[cell], scene.meshes[i % 2], poses[i],
                     scene.meshes[j % 2], poses[j],
                     variant.volume + " " + variant.strategy + " " + variant.kernel);
      if (testing::Test::HasFatalFailure()) return;
      ASSERT_EQ(again.nearest[cell].triangles, found.nearest[cell].triangles);
      ASSERT_EQ(again.nearest[cell].points, found.nearest[cell].points);
      ++cell;
    }
  }
}

TEST(DistanceQuery, NearestPairsAreAsFarApartAsTheBodies) {
  for (const double step : {0.002, 0.1}) {
    Scenery scene = scenery(120, 4, step);
    let_rest(scene.trace);
    for (const double relative_error : {0.0, 0.3})
      for (const char* frame : {"world", "body"})
        for (const auto* volume : volume_entries())
          for (const auto& [strategy, description] : strategies()) {
            if (frame == std::string("body") && !volume->has_body_frame) continue;
            Variant variant;
            variant.query = "distance", variant.relative_error = relative_error;
            variant.volume = volume->name, variant.strategy = strategy, variant.frame = frame;
            expect_nearest_pairs(scene, variant);
            ASSERT_FALSE(HasFatalFailure());
          }
    for (const char* kernel : {"siblings", "mixed"})
      for (const auto& [volume, description] : wide_volumes(kernel))
        for (const char* strategy : {"recursive", "margins"}) {
          Variant variant;
          variant.query = "distance";
          set_kernel(variant, kernel);
          variant.volume = volume, variant.strategy = strategy;
          expect_nearest_pairs(scene, variant);
          ASSERT_FALSE(HasFatalFailure());
        }
  }
}

TEST(DistanceQuery, ARelativeErrorIsAPromise) {
  const Scenery scene = scenery(300, 4, 0.05);
  const auto truth = distances(scene, "sphere", "recursive");
  for (const double allowed : {0.01, 0.1, 0.5})
    for (const auto& [volume, description] : volumes())
      for (const char* strategy : {"recursive", "deferred", "margins"}) {
        const auto rough = distances(scene, volume, strategy, allowed);
        double worst = 0;
        for (std::size_t i = 0; i < truth.size(); ++i) {
          ASSERT_GE(rough[i], truth[i] * (1 - 1e-12));
          ASSERT_LE(rough[i], truth[i] * (1 + allowed) * (1 + 1e-12));
          if (truth[i] > 0) worst = std::max(worst, rough[i] / truth[i] - 1);
        }
        if (allowed == 0.5) {
          EXPECT_GT(worst, 0) << "the error allowed is never used";
        }
      }
}

}  // namespace
}  // namespace bvlab
