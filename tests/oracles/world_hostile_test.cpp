// SPDX-License-Identifier: BSD-3-Clause
/// Whole scenes in which bodies come and go: brute force over all pairs of triangles finds the
/// same, whatever trees, strategies and threads; and counts are those of one thread.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>
#include <stdexcept>

#include "hierarchies/volumes/sphere.hpp"
#include "tests/oracles/wide_scenes.hpp"
#include "traversal/strategies.hpp"
#include "traversal/world.hpp"

namespace bvlab {
namespace {

/// A body where it is to be, or nowhere.
using Script = std::vector<std::vector<std::optional<Pose>>>;  // of each frame, of each body

/// Bodies come late, rest, creep, jump, leave for a while and come back where they were.
Script hostile_script(std::size_t bodies, int frames) {
  std::mt19937 random(20261122);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto anywhere = [&] {
    return *pose_from(1.6 * Vec3<double>(unit(random), unit(random), unit(random)), unit(random),
                      unit(random), unit(random), unit(random) + 2);
  };
  Script script;
  std::vector<std::optional<Pose>> now(bodies);
  std::vector<Pose> last(bodies);
  for (std::size_t i = 0; i < bodies; ++i) {
    last[i] = anywhere();
    if (i % 3) now[i] = last[i];
  }
  for (int frame = 0; frame < frames; ++frame) {
    script.push_back(now);
    for (std::size_t i = 0; i < bodies; ++i) {
      const double chance = std::abs(unit(random));
      auto& pose = now[i];
      if (!pose) {
        if (chance < 0.2) pose = last[i];
        continue;
      }
      if (chance < 0.05) {
        pose.reset();
      } else if (chance < 0.1) {
        pose = anywhere();
      } else if (chance < 0.6) {
        const double by = chance < 0.4 ? 0.002 : 0.05;
        pose->translation += by * Vec3<double>(unit(random), unit(random), unit(random));
      }
      if (pose) last[i] = *pose;
    }
  }
  return script;
}

/// Who is nowhere is far from everybody.
Truth truth_of(const Script& script, const std::vector<TriangleMesh>& meshes) {
  Scene scene{"hostile", meshes, {}};
  for (const auto& each : script) {
    PosesOfFrame frame;
    for (std::size_t i = 0; i < each.size(); ++i) {
      Pose far;
      far.translation = Vec3<double>(1e6 * (1.0 + static_cast<double>(i)), 0, 0);
      frame.push_back(each[i].value_or(far));
    }
    scene.frames.push_back(frame);
  }
  return truth_of(scene);
}

/// Moves bodies as one frame of the script says.
template <class World>
void follow(World& world, const Script& script, std::size_t frame) {
  for (std::uint32_t i = 0; i < script[frame].size(); ++i)
    if (const auto& pose = script[frame][i])
      world.move(i, *pose);
    else
      world.remove(i);
}

const std::vector<TriangleMesh>& hostile_meshes() {
  static const std::vector<TriangleMesh> meshes{formula_mesh("star", 24), formula_mesh("torus", 32),
                                                formula_mesh("box", 12)};
  return meshes;
}
constexpr std::size_t hostile_bodies = 12;
const Script& hostile_scene() {
  static const Script script = hostile_script(hostile_bodies, 60);
  return script;
}
const Truth& hostile_truth() {
  static const Truth truth = truth_of(hostile_scene(), hostile_meshes());
  return truth;
}

/// Which pairs touch, in every frame.
template <class World>
std::vector<std::uint8_t> touching_of(World& world, const Script& script) {
  std::vector<std::uint8_t> found;
  NotCounting counter;
  TouchingPairs touching;
  const auto pairs = all_object_pairs(hostile_bodies);
  for (std::size_t frame = 0; frame < script.size(); ++frame) {
    follow(world, script, frame);
    world.update(
        counter, [](const ObjectPair&) { return Touching(); },
        [&](std::uint32_t slot, const ObjectPair& pair, const Touching& query) {
          touching.put(slot, pair, query.touching());
        },
        [&](std::uint32_t slot) { touching.drop(slot); });
    for (const auto& [i, j] : pairs)
      found.push_back(static_cast<std::uint8_t>(
          std::count_if(touching.pairs().begin(), touching.pairs().end(),
                        [&](const auto& p) { return p.i == i && p.j == j; })));
  }
  return found;
}

/// One hierarchy for each mesh, and a shape for each body.
template <class Hierarchy, class Shape>
struct Shapes {
  std::vector<Hierarchy> hierarchies;
  std::vector<Shape> all;

