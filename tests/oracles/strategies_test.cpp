// SPDX-License-Identifier: BSD-3-Clause
/// Every volume, strategy, query and width gives in every frame what the recursive algorithm gives,
/// and that is what brute force with CGAL's exact predicates says.
#include "traversal/strategies.hpp"

#include <gtest/gtest.h>

#include "experiments/runner/replay.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "experiments/scenes/random_walk.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes.hpp"
#include "tests/oracles/triangle_oracle.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"

namespace bvlab {
namespace {

struct Setting {
  const char* name;
  std::vector<std::pair<const char*, std::size_t>> meshes;
  RandomWalk walk;
};

RandomWalk walk(std::size_t objects, std::size_t frames, double side, double step, double degrees,
                double teleport, std::size_t moving = 0) {
  RandomWalk walk;
  walk.objects = objects;
  walk.frames = frames;
  walk.side = {side, Length::Unit::body};
  walk.step = {step, Length::Unit::body};
  walk.degrees = degrees;
  walk.teleport = teleport;
  walk.moving = moving;
  walk.seed = objects + frames;
  return walk;
}

/// Dense and sparse, slow and violent, one mover and all, with teleports between frames.
std::vector<Setting> settings(std::size_t frames) {
  return {
      {"dense", {{"star", 60}, {"torus", 64}}, walk(5, frames, 2, 0.05, 5, 0)},
      {"sparse", {{"bumpy-sphere", 80}}, walk(5, frames, 5, 0.05, 5, 0)},
      {"slow", {{"torus", 64}, {"knot", 96}}, walk(4, frames, 2, 0.001, 0.1, 0.002)},
      {"violent", {{"star", 60}, {"box", 12}}, walk(4, frames, 3, 0.5, 45, 0.1)},
      {"one mover", {{"icosphere", 80}, {"knot", 96}}, walk(6, frames, 3, 0.03, 5, 0.01, 1)},
  };
}

struct Played {
  std::vector<TriangleMesh> meshes;
  Trace trace;
};

Played played(const Setting& setting) {
  Played result;
  std::vector<Extent> extents;
  for (const auto& [name, polygons] : setting.meshes) {
    result.meshes.push_back(formula_mesh(name, polygons));
    extents.push_back(extent_of(result.meshes.back()));
  }
  auto array = setting.walk.generate(extents, {});
  result.trace = {array.shape[0], array.shape[1], std::move(array.data)};
  return result;
}

ReplayResult answer(const Played& scene, const char* strategy, const char* query,
                    std::string_view volume = Volumes::at<0>::name) {
  Variant variant;
  variant.volume = volume;
  variant.strategy = strategy;
  variant.query = query;
  variant.leaf_size = query == std::string("contacts") ? 2 : 1;
  return replay(scene.meshes, scene.trace, variant, {});
}

constexpr const char* coherent[] = {"separation-list", "deferred", "deferred:0", "deferred:4"};

TEST(Strategies, GiveTheRecursiveAnswerInEveryFrame) {
  for (const auto& setting : settings(10000)) {
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
    Volumes::for_each([&]<class V>(std::type_identity<V>) {
      for (const char* strategy : coherent) {
        EXPECT_EQ(answer(scene, strategy, "touching", V::name).touching, touching.touching)
            << setting.name << ' ' << strategy << ' ' << V::name;
        EXPECT_EQ(answer(scene, strategy, "contacts", V::name).contacts, contacts.contacts)
            << setting.name << ' ' << strategy << ' ' << V::name;
      }
    });
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

/// All contacts of all frames, tested W at a time.
template <class B, class V>
std::vector<std::array<std::uint32_t, 5>> at_width(const Played& scene) {
  std::vector<Hierarchy<V>> hierarchies;
  for (const auto& mesh : scene.meshes)
    hierarchies.emplace_back(mesh, builds::BottomUpLocal::topology(mesh, 1));
  std::vector<Shape<V>> shapes;
  for (std::size_t i = 0; i < scene.trace.objects; ++i)
    shapes.push_back(
        {&scene.meshes[i % scene.meshes.size()], &hierarchies[i % scene.meshes.size()]});
  AllPairs<B, V, Deferred> engine(
      shapes, all_object_pairs(static_cast<std::uint32_t>(shapes.size())), Deferred{});
  std::vector<std::array<std::uint32_t, 5>> contacts;
  std::vector<Pose> poses(scene.trace.objects);
  std::vector<Contact> found;
  NotCounting counter;
  for (std::size_t frame = 0; frame < scene.trace.frames; ++frame) {
    scene.trace.poses(frame, poses);
    engine.frame(
        poses, counter,
        [&](std::size_t) {
          found.clear();
          return Contacts(found);
        },
        [&](std::size_t p, const Contacts&) {
          for (const auto& [a, b] : found)
            contacts.push_back({static_cast<std::uint32_t>(frame), engine.pairs()[p].i,
                                engine.pairs()[p].j, a, b});
        });
  }
  std::sort(contacts.begin(), contacts.end());
  return contacts;
}

TEST(Strategies, EveryWidthAndScalarGivesTheSame) {
  for (const auto& setting : settings(300)) {
    const Played scene = played(setting);
    const auto contacts = answer(scene, "recursive", "contacts").contacts;
    Volumes::for_each([&]<class V>(std::type_identity<V>) {
      using Double = Over<V, double>;
      EXPECT_EQ((at_width<float, V>(scene)), contacts) << setting.name;
      EXPECT_EQ((at_width<Batch<float, 4>, V>(scene)), contacts) << setting.name;
      EXPECT_EQ((at_width<Batch<float, 8>, V>(scene)), contacts) << setting.name;
      EXPECT_EQ((at_width<Batch<float, 16>, V>(scene)), contacts) << setting.name;
      EXPECT_EQ((at_width<double, Double>(scene)), contacts) << setting.name;
      EXPECT_EQ((at_width<Batch<double, 4>, Double>(scene)), contacts) << setting.name;
    });
  }
}

TEST(Strategies, ThreadsChangeNothing) {
  const Played scene = played(settings(500)[0]);
  for (const char* query : {"touching", "contacts"}) {
    Variant variant;
    variant.strategy = "deferred";
    variant.query = query;
    ReplayOptions options;
    const auto one = replay(scene.meshes, scene.trace, variant, options);
    options.threads = 3;
    const auto three = replay(scene.meshes, scene.trace, variant, options);
    EXPECT_EQ(one.touching, three.touching);
    EXPECT_EQ(one.contacts, three.contacts);
    EXPECT_EQ(one.hits, three.hits);
  }
}

}  // namespace
}  // namespace bvlab
