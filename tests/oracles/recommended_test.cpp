// SPDX-License-Identifier: BSD-3-Clause
/// What is recommended: which candidate goes on in runs of given costs, what trials may take, and
/// that answers are those of recursion whatever is tried.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "experiments/replay/configurations.hpp"
#include "experiments/replay/trials.hpp"
#include "experiments/replay/worlds.hpp"
#include "tests/oracles/settings.hpp"

namespace bvlab {
namespace {

struct Outcome {
  std::size_t current;
  double run, spent;  ///< by what answered, and by trials
};

/// A run of so many frames, in which candidate k takes `cost(k, frame)` for each.
template <class Cost>
Outcome play(Trials& trials, std::size_t frames, const std::vector<double>& build, Cost&& cost) {
  Outcome outcome{};
  std::optional<std::size_t> tried;
  std::vector<bool> built(build.size());
  for (std::size_t frame = 0; frame < frames; ++frame) {
    trials.next();
    if (trials.tried() && trials.tried() != tried) {
      trials.made(built[*trials.tried()] ? 0 : build[*trials.tried()]);
      built[*trials.tried()] = true;
    }
    tried = trials.tried();
    const double own = cost(trials.current(), frame);
    outcome.run += own;
    if (trials.times()) trials.took(own, tried ? cost(*tried, frame) : 0);
    if (!trials.tried()) tried.reset();
  }
  outcome.current = trials.current(), outcome.spent = trials.spent();
  return outcome;
}

const std::vector<double> builds{0, 0, 5e5, 2e6};

Trials trials_of(std::size_t frames) {
  return Trials({{"first", 0, "a"}, {"roots", 0, "a"}, {"small", 5e5, "b"}, {"large", 2e6, "c"}},
                frames);
}

TEST(Trials, TheFastestGoesOnAndTrialsTakeTheirShare) {
  for (const std::size_t known : {std::size_t{0}, std::size_t{5000}})
    for (std::size_t fastest = 0; fastest < 4; ++fastest) {
      Trials trials = trials_of(known);
      const Outcome found = play(trials, 5000, builds, [&](std::size_t k, std::size_t frame) {
        return (k == fastest ? 5e3 : 1e4 + 1e3 * static_cast<double>(k)) *
               (1 + 0.3 * static_cast<double>(frame % 7));
      });
      EXPECT_EQ(found.current, fastest) << trials.reason();
      EXPECT_LE(found.spent, 0.25 * found.run) << trials.reason();
    }
}

TEST(Trials, ShortRunsHaveNone) {
  Trials trials = trials_of(20);
  const Outcome found = play(trials, 20, builds, [](std::size_t, std::size_t) { return 1e4; });
  EXPECT_EQ(found.current, 0u);
  EXPECT_EQ(found.spent, 0) << trials.reason();
  EXPECT_NE(trials.reason().find("too short"), std::string::npos) << trials.reason();
}

/// Frames that make trees take 20 times as long as later ones; foretold from them, the run would
/// repay trees that take as long as all of it.
TEST(Trials, MakingTreesOnDemandIsNoSignOfLongFrames) {
  for (const bool is_said : {false, true}) {
    Trials trials({{"on demand", 0, "a", is_said ? 1.5e6 : 0}, {"built", 1e6, "b"}}, 2000);
    const Outcome found = play(trials, 2000, {0, 1e6}, [](std::size_t, std::size_t frame) {
      return frame < 100 ? 1e4 : 5e2;
    });
    EXPECT_EQ(found.spent > 0, !is_said) << trials.reason();
  }
}

TEST(Trials, WhatBecomesFasterLaterIsFound) {
  Trials trials = trials_of(0);
  const Outcome found = play(trials, 60'000, builds, [](std::size_t k, std::size_t frame) {
    return k == (frame < 20'000 ? 1u : 3u) ? 5e3 : 1e4;
  });
  EXPECT_EQ(found.current, 3u) << trials.reason();
}

TEST(Trials, WhatCannotBeMadeIsNotTriedAgain) {
  Trials trials = trials_of(0);
  std::size_t failed = 0;
  for (std::size_t frame = 0; frame < 20'000; ++frame) {
    trials.next();
    if (trials.tried() == 1)
      trials.made(std::nullopt), ++failed;
    else if (trials.tried())
      trials.made(0);
    if (trials.times()) trials.took(1e4, 2e4);
  }
  EXPECT_EQ(failed, 1u);
  EXPECT_EQ(trials.current(), 0u);
}

/// Bodies that drift slowly past each other, that wander fast, and thin plates.
std::vector<Played> scenes() {
  std::vector<Played> all{played({"slow", {{"knot", 200}}, walk(6, 600, 2, 0.001, 0.1, 0)}),
                          played({"fast", {{"bumpy-sphere", 320}}, walk(6, 600, 2, 0.1, 9, 0)}),
                          played({"thin", {{"box", 108}}, walk(5, 600, 2, 0.02, 3, 0)}),
                          played({"one mover", {{"torus", 500}}, walk(9, 400, 3, 0.03, 5, 0, 1)})};
  for (auto& vertex : all[2].meshes[0].vertices) vertex[0] *= 20;
  return all;
}

TEST(Recommended, AnswersStayWhileVariantsAreTried) {
  for (const auto& scene : scenes())
    for (const char* query : {"touching", "contacts", "distance"})
      for (const unsigned threads : {1u, 3u}) {
        Variant variant;
        variant.query = query;
        ReplayOptions options;
        options.threads = threads;
        options.broad_phase =
            threads > 1 && std::string_view(query) != "distance" ? BroadPhase::on : BroadPhase::off;
        const auto truth = replay(scene.meshes, scene.trace, variant, {});
        const auto result =
            replay(scene.meshes, scene.trace, configured(variant, "recommended"), options);
        EXPECT_EQ(result.touching, truth.touching);
        EXPECT_EQ(result.contacts, truth.contacts);
        // Of several nearest pairs of triangles, distances differ by rounding.
        ASSERT_EQ(result.distances.size(), truth.distances.size());
        for (std::size_t k = 0; k < truth.distances.size(); ++k)
          ASSERT_NEAR(result.distances[k], truth.distances[k], 1e-13) << k;
        ASSERT_TRUE(result.chosen);
        EXPECT_NE(result.chosen->find("in trials"), std::string::npos) << *result.chosen;
        EXPECT_GT(result.choosing_seconds, 0);
      }
}

TEST(Recommended, AWholeSceneAnswersTheSame) {
  for (const auto& scene : scenes()) {
    const auto world = make_world(scene.meshes, scene.trace.objects, configured({}, "recommended"));
    const auto reference = make_world(scene.meshes, scene.trace.objects, {});
    const WorldRun found = play_frames(*world, scene.trace, Answers::kept);
    EXPECT_EQ(differing(found, play_frames(*reference, scene.trace, Answers::kept)), 0u);
  }
}

/// Where triangles are long, oriented boxes are tried before other trees that are built whole.
TEST(Recommended, CandidatesGoByTheMeshes) {
  Played scene = played(settings(23)[0]);
  EXPECT_EQ(recommendations({}, scene.meshes).at(2).name, "slab-boxes in small leaves");
  for (auto& mesh : scene.meshes)
    for (auto& vertex : mesh.vertices) vertex[0] *= 20;
  const auto all = recommendations({}, scene.meshes);
  EXPECT_EQ(all.at(2).name, "oriented boxes");
  EXPECT_EQ(all.size(), 6u);
  Variant variant;
  variant.query = "distance";
  for (const Recommendation& each : recommendations(variant, scene.meshes)) {
    EXPECT_EQ(each.variant.query, "distance");
    EXPECT_FALSE(each.variant.chooses_in_turn);
    EXPECT_NO_THROW(check(each.variant)) << each.name;
  }
}

}  // namespace
}  // namespace bvlab
