// SPDX-License-Identifier: BSD-3-Clause
/// Every volume, strategy and query gives in every frame what the recursive algorithm gives,
/// and that is what brute force with CGAL's exact predicates says.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "experiments/peers/triangle_oracle.hpp"
#include "experiments/replay/registry.hpp"
#include "tests/oracles/settings.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"

namespace bvlab {
namespace {

ReplayResult answer(const Played& scene, const std::string& strategy, const char* query,
                    std::string_view volume = "sphere") {
  Variant variant;
  variant.volume = volume;
  variant.strategy = strategy;
  variant.query = query;
  variant.leaf_size = query == std::string("contacts") ? 2 : 1;
  return replay(scene.meshes, scene.trace, variant, {});
}

std::vector<std::string> all_strategies() {
  std::vector<std::string> names{"deferred:4"};
  for (const auto& strategy : strategies()) names.push_back(strategy.name);
  return names;
}

/// Every strategy of every volume against recursive spheres; `volumes` says which.
template <class Wanted>
void expect_recursive_answers(std::size_t frames, Wanted wanted) {
  for (const auto& setting : settings(frames)) {
    const Played scene = played(setting);
    const auto touching = answer(scene, "recursive", "touching");
    const auto contacts = answer(scene, "recursive", "contacts");
    // Both queries agree on who touches.
    std::vector<std::uint8_t> in_contact(touching.touching.size(), 0);
    const auto n = static_cast<std::uint32_t>(scene.trace.objects);
    for (const auto& [frame, i, j, a, b] : contacts.contacts)
      in_contact[frame * scene.trace.pairs() + i * n - i * (i + 1) / 2 + (j - i - 1)] = 1;
    EXPECT_EQ(in_contact, touching.touching) << setting.name;
    EXPECT_GT(touching.hits, 0u) << setting.name;
    EXPECT_LT(touching.hits, touching.touching.size()) << setting.name;
    for (const auto& [volume, description] : volumes()) {
      if (!wanted(volume)) continue;
      for (const std::string& strategy : all_strategies()) {
        EXPECT_EQ(answer(scene, strategy, "touching", volume).touching, touching.touching)
            << setting.name << ' ' << strategy << ' ' << volume;
        EXPECT_EQ(answer(scene, strategy, "contacts", volume).contacts, contacts.contacts)
            << setting.name << ' ' << strategy << ' ' << volume;
      }
    }
  }
}

TEST(Strategies, GiveTheRecursiveAnswerInEveryFrameOfLongRuns) {
  expect_recursive_answers(10000, [](std::string_view name) { return name == "sphere"; });
}

TEST(Strategies, GiveTheRecursiveAnswerForEveryVolume) {
  expect_recursive_answers(1000, [](std::string_view) { return true; });
}

/// Whoever is asked again where he stood finds what he found, however little of it was written
/// down.
TEST(Strategies, AnswersLastWhileBodiesRest) {
  for (const auto& setting : settings(600)) {
    Played scene = played(setting);
    const std::size_t values = 7 * scene.trace.objects;
    std::vector<double> halting;
    for (std::size_t frame = 0; frame < scene.trace.frames; ++frame) {
      const auto first = scene.trace.values.begin() + static_cast<std::ptrdiff_t>(frame * values);
      // Now and then two frames more in the same place.
      for (int copies = frame % 4 == 3 ? 3 : 1; copies > 0; --copies)
        halting.insert(halting.end(), first, first + static_cast<std::ptrdiff_t>(values));
    }
    scene.trace.frames = halting.size() / values;
    scene.trace.values = std::move(halting);
    const auto touching = answer(scene, "recursive", "touching").touching;
    const auto contacts = answer(scene, "recursive", "contacts").contacts;
    for (const std::string& strategy : all_strategies()) {
      EXPECT_EQ(answer(scene, strategy, "touching").touching, touching)
          << setting.name << ' ' << strategy;
      EXPECT_EQ(answer(scene, strategy, "contacts").contacts, contacts)
          << setting.name << ' ' << strategy;
    }
  }
}

/// Who comes back to where he stood finds what he found, though deadlines that had passed have then
/// not passed again.
TEST(Strategies, AnswersAreTheSameWhereBodiesReturn) {
  for (const std::size_t moving : {0u, 1u}) {
    Setting setting{"to and fro", {{"star", 240}}, walk(4, 40, 2.5, 0.01, 1, 0, moving)};
    setting.walk.freedoms = moving ? "one" : "all";
    Played scene = played(setting);
    const std::size_t values = 7 * scene.trace.objects;
    std::mt19937 random(20260101);
    std::vector<double> roaming;
    std::ptrdiff_t at = 0;
    for (int frame = 0; frame < 600; ++frame) {
      const auto first = scene.trace.values.begin() + at * static_cast<std::ptrdiff_t>(values);
      roaming.insert(roaming.end(), first, first + static_cast<std::ptrdiff_t>(values));
      at = std::clamp<std::ptrdiff_t>(at + std::uniform_int_distribution(-3, 3)(random), 0, 39);
    }
    scene.trace.frames = 600;
    scene.trace.values = std::move(roaming);
    for (const char* volume : {"sphere", "obb"}) {
      const auto touching = answer(scene, "recursive", "touching", volume).touching;
      const auto contacts = answer(scene, "recursive", "contacts", volume).contacts;
      for (const std::string& strategy : all_strategies()) {
        EXPECT_EQ(answer(scene, strategy, "touching", volume).touching, touching) << strategy;
        EXPECT_EQ(answer(scene, strategy, "contacts", volume).contacts, contacts) << strategy;
      }
    }
  }
}

bool boxes_meet(const Triangle& a, const Triangle& b) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto [la, ha] = std::minmax({a[0][axis], a[1][axis], a[2][axis]});
    const auto [lb, hb] = std::minmax({b[0][axis], b[1][axis], b[2][axis]});
    if (ha < lb || hb < la) return false;
  }
  return true;
}

