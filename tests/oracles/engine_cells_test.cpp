// SPDX-License-Identifier: BSD-3-Clause
/// The whole product of the engine: every volume under every strategy and query, on trees of every
/// fan-out, in both frames, by every kernel, finds what recursion over binary trees of spheres
/// finds, and counts mean the same everywhere. In short one scene a cell, in turns; --long every
/// scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "experiments/replay/registry.hpp"
#include "tests/oracles/settings.hpp"

namespace bvlab {
namespace {

struct Scene {
  std::string name;
  Played played;
  ReplayResult truth;
};

std::vector<Scene> scenes_of(const std::string& query) {
  std::vector<Scene> scenes;
  for (const auto& setting : settings(query == "touching" ? 60 : 24)) {
    Scene scene{setting.name, played(setting), {}};
    Variant variant;
    variant.query = query;
    scene.truth = replay(scene.played.meshes, scene.played.trace, variant, {});
    scenes.push_back(std::move(scene));
  }
  return scenes;
}

/// Distances to the rounding that both leave open.
void expect_same(const ReplayResult& found, const ReplayResult& truth, const std::string& where) {
  EXPECT_EQ(found.touching, truth.touching) << where;
  EXPECT_EQ(found.contacts, truth.contacts) << where;
  ASSERT_EQ(found.distances.size(), truth.distances.size()) << where;
  for (std::size_t i = 0; i < truth.distances.size(); ++i)
    ASSERT_NEAR(found.distances[i], truth.distances[i], 1e-12 * truth.distances[i])
        << where << ", answer " << i;
}

void expect_consistent_counts(const ReplayResult& found, const Variant& variant,
                              const std::string& where) {
  if (variant.kernel != "gathered") {
    // Of volumes without a test, as where spheres decide all pairs, none is posed.
    EXPECT_EQ(found.n_u > 0, found.n_v > 0) << where;
  } else if (variant.frame == "body") {
    EXPECT_EQ(found.n_u, found.n_v) << where;
  } else {
    EXPECT_LE(found.n_u, 2u * variant.fan_out * found.n_v) << where;
  }
  if (variant.kernel == "gathered" &&
      (variant.strategy == "separation-list" || variant.strategy == "deferred")) {
    EXPECT_GT(found.front, 0) << where;
  }
}

struct Cells : testing::TestWithParam<std::string> {};

TEST_P(Cells, AgreeWithRecursionOverBinaryTrees) {
  const std::string query = GetParam();
  const bool all = std::getenv("BVLAB_WHOLE_PRODUCT") != nullptr;
  const auto scenes = scenes_of(query);
  std::size_t cells = 0;
  const auto test = [&](const Variant& variant) {
    const std::size_t own = cells++ % scenes.size();
    for (std::size_t s = all ? 0 : own; s < (all ? scenes.size() : own + 1); ++s) {
      const std::string where = variant.volume + ' ' + variant.strategy + ' ' + query + ' ' +
                                std::to_string(variant.fan_out) + ' ' + variant.frame + ' ' +
                                variant.kernel + ": " + scenes[s].name;
      ReplayOptions options;
      options.count = Count::on;
      const auto found = replay(scenes[s].played.meshes, scenes[s].played.trace, variant, options);
      expect_same(found, scenes[s].truth, where);
      expect_consistent_counts(found, variant, where);
    }
  };
  std::size_t expected = 0;
  for (const auto& kernel : kernels())
    for (const auto& volume : volumes())
      for (const auto& strategy : strategies()) {
        // Strategies from outside run on the gathered kernel alone.
        if (kernel.name != "gathered" && !wide_strategy(strategy.name)) continue;
        expected += 8;
        for (const std::uint32_t fan_out : {2u, 4u, 8u, 16u})
          for (const char* frame : {"world", "body"}) {
            Variant variant;
            variant.volume = volume.name, variant.strategy = strategy.name, variant.query = query;
            variant.fan_out = fan_out, variant.frame = frame, variant.kernel = kernel.name;
            variant.build = cells % 3 ? "top-down-surface-area" : "bottom-up";
            variant.leaf_size = 1 + static_cast<std::uint32_t>(cells % 4);
            test(variant);
          }
      }
  EXPECT_EQ(cells, expected);
}

INSTANTIATE_TEST_SUITE_P(Queries, Cells, testing::ValuesIn([] {
                           std::vector<std::string> names;
                           for (const auto& query : queries()) names.push_back(query.name);
                           return names;
                         }()),
                         [](const auto& info) { return info.param; });

/// What turns with its body is as large and as tight in either frame, so nearly the same pairs are
/// opened: what a posed volume grows by is all that differs.
TEST(Frames, HardlyChangeWhatRigidVolumesTest) {
  const Played scene = played(settings(60)[0]);
  ReplayOptions options;
  options.count = Count::on;
  const auto compiled = volumes();
  for (const char* volume : {"sphere", "obb", "rss"}) {
    if (!has(compiled, volume)) continue;
    for (const std::uint32_t fan_out : {2u, 8u}) {
      Variant variant;
      variant.volume = volume, variant.fan_out = fan_out, variant.query = "contacts";
      const auto world = replay(scene.meshes, scene.trace, variant, options);
      variant.frame = "body";
      const auto body = replay(scene.meshes, scene.trace, variant, options);
      EXPECT_NEAR(static_cast<double>(body.n_v), static_cast<double>(world.n_v),
                  0.01 * static_cast<double>(world.n_v))
          << volume;
      EXPECT_LT(world.n_u, body.n_u) << volume;
    }
  }
}

}  // namespace
}  // namespace bvlab
