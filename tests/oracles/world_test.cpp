// SPDX-License-Identifier: BSD-3-Clause
/// Whole scenes: whatever is near, moves, jumps or stays, the pairs that touch are those that
/// asking every pair in every frame finds.
#include "traversal/world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <type_traits>
#include <vector>

#include "broadphase/broadphase.hpp"
#include "experiments/replay/configurations.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/replay/worlds.hpp"
#include "tests/oracles/settings.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/recommended_for.hpp"

namespace bvlab {
namespace {

/// As `replay` writes touching: (frames, pairs).
std::vector<std::uint8_t> touching(const WorldRun& run, const Trace& trace) {
  std::vector<std::uint8_t> all(trace.frames * trace.pairs(), 0);
  const std::size_t n = trace.objects;
  for (std::size_t frame = 0; frame < trace.frames; ++frame)
    for (const auto& [i, j] : run.answers[frame])
      ++all[frame * trace.pairs() + i * n - i * (i + 1) / 2 + (j - i - 1)];
  return all;
}

Variant variant_of(const char* tree, const char* volume, const char* strategy) {
  Variant variant;
  set_tree(variant, tree);
  variant.volume = volume, variant.strategy = strategy;
  return variant;
}

void expect_all_pairs_answers(const Played& scene, const char* name, const Variant& variant,
                              int threads = 1) {
  const auto truth = replay(scene.meshes, scene.trace, {}, {}).touching;
  const auto world = make_world(scene.meshes, scene.trace.objects, variant, threads);
  EXPECT_EQ(touching(play_frames(*world, scene.trace, Answers::kept), scene.trace), truth)
      << name << ' ' << variant.volume << ' ' << variant.strategy << ' ' << threads;
}
void expect_all_pairs_answers(const Played& scene, const char* name, const char* volume,
                              const char* strategy) {
  expect_all_pairs_answers(scene, name, variant_of("binary", volume, strategy));
}

/// Everything overlaps everything; and far more bodies than `settings` has, few of which move.
std::vector<Setting> more_settings() {
  return {
      {"all overlapping", {{"torus", 64}}, walk(12, 200, 0.05, 0.01, 2, 0.05)},
      {"many, few move", {{"star", 60}, {"icosphere", 80}}, walk(60, 300, 6, 0.1, 5, 0.1, 3)},
      {"many, all move", {{"knot", 96}, {"box", 12}}, walk(60, 100, 6, 0.1, 5, 0)},
      {"one body", {{"torus", 64}}, walk(1, 50, 4, 0.1, 5, 0)},
  };
}

TEST(World, GivesTheAnswersOfAllPairs) {
  auto all = settings(500);
  for (auto& each : more_settings()) all.push_back(each);
  for (const auto& setting : all) {
    const Played scene = played(setting);
    for (const auto& strategy : strategies())
      expect_all_pairs_answers(scene, setting.name, "sphere", strategy.name.c_str());
    for (const auto& volume : volumes())
      expect_all_pairs_answers(scene, setting.name, volume.name.c_str(), "deferred");
    expect_all_pairs_answers(scene, setting.name, configured({}, "recommended"));
    expect_all_pairs_answers(scene, setting.name, variant_of("wide", "slab-box", "recursive"));
  }
}

TEST(World, ThreadsGiveTheAnswersOfAllPairs) {
  auto all = settings(200);
  for (auto& each : more_settings()) all.push_back(each);
  for (const auto& setting : all) {
    const Played scene = played(setting);
    for (const int threads : {2, 3, 7})
      for (const auto& variant :
           {configured({}, "recommended"), variant_of("wide", "slab-box", "recursive"),
            variant_of("binary", "obb", "margins")})
        expect_all_pairs_answers(scene, setting.name, variant, threads);
  }
}

Played at_rest(Played scene, std::size_t frames) {
  auto& values = scene.trace.values;
  values.resize(scene.trace.objects * 7);
  const auto first = values;
  for (scene.trace.frames = 1; scene.trace.frames < frames; ++scene.trace.frames)
    values.insert(values.end(), first.begin(), first.end());
  return scene;
}

TEST(World, WhatStandsIsNotAskedAgain) {
  const Played scene = at_rest(played(more_settings()[1]), 5);
  expect_all_pairs_answers(scene, "at rest", "sphere", "recursive");
  const auto world = make_world(scene.meshes, scene.trace.objects, {});
  const WorldRun run = play_frames(*world, scene.trace, Answers::counted);
  EXPECT_GT(run.near, 0u);
  EXPECT_EQ(run.queried, 0u);
}

/// The scene, moved by ten million in each coordinate.
Played far_away(Played scene) {
  for (std::size_t i = 0; i < scene.trace.values.size(); i += 7)
    for (int axis = 0; axis < 3; ++axis) scene.trace.values[i + axis] += 1e7;
  return scene;
}

TEST(World, FarFromTheOriginAndWithoutBodies) {
  const Played scene = far_away(played(settings(50)[0]));
  expect_all_pairs_answers(scene, "far", "sphere", "recursive");
  Played none = scene;
  none.trace = {3, 0, {}};
  const auto world = make_world(none.meshes, 0, {});
  EXPECT_EQ(play_frames(*world, none.trace, Answers::kept).answers.size(), 3u);
}

/// As `replay` writes touching, by a world of one of the recommended configurations.
template <class Best, class Counter>
std::vector<std::uint8_t> touching_in_world(const Played& scene, Counter& counter) {
  std::vector<typename Best::Hierarchy> trees;
  trees.reserve(scene.meshes.size());
  for (const auto& mesh : scene.meshes) trees.push_back(Best::hierarchy(mesh));
  std::vector<typename Best::Shape> shapes;
  for (std::size_t i = 0; i < scene.trace.objects; ++i)
    shapes.push_back({&scene.meshes[i % trees.size()], &trees[i % trees.size()]});
  World<typename Best::Pairs> world{typename Best::Pairs(shapes)};
  TouchingPairs touching;
  std::vector<Pose> poses(scene.trace.objects);
  std::vector<std::uint8_t> found;
  for (std::size_t frame = 0; frame < scene.trace.frames; ++frame) {
    scene.trace.poses(frame, poses);
    for (std::uint32_t i = 0; i < poses.size(); ++i) world.move(i, poses[i]);
    world.update(
        counter, [](const ObjectPair&) { return Touching(); },
        [&](std::uint32_t slot, const ObjectPair& pair, const Touching& query) {
          touching.put(slot, pair, query.touching());
        },
        [&](std::uint32_t slot) { touching.drop(slot); });
    const std::size_t n = scene.trace.objects, first = found.size();
    found.resize(first + scene.trace.pairs());
    for (const auto& [i, j] : touching.pairs())
      ++found[first + i * n - i * (i + 1) / 2 + (j - i - 1)];
  }
  return found;
}

/// In C++, chosen by the meshes: by their triangles, as long as wide, or twenty times as long.
TEST(World, RecommendedForItsMeshesGivesTheAnswersOfAllPairs) {
  for (const double stretch : {1.0, 20.0}) {
    Played scene = played(more_settings()[1]);
    for (auto& mesh : scene.meshes)
      for (auto& vertex : mesh.vertices) vertex[0] *= stretch;
    const auto truth = replay(scene.meshes, scene.trace, {}, {}).touching;
    with_recommended(scene.meshes, [&]<class Best>(std::type_identity<Best>) {
      EXPECT_EQ((std::is_same_v<Best, RecommendedOriented>), stretch > 1);
      NotCounting counter;
      const auto found = touching_in_world<Best>(scene, counter);
      EXPECT_EQ(found, truth);
      EXPECT_GT(std::count(found.begin(), found.end(), 1), 0);
    });
  }
}

/// The spheres by which pairs are culled early are relative to the origin that the world chooses.
TEST(World, FarFromTheOriginMakesAsManyTests) {
  const Played scene = played(more_settings()[2]);
  Counting near, far;
  touching_in_world<Recommended>(scene, near);
  touching_in_world<Recommended>(far_away(scene), far);
  EXPECT_GT(near.n_v, 1000u);
  EXPECT_LT(static_cast<double>(far.n_v), 1.02 * static_cast<double>(near.n_v));
}

/// Bodies worlds apart: boxes that no float holds are boxes everywhere.
TEST(World, LargerThanFloatsReach) {
  Played scene = played(settings(20)[0]);
  for (std::size_t row = 0; row < scene.trace.values.size() / 7; ++row)
    if (row % scene.trace.objects == 1) scene.trace.values[row * 7] += 1e45;
  expect_all_pairs_answers(scene, "worlds apart", "sphere", "recursive");
}

/// The box holds every vertex as Pose moves it.
TEST(RotatedMeshBox, HoldsEveryVertex) {
  for (const auto& setting : settings(100)) {
    const Played scene = played(setting);
    std::vector<Pose> poses(scene.trace.objects);
    for (std::size_t frame = 0; frame < scene.trace.frames; ++frame) {
      scene.trace.poses(frame, poses);
      for (std::size_t i = 0; i < poses.size(); ++i) {
        const auto& mesh = scene.meshes[i % scene.meshes.size()];
        const Vec3<double> origin(0.1, -3, 1e3);
        const Box<float> box = RotatedMeshBox(mesh)(poses[i], origin);
        for (const auto& vertex : mesh.vertices) {
          const Vec3<long double> at =
              poses[i](vertex).cast<long double>() - origin.cast<long double>();
          for (int axis = 0; axis < 3; ++axis) {
            EXPECT_GE(at[axis], static_cast<long double>(box.lo[axis]));
            EXPECT_LE(at[axis], static_cast<long double>(box.hi[axis]));
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace bvlab