/// Every pair of triangles of every pair of objects, by CGAL's exact predicates.
std::vector<std::array<std::uint32_t, 5>> brute_force(const Played& scene, std::uint32_t frame) {
  std::vector<std::array<std::uint32_t, 5>> contacts;
  std::vector<Pose> poses(scene.trace.objects);
  scene.trace.poses(frame, poses);
  std::vector<std::vector<Triangle>> world(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto& mesh = scene.meshes[i % scene.meshes.size()];
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      Triangle triangle = mesh.corners(t);
      for (auto& corner : triangle) corner = poses[i](corner);
      world[i].push_back(triangle);
    }
  }
  for (const auto& [i, j] : all_object_pairs(static_cast<std::uint32_t>(poses.size())))
    for (std::uint32_t a = 0; a < world[i].size(); ++a)
      for (std::uint32_t b = 0; b < world[j].size(); ++b)
        if (boxes_meet(world[i][a], world[j][b]) && oracle::intersect(world[i][a], world[j][b]))
          contacts.push_back({frame, i, j, a, b});
  return contacts;
}

TEST(Strategies, TheRecursiveAnswerIsThatOfExactPredicates) {
  for (const auto& setting : settings(60)) {
    const Played scene = played(setting);
    const auto contacts = answer(scene, "recursive", "contacts").contacts;
    std::vector<std::array<std::uint32_t, 5>> truth;
    for (std::uint32_t frame = 0; frame < scene.trace.frames; ++frame) {
      const auto more = brute_force(scene, frame);
      truth.insert(truth.end(), more.begin(), more.end());
    }
    EXPECT_EQ(contacts, truth) << setting.name;
    EXPECT_GT(truth.size(), 100u) << setting.name;
  }
}

/// Answers, contacts, distances and counts, frame by frame, are those of one thread.
void expect_threads_change_nothing(const Played& scene, const Variant& variant) {
  ReplayOptions options;
  options.count = Count::on, options.keep_series = true;
  const auto one = replay(scene.meshes, scene.trace, variant, options);
  for (const unsigned threads : {2u, 3u, 7u}) {
    const std::string where = variant.volume + " " + variant.strategy + " " + variant.query + " " +
                              std::to_string(threads);
    options.threads = threads;
    const auto more = replay(scene.meshes, scene.trace, variant, options);
    EXPECT_EQ(one.touching, more.touching) << where;
    EXPECT_EQ(one.contacts, more.contacts) << where;
    EXPECT_EQ(one.distances, more.distances) << where;
    EXPECT_EQ(one.hits, more.hits) << where;
    EXPECT_EQ(one.n_u, more.n_u) << where;
    EXPECT_EQ(one.n_v, more.n_v) << where;
    EXPECT_EQ(one.n_p, more.n_p) << where;
    EXPECT_EQ(one.considered, more.considered) << where;
    EXPECT_EQ(one.front, more.front) << where;
    ASSERT_EQ(one.series.size(), more.series.size()) << where;
    for (std::size_t frame = 0; frame < one.series.size(); ++frame)
      EXPECT_TRUE(one.series[frame].n_u == more.series[frame].n_u &&
                  one.series[frame].n_v == more.series[frame].n_v &&
                  one.series[frame].front == more.series[frame].front)
          << where << " frame " << frame;
  }
}

TEST(Strategies, ThreadsChangeNothing) {
  const Played scene = played(settings(60)[0]);
  for (const char* query : {"touching", "contacts", "distance"}) {
    for (const char* volume : {"sphere", "obb"})
      for (const auto& strategy : strategies()) {
        Variant variant;
        variant.volume = volume, variant.strategy = strategy.name, variant.query = query;
        expect_threads_change_nothing(scene, variant);
        variant.fan_out = 4, variant.frame = "body";
        expect_threads_change_nothing(scene, variant);
      }
    for (const char* strategy : {"recursive", "margins"}) {
      Variant variant;
      set_tree(variant, "wide");
      variant.volume = "slab-box";
      variant.strategy = strategy, variant.query = query;
      expect_threads_change_nothing(scene, variant);
    }
  }
}

}  // namespace
}  // namespace bvlab