  template <class Make>
  explicit Shapes(const Make& make) {
    for (const auto& mesh : hostile_meshes()) hierarchies.push_back(make(mesh));
    for (std::size_t i = 0; i < hostile_bodies; ++i)
      all.push_back({&hostile_meshes()[i % 3], &hierarchies[i % 3]});
  }
};
const auto& wide_shapes() {
  static const Shapes<Recommended::Hierarchy, Recommended::Shape> shapes(
      [](const TriangleMesh& mesh) { return Recommended::hierarchy(mesh); });
  return shapes.all;
}
using Ball = Sphere<float>;
const auto& binary_shapes() {
  static const Shapes<Hierarchy<Ball>, Shape<Ball>> shapes([](const TriangleMesh& mesh) {
    return Hierarchy<Ball>(mesh, builds::BottomUpLocal::topology(mesh, 1), Fit::published);
  });
  return shapes.all;
}
template <class Strategy>
auto binary_world(int threads) {
  using Pairs = StrategyPairs<Bodies<Batch<float, 8>, Ball>, Strategy>;
  return World<Pairs>(Pairs(std::span<const Shape<Ball>>(binary_shapes()), Strategy()), threads);
}
World<> wide_world(int threads) { return World<>(wide_shapes(), threads); }
auto forgetful_world(int threads) {
  using Pairs = WidePairs<Recommended::Volume, Recommended::fan_out, NoMemory>;
  return World<Pairs>(Pairs(wide_shapes()), threads);
}

TEST(WorldThatComesAndGoes, TouchesWhereBruteForceDoes) {
  const auto& truth = hostile_truth().touching;
  EXPECT_GT(std::count(truth.begin(), truth.end(), 1), 200);
  const auto expect = [&](auto world, const char* name, int threads) {
    EXPECT_EQ(touching_of(world, hostile_scene()), truth) << name << ' ' << threads;
  };
  for (const int threads : {1, 3}) {
    expect(wide_world(threads), "recommended", threads);
    expect(forgetful_world(threads), "wide, from the roots", threads);
    expect(binary_world<Recursive>(threads), "binary, from the roots", threads);
    expect(binary_world<Margins>(threads), "binary, margins", threads);
    expect(binary_world<Adaptive>(threads), "binary, adaptive", threads);
  }
}

/// A world that begins with some bodies, and is given the others when they first have a place.
template <class World, class Shapes>
struct Growing {
  World world;
  const Shapes& shapes;

