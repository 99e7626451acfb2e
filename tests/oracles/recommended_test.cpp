// SPDX-License-Identifier: BSD-3-Clause
/// What is recommended for a motion: the program and the library choose alike, repeatably, by
/// counts of samples, and whatever is chosen answers as recursion does.
#include <gtest/gtest.h>

#include <set>
#include <type_traits>
#include <vector>

#include "experiments/replay/configurations.hpp"
#include "tests/oracles/settings.hpp"
#include "traversal/queries.hpp"
#include "traversal/recommended_for.hpp"

namespace bvlab {
namespace {

TEST(SampledFrames, LieInTheMotionAndAreAtMostATwentiethOfIt) {
  for (std::size_t length = 0; length < 3000; length += 1 + length / 7) {
    EXPECT_EQ(SampledFrames(length, 1).frames.empty(), length < 2000) << length;
    const SampledFrames samples(length, 10);
    EXPECT_EQ(samples.frames.empty(), length < 200) << length;
    EXPECT_LE(20 * samples.frames.size(), length);
    std::size_t counted = 0;
    for (std::size_t k = 0; k < samples.frames.size(); ++k) {
      EXPECT_LT(samples.frames[k], length);
      if (k > 0) {
        EXPECT_GT(samples.frames[k], samples.frames[k - 1]) << "each frame once, in order";
      }
      if (SampledFrames::counted(k)) {
        EXPECT_EQ(samples.frames[k], samples.frames[k - 1] + 1);
        ++counted;
      }
    }
    EXPECT_EQ(counted, samples.size());
  }
}

TEST(PairsOfMoved, AreThoseOfBodiesThatMovedAtMostFourEach) {
  const auto pairs = [](std::size_t bodies, std::size_t moved) {
    std::vector<Pose> before(bodies), now(bodies);
    for (std::size_t i = 0; i < moved; ++i) now[i].translation[0] += 1;
    return pairs_of_moved(before, now);
  };
  EXPECT_EQ(pairs(9, 0), 0u);
  EXPECT_EQ(pairs(9, 1), 4u);
  EXPECT_EQ(pairs(9, 9), 36u);
  EXPECT_EQ(pairs(4, 2), 5u);
  EXPECT_EQ(pairs(2, 1), 1u);
  EXPECT_EQ(pairs(2, 2), 1u);
  EXPECT_EQ(pairs(100, 100), 400u);
}

std::vector<std::vector<Pose>> frames_of(const Trace& trace) {
  std::vector<std::vector<Pose>> frames(trace.frames, std::vector<Pose>(trace.objects));
  for (std::size_t k = 0; k < trace.frames; ++k) trace.poses(k, frames[k]);
  return frames;
}

/// The volume, the build, the leaf size and the strategy of what the library recommends.
template <class MakeQuery>
Variant by_library(const Played& scene, MakeQuery&& make_query) {
  const auto frames = frames_of(scene.trace);
  return with_recommended(scene.meshes, frames, make_query,
                          []<class Best>(std::type_identity<Best>) {
                            Variant variant;
                            variant.volume = Best::Volume::name, variant.build = Best::Build::name;
                            variant.leaf_size = Best::leaf_size;
                            variant.strategy = Best::Memory::name;
                            return variant;
                          });
}

/// Bodies that drift slowly past each other, that wander fast, and thin plates.
std::vector<Played> scenes() {
  // Long enough for every kind of trees to pay.
  std::vector<Played> all{played({"slow", {{"knot", 200}}, walk(6, 3000, 2, 0.001, 0.1, 0)}),
                          played({"fast", {{"bumpy-sphere", 320}}, walk(6, 3000, 2, 0.1, 9, 0)}),
                          played({"thin", {{"box", 108}}, walk(5, 3000, 2, 0.02, 3, 0)})};
  for (auto& vertex : all[2].meshes[0].vertices) vertex[0] *= 20;
  return all;
}

TEST(Recommended, ProgramAndLibraryChooseAlikeAndAnswersStay) {
  std::set<std::string> volumes, strategies;
  for (const auto& scene : scenes())
    for (const char* query : {"touching", "contacts"}) {
      Variant variant;
      variant.query = query;
      const Chosen chosen = configured(variant, "recommended", scene.meshes, &scene.trace);
      const Chosen again = configured(variant, "recommended", scene.meshes, &scene.trace);
      EXPECT_EQ(chosen.reason, again.reason);
      EXPECT_NE(chosen.reason.find("sampled frames"), std::string::npos) << chosen.reason;
      std::vector<Contact> found;
      const Variant library = std::string_view(query) == "touching"
                                  ? by_library(scene, [](std::size_t) { return Touching(); })
                                  : by_library(scene, [&](std::size_t) { return Contacts(found); });
      EXPECT_EQ(chosen.variant.volume, library.volume);
      EXPECT_EQ(chosen.variant.build, library.build);
      EXPECT_EQ(chosen.variant.leaf_size, library.leaf_size);
      EXPECT_EQ(chosen.variant.strategy, library.strategy);
      const auto truth = replay(scene.meshes, scene.trace, variant, {});
      const auto result = replay(scene.meshes, scene.trace, chosen.variant, {});
      EXPECT_EQ(result.touching, truth.touching);
      EXPECT_EQ(result.contacts, truth.contacts);
      volumes.insert(chosen.variant.volume), strategies.insert(chosen.variant.strategy);
    }
  EXPECT_GT(volumes.size(), 1u) << "the scenes are to differ in what suits them";
  EXPECT_GT(strategies.size(), 1u) << "the scenes are to differ in what suits them";
}

TEST(RunCosts, SayWhatMayPay) {
  RunCosts costs(1000, 10'000);
  EXPECT_TRUE(costs.may_pay(1e9)) << "the first is tried in any case";
  EXPECT_TRUE(costs.is_best(600, 1000)) << "10.6 ms";
  EXPECT_FALSE(costs.may_pay(4000)) << "twice 4 ms, where at most 7 are saved";
  EXPECT_TRUE(costs.may_pay(3000));
  EXPECT_FALSE(costs.is_best(8000, 300)) << "11 ms";
  EXPECT_TRUE(costs.is_best(3000, 500)) << "8 ms";
}

/// Where one body of nine moves, most pairs keep their answers, and recursion would repeat them.
TEST(Recommended, MarginsAreChosenWhereFewBodiesMove) {
  const Played scene = played({"one mover", {{"torus", 500}}, walk(9, 400, 3, 0.03, 5, 0, 1)});
  const Chosen chosen = configured({}, "recommended", scene.meshes, &scene.trace);
  EXPECT_EQ(chosen.variant.strategy, "margins") << chosen.reason;
}

/// Where no trees can pay that are built whole, none is.
TEST(Recommended, ShortMotionsTakeWhatIsBuiltFastest) {
  for (const double stretch : {1.0, 20.0}) {
    Played scene = played(settings(23)[0]);
    for (auto& mesh : scene.meshes)
      for (auto& vertex : mesh.vertices) vertex[0] *= stretch;
    const Chosen of_motion = configured({}, "recommended", scene.meshes, &scene.trace);
    const Chosen of_meshes = configured({}, "recommended", scene.meshes);
    EXPECT_NE(of_motion.reason.find("too short"), std::string::npos) << of_motion.reason;
    EXPECT_EQ(of_motion.variant.volume, "slab-box");
    EXPECT_EQ(of_motion.variant.build, "on-demand");
    EXPECT_EQ(of_meshes.variant.volume, "slab-box");
    const auto later = later_choice(of_meshes.variant, scene.meshes);
    ASSERT_EQ(later.has_value(), stretch > 1);
    if (later) {
      EXPECT_EQ(later->variant.volume, "obb");
    }
    const Variant library = by_library(scene, [](std::size_t) { return Touching(); });
    EXPECT_EQ(library.volume, of_motion.variant.volume);
    EXPECT_EQ(library.build, of_motion.variant.build);
  }
}

}  // namespace
}  // namespace bvlab
