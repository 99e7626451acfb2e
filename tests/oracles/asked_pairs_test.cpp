// SPDX-License-Identifier: BSD-3-Clause
/// Pairs that are asked for or left out, and the broad phase of a replay: answers are those of
/// asking all pairs, from the roots.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <span>

#include "experiments/files/unusable.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/replay/replay.hpp"
#include "experiments/replay/worlds.hpp"
#include "experiments/scenes/extent.hpp"
#include "experiments/scenes/pair_files.hpp"
#include "experiments/scenes/parts.hpp"
#include "tests/oracles/settings.hpp"
#include "traversal/primitives/triangle_distance.hpp"

namespace bvlab {
namespace {

using List = std::vector<ObjectPair>;
using Pairs = std::vector<std::array<std::uint32_t, 2>>;

Pairs rows(const std::vector<ObjectPair>& pairs) {
  Pairs all;
  for (const auto& [i, j] : pairs) all.push_back({i, j});
  return all;
}

TEST(PairChoice, ListsWhatIsAskedForWithoutWhatIsLeftOut) {
  EXPECT_EQ(rows(chosen_pairs({}, 3)), (Pairs{{0, 1}, {0, 2}, {1, 2}}));
  EXPECT_TRUE(chosen_pairs({}, 1).empty());
  EXPECT_EQ(rows(chosen_pairs({.only = List{{3, 1}, {0, 2}}}, 4)), (Pairs{{1, 3}, {0, 2}}));
  EXPECT_EQ(rows(chosen_pairs({.without = List{{2, 0}}}, 3)), (Pairs{{0, 1}, {1, 2}}));
  EXPECT_EQ(rows(chosen_pairs({.groups = {5, -1, 5, -1}}, 4)),
            (Pairs{{0, 1}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}));
  const PairChoice all_three{
      .only = List{{0, 1}, {0, 2}, {1, 2}}, .without = List{{1, 2}}, .groups = {0, 0, 1}};
  EXPECT_EQ(rows(chosen_pairs(all_three, 3)), (Pairs{{0, 2}}));
  EXPECT_TRUE(chosen_pairs({.only = List{}}, 4).empty());
}

TEST(PairChoice, RefusesWithTheRow) {
  const auto complaint = [](const PairArrays& arrays) -> std::string {
    try {
      pair_choice(arrays, 4);
    } catch (const Unusable& fault) {
      return fault.what();
    }
    return "";
  };
  const auto numbers = [](std::vector<std::int64_t> values) {
    return NamedNumbers{"f.npy", std::move(values)};
  };
  EXPECT_EQ(complaint({.pairs = numbers({0, 1, 2, 4})}), "f.npy: row 1: no object 4; there are 4");
  EXPECT_EQ(complaint({.without = numbers({-1, 1})}), "f.npy: row 0: no object -1; there are 4");
  EXPECT_EQ(complaint({.pairs = numbers({2, 2})}), "f.npy: row 0: object 2 with itself");
  EXPECT_EQ(complaint({.pairs = numbers({0, 1, 2, 3, 1, 0})}),
            "f.npy: row 2: the same pair as in row 0");
  EXPECT_EQ(complaint({.without = numbers({0, 1, 1, 0})}), "");
  EXPECT_EQ(complaint({.groups = numbers({0, 1})}), "f.npy: has groups of 2 objects; there are 4");
}

struct Stage {
  std::vector<TriangleMesh> meshes;
  Trace trace;
};

Stage walking(std::size_t objects, double side) {
  Stage stage;
  std::vector<Extent> extents;
  for (const auto& [name, polygons] : {std::pair("star", 60), std::pair("torus", 64)}) {
    stage.meshes.push_back(formula_mesh(name, static_cast<std::size_t>(polygons)));
    extents.push_back(extent_of(stage.meshes.back()));
  }
  RandomWalk walk;
  walk.objects = objects, walk.frames = 40;
  walk.side = {side, Length::Unit::body}, walk.step = {0.1, Length::Unit::body};
  walk.teleport = 0.1;
  auto array = walk.generate(extents, {});
  stage.trace = {array.shape[0], array.shape[1], std::move(array.data)};
  return stage;
}

Stage standing(std::size_t objects, const char* joints = "mixed", std::size_t frames = 2) {
  Parts parts;
  parts.objects = objects, parts.frames = frames, parts.joints = joints;
  Stage stage;
  for (auto& each : parts.own_meshes()) stage.meshes.push_back(std::move(each.mesh));
  auto array = parts.generate({}, {});
  stage.trace = {array.shape[0], array.shape[1], std::move(array.data)};
  return stage;
}

/// Every volume and strategy under every kernel.
void for_each_variant(const std::string& query, const std::function<void(const Variant&)>& visit) {
  Variant variant;
  variant.query = query;
  for (const auto& [volume, same] : volumes())
    for (const auto& [strategy, too] : strategies()) {
      variant.volume = volume, variant.strategy = strategy;
      visit(variant);
    }
  for (const char* kernel : {"siblings", "mixed"})
    for (const auto& [volume, same] : wide_volumes(kernel))
      for (const char* strategy : {"recursive", "margins"}) {
        Variant wide;
        wide.query = query;
        set_kernel(wide, kernel);
        wide.volume = volume, wide.strategy = strategy;
        visit(wide);
      }
}

void expect_same(const ReplayResult& found, const ReplayResult& truth, const Variant& variant) {
  const std::string where = variant.volume + " " + variant.strategy + " " + variant.kernel;
  EXPECT_EQ(found.touching, truth.touching) << where;
  EXPECT_EQ(found.contacts, truth.contacts) << where;
  EXPECT_EQ(found.hits, truth.hits) << where;
}

TEST(BroadPhase, ChangesNoAnswer) {
  for (const Stage& stage : {walking(12, 4), walking(40, 12), standing(60)})
    for (const char* query : {"touching", "contacts"}) {
      Variant from_roots;
      from_roots.query = query;
      const ReplayResult truth = replay(stage.meshes, stage.trace, from_roots, {});
      EXPECT_GT(truth.hits, 10u);
      EXPECT_FALSE(truth.near);
      for_each_variant(query, [&](const Variant& variant) {
        ReplayOptions options;
        options.broad_phase = BroadPhase::on;
        for (const unsigned threads : {1u, 3u}) {
          options.threads = threads;
          const ReplayResult found = replay(stage.meshes, stage.trace, variant, options);
          expect_same(found, truth, variant);
          EXPECT_LT(found.near.value(), stage.trace.frames * stage.trace.pairs());
        }
      });
    }
}

TEST(BroadPhase, IsForManyBodiesAndQueriesOfNearPairs) {
  const Stage few = walking(12, 4), many = walking(40, 12);
  ReplayOptions options;
  options.broad_phase = BroadPhase::where_it_pays;
  EXPECT_FALSE(replay(few.meshes, few.trace, {}, options).near);
  EXPECT_TRUE(replay(many.meshes, many.trace, {}, options).near);
  Variant distance;
  distance.query = "distance";
  EXPECT_FALSE(replay(many.meshes, many.trace, distance, options).near);
  options.count = Count::on;
  EXPECT_FALSE(replay(many.meshes, many.trace, {}, options).near);
  options.broad_phase = BroadPhase::on;
  EXPECT_TRUE(replay(many.meshes, many.trace, {}, options).near);
  EXPECT_THROW(replay(few.meshes, few.trace, distance, options), Unusable);
}

/// The columns of chosen pairs are those that all pairs have.
TEST(ChosenPairs, HaveTheAnswersOfAllPairs) {
  Stage stage = walking(10, 4);
  const auto all = object_pairs(stage.trace);
  const auto column = [&](const ObjectPair& pair) {
    const auto same = [&](const ObjectPair& each) { return each.i == pair.i && each.j == pair.j; };
    return static_cast<std::size_t>(std::find_if(all.begin(), all.end(), same) - all.begin());
  };
  for (const PairChoice& choice : {PairChoice{.only = List{{7, 2}, {0, 1}, {3, 9}, {4, 5}}},
                                   PairChoice{.groups = {0, 0, 0, 1, 1, 1, -1, -1, 2, 2}},
                                   PairChoice{.without = List{{1, 2}}}})
    for (const char* query : {"touching", "contacts", "distance"}) {
      Variant from_roots;
      from_roots.query = query;
      stage.trace.chosen = nullptr;
      const ReplayResult whole = replay(stage.meshes, stage.trace, from_roots, {});
      const auto pairs = chosen_pairs(choice, 10);
      ReplayResult truth;
      for (std::size_t frame = 0; frame < stage.trace.frames; ++frame)
        for (const auto& pair : pairs) {
          const std::size_t cell = frame * all.size() + column(pair);
          if (!whole.touching.empty()) truth.touching.push_back(whole.touching[cell]);
          if (!whole.distances.empty()) truth.distances.push_back(whole.distances[cell]);
        }
      for (const auto& row : whole.contacts)
        if (PairFilter(choice)({row[1], row[2]})) truth.contacts.push_back(row);
      stage.trace.chosen = std::make_shared<const std::vector<ObjectPair>>(pairs);
      EXPECT_EQ(stage.trace.pairs(), pairs.size());
      for_each_variant(query, [&](const Variant& variant) {
        for (const BroadPhase broad_phase : {BroadPhase::off, BroadPhase::on}) {
          if (query == std::string("distance") && broad_phase == BroadPhase::on) continue;
          ReplayOptions options;
          options.broad_phase = broad_phase;
          const ReplayResult found = replay(stage.meshes, stage.trace, variant, options);
          EXPECT_EQ(found.touching, truth.touching) << variant.volume << ' ' << variant.strategy;
          EXPECT_EQ(found.contacts, truth.contacts) << variant.volume << ' ' << variant.strategy;
          ASSERT_EQ(found.distances.size(), truth.distances.size());
          for (std::size_t k = 0; k < truth.distances.size(); ++k)
            EXPECT_NEAR(found.distances[k], truth.distances[k], 0x1p-44 * truth.distances[k]);
        }
      });
    }
}

TEST(ChosenPairs, AreAllThatAWorldQueries) {
  const Stage stage = walking(14, 4);
  const PairChoice choice{.without = List{{0, 1}, {2, 3}}, .groups = {0, 1, 2, 3, 4, 4, 4, 4, 0}};
  Variant variant;
  const auto all = make_world(stage.meshes, stage.trace.objects, variant),
             some = make_world(stage.meshes, stage.trace.objects, variant);
  some->choose(choice);
  const WorldRun whole = play_frames(*all, stage.trace, Answers::kept),
                 part = play_frames(*some, stage.trace, Answers::kept);
  std::size_t left_out = 0;
  for (std::size_t frame = 0; frame < stage.trace.frames; ++frame) {
    std::vector<ObjectPair> expected = whole.answers[frame];
    left_out += std::erase_if(
        expected, [filter = PairFilter(choice)](const ObjectPair& pair) { return !filter(pair); });
    EXPECT_EQ(rows(part.answers[frame]), rows(expected)) << frame;
  }
  EXPECT_GT(left_out, 10u);
  EXPECT_LT(part.near, whole.near);
}

/// Along some axis, beyond any doubt.
bool far_apart(std::span<const Vec3<double>> a, std::span<const Vec3<double>> b) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto less = [axis](const auto& p, const auto& q) { return p[axis] < q[axis]; };
    const auto [low_a, high_a] = std::minmax_element(a.begin(), a.end(), less);
    const auto [low_b, high_b] = std::minmax_element(b.begin(), b.end(), less);
    if ((*low_a)[axis] > (*high_b)[axis] + 1e-9 || (*low_b)[axis] > (*high_a)[axis] + 1e-9)
      return true;
  }
  return false;
}