  void move(std::uint32_t i, const Pose& pose) {
    while (world.size() < i) world.add(shapes[world.size()]);
    if (i < world.size())
      world.move(i, pose);
    else
      EXPECT_EQ(world.add(shapes[i], pose), i);
  }
  void remove(std::uint32_t i) {
    if (i < world.size()) world.remove(i);
  }
  template <class... Arguments>
  void update(Arguments&&... arguments) {
    world.update(std::forward<Arguments>(arguments)...);
  }
};

template <class Pairs, class Shapes, class... Strategy>
void expect_grows(const char* name, const Shapes& shapes, const Strategy&... strategy) {
  for (const int threads : {1, 3})
    for (const std::size_t first : {std::size_t{0}, std::size_t{5}}) {
      const auto begin = std::span(shapes).first(first);
      Growing<World<Pairs>, Shapes> growing{World<Pairs>(Pairs(begin, strategy...), threads),
                                            shapes};
      EXPECT_EQ(touching_of(growing, hostile_scene()), hostile_truth().touching)
          << name << ", from " << first << ", " << threads << " threads";
      EXPECT_EQ(growing.world.size(), hostile_bodies);
    }
}

TEST(WorldThatComesAndGoes, GrowsAndShrinks) {
  expect_grows<Recommended::Pairs>("recommended", wide_shapes());
  using FromTheRoots = WidePairs<Recommended::Volume, Recommended::fan_out, NoMemory>;
  expect_grows<FromTheRoots>("wide, from the roots", wide_shapes());
  using Balls = Bodies<Batch<float, 8>, Ball>;
  expect_grows<StrategyPairs<Balls, Recursive>>("binary", binary_shapes(), Recursive());
  expect_grows<StrategyPairs<Balls, Margins>>("binary, margins", binary_shapes(), Margins());
}

/// Few bodies move at a time.
Script calm_script() {
  std::mt19937 random(20261126);
  std::uniform_real_distribution<double> unit(-1, 1);
  Script script{std::vector<std::optional<Pose>>(hostile_bodies)};
  for (auto& pose : script[0])
    pose = pose_from(1.4 * Vec3<double>(unit(random), unit(random), unit(random)), unit(random),
                     unit(random), unit(random), unit(random) + 2);
  for (std::size_t frame = 1; frame < 121; ++frame) {
    script.push_back(script.back());
    auto& pose = script.back()[random() % hostile_bodies];
    pose->translation += 0.3 * Vec3<double>(unit(random), unit(random), unit(random));
  }
  return script;
}

const std::pair<Script, std::vector<std::uint8_t>>& calm_scene() {
  static const Script script = calm_script();
  static const std::pair scene(script, truth_of(script, hostile_meshes()).touching);
  return scene;
}

/// In every other frame an exception ends the update.
template <class World>
void expect_answers_after_exceptions(World world, const char* name) {
  const auto& [script, truth] = calm_scene();
  const auto pairs = all_object_pairs(hostile_bodies);
  NotCounting counter;
  TouchingPairs touching;
  int thrown = 0;
  for (std::size_t frame = 0; frame < script.size(); ++frame) {
    follow(world, script, frame);
    const bool throws = frame % 2;
    try {
      world.update(
          counter, [](const ObjectPair&) { return Touching(); },
          [&](std::uint32_t slot, const ObjectPair& pair, const Touching& query) {
            if (throws) throw std::runtime_error("no answer is wanted");
            touching.put(slot, pair, query.touching());
          },
          [&](std::uint32_t slot) { touching.drop(slot); });
    } catch (const std::runtime_error&) {
      ++thrown;
    }
    if (throws) continue;
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      const auto found = std::count_if(
          touching.pairs().begin(), touching.pairs().end(),
          [&](const auto& each) { return each.i == pairs[p].i && each.j == pairs[p].j; });
      ASSERT_EQ(found, truth[frame * pairs.size() + p]) << name << ", frame " << frame;
    }
  }
  EXPECT_GT(thrown, 30) << name;
}

TEST(WorldThatComesAndGoes, PairsOfAFrameThatEndedByAnExceptionAreDueInTheNext) {
  for (const int threads : {1, 3}) {
    expect_answers_after_exceptions(wide_world(threads), "recommended");
    expect_answers_after_exceptions(binary_world<Recursive>(threads), "binary, from the roots");
    expect_answers_after_exceptions(binary_world<Margins>(threads), "binary, margins");
  }
}

/// All that a world finds out about a script.
struct Found {
  std::vector<std::array<std::uint32_t, 5>> contacts;
  Counting counter;
  std::size_t queried = 0;
};

/// Contacts of pairs that are not asked again are those they had.
template <class World>
Found contacts_of(World& world, const Script& script) {
  Found found;
  WorldContacts contacts;
  for (std::uint32_t frame = 0; frame < script.size(); ++frame) {
    follow(world, script, frame);
    world.update(
        found.counter,
        [&](const ObjectPair& pair, std::uint32_t slot) { return contacts.query(pair, slot); },
        [](std::uint32_t, const ObjectPair&, const Contacts&) {},
        [&](std::uint32_t slot) { contacts.drop(slot); });
    found.queried += world.queried();
    contacts.for_each([&](const ObjectPair& pair, std::span<const Contact> triangles) {
      for (const auto& [a, b] : triangles) found.contacts.push_back({frame, pair.i, pair.j, a, b});
    });
  }
  std::sort(found.contacts.begin(), found.contacts.end());
  return found;
}

template <class MakeWorld>
void expect_the_same_of_any_number_of_threads(const MakeWorld& make_world) {
  std::vector<std::array<std::uint32_t, 5>> truth;
  std::size_t at = 0;
  for (std::uint32_t frame = 0; frame < hostile_scene().size(); ++frame)
    for (const auto& [i, j] : all_object_pairs(hostile_bodies))
      for (const auto& [a, b] : hostile_truth().contacts[at++])
        truth.push_back({frame, i, j, a, b});
  std::optional<Found> alone;
  for (const int threads : {1, 2, 7}) {
    auto world = make_world(threads);
    const Found found = contacts_of(world, hostile_scene());
    EXPECT_EQ(found.contacts, truth) << threads;
    EXPECT_GT(found.counter.n_v, 0u);
    if (!alone) alone = found;
    EXPECT_EQ(found.queried, alone->queried);
    EXPECT_EQ(found.counter.n_u, alone->counter.n_u);
    EXPECT_EQ(found.counter.n_v, alone->counter.n_v);
    EXPECT_EQ(found.counter.n_p, alone->counter.n_p);
    EXPECT_EQ(found.counter.considered, alone->counter.considered);
  }
}

TEST(WorldThatComesAndGoes, ContactsAndCountsAreTheSameOfAnyNumberOfThreads) {
  expect_the_same_of_any_number_of_threads(wide_world);
  expect_the_same_of_any_number_of_threads(forgetful_world);
}

TEST(WorldThatComesAndGoes, ContactsAndCountsAreTheSameOverBinaryTrees) {
  expect_the_same_of_any_number_of_threads(binary_world<Recursive>);
  expect_the_same_of_any_number_of_threads(binary_world<Margins>);
}

/// A world says nothing of how far apart bodies are whose boxes are apart.
TEST(WorldThatComesAndGoes, DistancesAreAskedWhereBoxesOverlap) {
  auto world = wide_world(1);
  const auto asked = [&](double apart) {
    world.move(0, *pose_from({0, 0, 0}, 1, 0, 0, 0));
    world.move(1, *pose_from({apart, 0, 0}, 1, 0, 0, 0));
    int taken = 0;
    NotCounting counter;
    world.update(
        counter, [](const ObjectPair&) { return Distance(); },
        [&](std::uint32_t, const ObjectPair&, const Distance&) { ++taken; }, [](std::uint32_t) {});
    return taken;
  };
  EXPECT_EQ(asked(100), 0);
  EXPECT_EQ(asked(0.1), 1);
}

}  // namespace
}  // namespace bvlab
