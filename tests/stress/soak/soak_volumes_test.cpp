// SPDX-License-Identifier: BSD-3-Clause
/// Coherent equals fresh, for ever: every strategy over every volume, for every query, on one long
/// way, beside recursion over spheres; and wide trees, from the roots and with margins.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <string>

#include "experiments/replay/registry.hpp"
#include "experiments/replay/replay.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "tests/stress/soak/way.hpp"

namespace bvlab {
namespace {

Trace long_way(std::size_t frames) {
  Trace trace{frames, 2, {}};
  Way way;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    way.step();
    const auto values = way.values();
    trace.values.insert(trace.values.end(), values.begin(), values.end());
  }
  return trace;
}

class SoakOfVolumes : public ::testing::Test {
 protected:
  static ReplayResult played(const Variant& variant, bool series = false) {
    ReplayOptions options;
    options.keep_series = series;
    return replay(meshes(), trace(), variant, options);
  }
  static const Trace& trace() {
    static const Trace made = long_way(soak_frames(3000));
    return made;
  }
  static const std::vector<TriangleMesh>& meshes() {
    static const std::vector<TriangleMesh> made{formula_mesh("star", 60),
                                                formula_mesh("torus", 64)};
    return made;
  }
  static const ReplayResult& fresh(const std::string& query) {
    static std::map<std::string, ReplayResult> all;
    const auto at = all.find(query);
    if (at != all.end()) return at->second;
    Variant variant;
    variant.query = query;
    return all.emplace(query, played(variant)).first->second;
  }

  static void expect_fresh(Variant variant) {
    const std::string where = variant.kernel + ' ' + std::to_string(variant.fan_out) + ' ' +
                              variant.frame + ' ' + variant.volume + ' ' + variant.strategy;
    variant.query = "touching";
    EXPECT_EQ(played(variant).touching, fresh("touching").touching) << where;
    variant.query = "contacts";
    const ReplayResult contacts = played(variant, true);
    EXPECT_EQ(contacts.contacts, fresh("contacts").contacts) << where;
    // A front holds no more than the pairs of leaves.
    for (const auto& frame : contacts.series) ASSERT_LE(frame.front, 60 * 64) << where;
    variant.query = "distance";
    const auto distances = played(variant).distances;
    const auto& truth = fresh("distance").distances;
    ASSERT_EQ(distances.size(), truth.size());
    for (std::size_t frame = 0; frame < truth.size(); ++frame)
      ASSERT_NEAR(distances[frame], truth[frame], 1e-12 * truth[frame])
          << where << ", frame " << frame;
  }
};

/// Four bodies on two ways by three threads, beside recursion by one.
TEST_F(SoakOfVolumes, ThreadsEqualFresh) {
  Trace four{soak_frames(3000), 4, {}};
  Way here, there;
  for (int k = 0; k < 1000; ++k) there.step();
  for (std::size_t frame = 0; frame < four.frames; ++frame)
    for (Way* way : {&here, &there}) {
      way->step();
      const auto values = way->values();
      four.values.insert(four.values.end(), values.begin(), values.end());
    }
  for (const char* query : {"touching", "contacts"}) {
    Variant variant;
    variant.query = query;
    const ReplayResult truth = replay(meshes(), four, variant, {});
    EXPECT_GT(truth.hits, four.frames / 20);
    ReplayOptions options;
    options.threads = 3;
    for (const auto& [tree, volume, strategy] :
         {std::array{"binary", "obb", "margins"}, std::array{"binary", "sphere", "adaptive"},
          std::array{"binary", "sphere", "deferred"}, std::array{"wide", "slab-box", "recursive"},
          std::array{"wide", "slab-box", "margins"}}) {
      set_tree(variant, tree);
      variant.volume = volume, variant.strategy = strategy;
      const ReplayResult found = replay(meshes(), four, variant, options);
      EXPECT_EQ(found.touching, truth.touching) << tree << ' ' << volume << ' ' << strategy;
      EXPECT_EQ(found.contacts, truth.contacts) << tree << ' ' << volume << ' ' << strategy;
    }
  }
}

TEST_F(SoakOfVolumes, WideTreesEqualFresh) {
  for (const char* kernel : {"siblings", "mixed"})
    for (const auto& volume : wide_volumes(kernel))
      for (const char* strategy : {"recursive", "margins"}) {
        Variant variant;
        set_kernel(variant, kernel);
        variant.volume = volume.name, variant.strategy = strategy;
        variant.leaf_size = 16;
        expect_fresh(variant);
      }
}

struct OfVolume : SoakOfVolumes, ::testing::WithParamInterface<std::string> {};

TEST_P(OfVolume, CoherentEqualsFresh) {
  for (const auto& strategy : strategies()) {
    Variant variant;
    variant.volume = GetParam(), variant.strategy = strategy.name;
    this->expect_fresh(variant);
    variant.fan_out = 8, variant.frame = "body";
    this->expect_fresh(variant);
  }
}
INSTANTIATE_TEST_SUITE_P(Volumes, OfVolume, testing::ValuesIn([] {
                           std::vector<std::string> names;
                           for (const auto& volume : volumes()) names.push_back(volume.name);
                           return names;
                         }()));

}  // namespace
}  // namespace bvlab