/// The least distance of two triangles, of those that are not far apart.
double distance_if_near(const TriangleMesh& a, const TriangleMesh& b) {
  double least = std::numeric_limits<double>::infinity();
  if (far_apart(a.vertices, b.vertices)) return least;
  for (std::size_t s = 0; s < a.triangles.size() && least > 0; ++s) {
    const Triangle of_a = a.corners(s);
    if (far_apart(of_a, b.vertices)) continue;
    for (std::size_t t = 0; t < b.triangles.size() && least > 0; ++t)
      if (const Triangle of_b = b.corners(t); !far_apart(of_a, of_b))
        least = std::min(least, distance(of_a, of_b).distance);
  }
  return least;
}

/// Brute force over all triangles of parts.
TEST(Parts, TouchWhereTheirTrianglesDo) {
  for (const char* joints : {"flush", "overlap", "apart", "mixed"}) {
    const Stage stage = standing(36, joints, 1);
    std::vector<std::uint8_t> touching;
    std::size_t just_apart = 0;
    for (const auto& [i, j] : object_pairs(stage.trace)) {
      const auto &a = stage.meshes[i], &b = stage.meshes[j];
      const double least = distance_if_near(a, b);
      touching.push_back(least == 0);
      just_apart += least > 0 && least < 1e-14;
    }
    EXPECT_EQ(just_apart > 10, joints == std::string("apart") || joints == std::string("mixed"))
        << joints << ' ' << just_apart;
    for_each_variant("touching", [&](const Variant& variant) {
      for (const BroadPhase broad_phase : {BroadPhase::off, BroadPhase::on}) {
        ReplayOptions options;
        options.broad_phase = broad_phase;
        EXPECT_EQ(replay(stage.meshes, stage.trace, variant, options).touching, touching)
            << joints << ' ' << variant.volume << ' ' << variant.strategy;
      }
    });
  }
}

TEST(Parts, AreAllDifferent) {
  const Stage stage = standing(600);
  std::vector<std::vector<std::array<double, 3>>> shapes;
  for (const TriangleMesh& mesh : stage.meshes) {
    EXPECT_GE(mesh.triangles.size(), 12u);
    auto& shape = shapes.emplace_back();
    for (const auto& v : mesh.vertices) shape.push_back({v[0], v[1], v[2]});
  }
  std::sort(shapes.begin(), shapes.end());
  EXPECT_EQ(std::adjacent_find(shapes.begin(), shapes.end()), shapes.end());
}

}  // namespace
}  // namespace bvlab
