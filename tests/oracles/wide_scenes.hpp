// SPDX-License-Identifier: BSD-3-Clause
/// Scenes that wide trees are tried on, and what brute force over all pairs of triangles says of
/// them: bodies anywhere, turned by matrices that are hardly rotations, and made of triangles that
/// are none.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <concepts>
#include <memory>
#include <random>

#include "experiments/scenes/formula_mesh.hpp"
#include "hierarchies/builds.hpp"
#include "tests/oracles/nearest_laws.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/wide/kernels.hpp"
#include "traversal/wide/list_memory.hpp"
#include "traversal/wide/wide_pairs.hpp"

namespace bvlab {

using PosesOfFrame = std::vector<Pose>;

struct Scene {
  const char* name;
  std::vector<TriangleMesh> meshes;
  std::vector<PosesOfFrame> frames;
};

struct Truth {
  std::vector<std::uint8_t> touching;
  std::vector<double> distances;
  std::vector<std::vector<Contact>> contacts;  // sorted
};

/// Triangles of no area, twice the same ones, and one far larger than the others.
inline TriangleMesh degenerate_mesh() {
  TriangleMesh mesh = formula_mesh("star", 24);
  const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.triangles.push_back({0, 0, 0});
  mesh.triangles.push_back({1, 2, 1});
  mesh.triangles.push_back(mesh.triangles[3]);
  mesh.vertices.push_back({3, 0.01, 0}), mesh.vertices.push_back({-3, 0, 0.02});
  mesh.triangles.push_back({n, n + 1, 2});
  return mesh;
}

inline TriangleMesh single_triangle() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}; }

inline PosesOfFrame random_frame(std::mt19937& random, std::size_t bodies, double side,
                                 double drift, const Vec3<double>& origin) {
  std::uniform_real_distribution<double> at(-side, side), unit(-1, 1);
  PosesOfFrame frame;
  for (std::size_t i = 0; i < bodies; ++i) {
    Pose pose = *pose_from(Vec3<double>(at(random), at(random), at(random)) + origin, unit(random),
                           unit(random), unit(random), unit(random) + 2);
    for (int k = 0; k < 9; ++k) pose.rotation.data()[k] += drift * unit(random);
    frame.push_back(pose);
  }
  return frame;
}

/// Turns by right angles and shifts by whole numbers: faces in common planes, edges on edges.
inline PosesOfFrame grid_frame(std::mt19937& random, std::size_t bodies) {
  std::uniform_int_distribution<int> shift(-1, 1), turn(0, 3);
  PosesOfFrame frame;
  for (std::size_t i = 0; i < bodies; ++i) {
    Pose pose;
    for (int k = turn(random); k > 0; --k)
      pose.rotation = (Mat3<double>() << 0, -1, 0, 1, 0, 0, 0, 0, 1).finished() * pose.rotation;
    pose.translation = Vec3<double>(shift(random), shift(random), shift(random));
    frame.push_back(pose);
  }
  return frame;
}

inline std::vector<Scene> scenes(int frames) {
  std::mt19937 random(20260701);
  const auto made = [&](const char* name, std::vector<TriangleMesh> meshes, double side,
                        double drift, const Vec3<double>& origin) {
    Scene scene{name, std::move(meshes), {}};
    for (int k = 0; k < frames; ++k)
      scene.frames.push_back(random_frame(random, 4, side, drift, origin));
    return scene;
  };
  const Vec3<double> here = Vec3<double>::Zero();
  std::vector<Scene> all;
  all.push_back(
      made("dense", {formula_mesh("star", 60), formula_mesh("torus", 128)}, 0.7, 0, here));
  all.push_back(made("sparse", {formula_mesh("knot", 96)}, 2, 0, here));
  all.push_back(made("degenerate", {degenerate_mesh(), single_triangle()}, 1, 0, here));
  all.push_back(made("drifting", {formula_mesh("torus", 64)}, 0.9, 1e-6, here));
  all.push_back(made("hardly a rotation", {formula_mesh("torus", 64)}, 0.9, 0.2, here));
  all.push_back(made("far", {formula_mesh("star", 60)}, 0.9, 0, {1e7, -3e6, 2e5}));
  all.push_back(made("very far", {formula_mesh("star", 60)}, 0.9, 0, {1e15, 1e14, 0}));
  Scene grid{"grid", {formula_mesh("box", 12), single_triangle()}, {}};
  for (int k = 0; k < frames; ++k) grid.frames.push_back(grid_frame(random, 4));
  all.push_back(grid);
  return all;
}

/// Frames in between those of a scene: at rest, in small steps and larger ones, all bodies or one,
/// there and back, and once all together; then the scene's own next frame, which is a jump.
inline Scene in_motion(const Scene& scene) {
  std::mt19937 random(20260702);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto moved = [&](Pose pose, double by) {
    const Pose turn = *pose_from(Vec3<double>::Zero(), by * unit(random), by * unit(random),
                                 by * unit(random), 1);
    pose.rotation = (turn.rotation * pose.rotation).eval();
    pose.translation += by * Vec3<double>(unit(random), unit(random), unit(random));
    return pose;
  };
  Scene result{scene.name, scene.meshes, {}};
  for (const PosesOfFrame& start : scene.frames) {
    PosesOfFrame frame = start;
    const auto add = [&] { result.frames.push_back(frame); };
    add(), add();
    for (const double by : {1e-9, 1e-4, 3e-3, 3e-3, 3e-2}) {
      for (auto& pose : frame) pose = moved(pose, by);
      add();
    }
    const Pose before = frame[1];
    frame[1] = moved(frame[1], 0.05), add();
    frame[1] = before, add();
    for (auto& pose : frame) pose.translation += Vec3<double>(0.3, -0.2, 0.1);
    add(), add();
  }
  return result;
}

/// Two bodies that come near each other in small steps, through each other and apart: answers
/// change in the midst of what is remembered.
inline Scene passing_by(const Scene& scene, int frames) {
  std::mt19937 random(20260703);
  std::uniform_real_distribution<double> unit(-1, 1);
  Scene result{scene.name, scene.meshes, {}};
  for (std::size_t s = 0; s < 2; ++s) {
    const PosesOfFrame& start = scene.frames[s];
    const Vec3<double> middle = start[0].translation;
    const Vec3<double> from = Vec3<double>(unit(random), unit(random), unit(random)).normalized();
    PosesOfFrame frame{start[0], start[1]};
    for (int k = 0; k < frames; ++k) {
      const double along = 2.4 * (0.5 - (k + 0.5) / frames);
      const Pose turn = *pose_from(Vec3<double>::Zero(), 0.002, 0.005 * unit(random), 0, 1);
      frame[1].rotation = (turn.rotation * frame[1].rotation).eval();
      frame[1].translation = middle + along * from + 0.3 * from.unitOrthogonal();
      result.frames.push_back(frame);
    }
  }
  return result;
}

inline Truth truth_of(const Scene& scene) {
  Truth truth;
  for (const PosesOfFrame& frame : scene.frames) {
    std::vector<std::vector<Triangle>> world;
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const TriangleMesh& mesh = scene.meshes[i % scene.meshes.size()];
      world.emplace_back();
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        world.back().push_back(mesh.corners(t));
        for (auto& corner : world.back().back()) corner = frame[i](corner);
      }
    }
    for (const auto& [i, j] : all_object_pairs(static_cast<std::uint32_t>(frame.size()))) {
      std::vector<Contact> contacts;
      double least = std::numeric_limits<double>::infinity();
      for (std::uint32_t s = 0; s < world[i].size(); ++s)
        for (std::uint32_t t = 0; t < world[j].size(); ++t) {
          if (intersect(world[i][s], world[j][t])) contacts.push_back({s, t});
          least = std::min(least, distance(world[i][s], world[j][t]).distance);
        }
      truth.touching.push_back(!contacts.empty());
      truth.distances.push_back(contacts.empty() ? least : 0);
      truth.contacts.push_back(std::move(contacts));
    }
  }
  return truth;
}

inline const std::vector<std::pair<Scene, Truth>>& scenes_with_truth() {
  static const auto all = [] {
    std::vector<std::pair<Scene, Truth>> result;
    for (auto& scene : scenes(12)) {
      const Truth truth = truth_of(scene);
      result.emplace_back(std::move(scene), truth);
    }
    return result;
  }();
  return all;
}

inline const std::vector<std::pair<Scene, Truth>>& motions_with_truth() {
  static const auto all = [] {
    std::vector<std::pair<Scene, Truth>> result;
    for (const auto& scene : scenes(4))
      for (Scene moving : {in_motion(scene), passing_by(scene, 120)}) {
        const Truth truth = truth_of(moving);
        result.emplace_back(std::move(moving), truth);
      }
    return result;
  }();
  return all;
}

template <class V, int F, class Memory = NoMemory, class Kernel = SiblingsKernel>
class PlayedWide {
 public:
  using Hierarchy = typename Kernel::template Hierarchy<V, F>;

  PlayedWide(const Scene& scene, std::uint32_t leaf_size, const Memory& memory = Memory())
      : PlayedWide(
            scene,
            [leaf_size](const TriangleMesh& mesh) {
              return Hierarchy(mesh, builds::BottomUpLocal::topology(mesh, 1), Fit::published,
                               leaf_size);
            },
            1, memory) {}
  /// Over the trees that `hierarchy(mesh)` returns.
  template <class MakeHierarchy>
    requires std::invocable<MakeHierarchy, const TriangleMesh&>
  PlayedWide(const Scene& scene, MakeHierarchy&& hierarchy, int threads = 1,
             const Memory& memory = Memory())
      : scene_(scene) {
    for (const auto& mesh : scene.meshes) hierarchies_.push_back(hierarchy(mesh));
    const auto shapes = shapes_over(scene.meshes, hierarchies_, scene.frames[0].size());
    engine_ = std::make_unique<AllPairsOf<WidePairs<V, F, Memory, Kernel>>>(
        WidePairs<V, F, Memory, Kernel>(shapes, memory),
        all_object_pairs(static_cast<std::uint32_t>(shapes.size())), threads);
  }

  auto& engine() { return *engine_; }

  void expect_touching(const Truth& truth) {
    std::vector<std::uint8_t> found(truth.touching.size(), 2);
    Counting counter;
    for (std::size_t f = 0; f < scene_.frames.size(); ++f)
      engine_->frame(
          scene_.frames[f], counter, [](std::size_t) { return Touching(); },
          [&](std::size_t p, const Touching& query) {
            found[f * engine_->pairs().size() + p] = query.touching();
          });
    EXPECT_EQ(found, truth.touching) << where();
    EXPECT_GT(counter.n_v, 0u);
  }

  void expect_contacts(const Truth& truth) {
    NotCounting counter;
    std::vector<std::vector<Contact>> found(engine_->pairs().size());
    for (std::size_t f = 0; f < scene_.frames.size(); ++f) {
      for (auto& each : found) each.clear();
      engine_->frame(
          scene_.frames[f], counter, [&](std::size_t p) { return Contacts(found[p]); },
          [](std::size_t, const Contacts&) {});
      for (std::size_t p = 0; p < found.size(); ++p) {
        std::sort(found[p].begin(), found[p].end());
        EXPECT_EQ(found[p], truth.contacts[f * found.size() + p]) << where() << ' ' << f;
      }
    }
  }

  void expect_distances(const Truth& truth) {
    NotCounting counter;
    for (std::size_t f = 0; f < scene_.frames.size(); ++f)
      engine_->frame(
          scene_.frames[f], counter, [](std::size_t) { return Distance(); },
          [&](std::size_t p, const Distance& query) {
            const double expected = truth.distances[f * engine_->pairs().size() + p];
            EXPECT_EQ(query.distance() == 0, expected == 0) << where() << ' ' << f << ' ' << p;
            EXPECT_NEAR(query.distance(), expected, 1e-13 * expected) << where() << ' ' << f;
            const auto& [i, j] = engine_->pairs()[p];
            const auto &a = mesh(i), &b = mesh(j);
            const Pose &in_a = scene_.frames[f][i], &in_b = scene_.frames[f][j];
            expect_nearest(nearest_points(query.nearest(), a, in_a, b, in_b), query.distance(), a,
                           in_a, b, in_b, where());
          });
  }

 private:
  const TriangleMesh& mesh(std::size_t i) const { return scene_.meshes[i % scene_.meshes.size()]; }

  std::string where() const {
    return std::string(scene_.name) + ' ' + std::string(V::name) + ' ' + std::to_string(F) + ' ' +
           std::string(Memory::name) + ' ' + std::string(Kernel::name);
  }

  const Scene& scene_;
  std::vector<Hierarchy> hierarchies_;
  std::unique_ptr<AllPairsOf<WidePairs<V, F, Memory, Kernel>>> engine_;
};

template <class V, int F, class Kernel, class Expect>
void for_each_scene(Expect&& expect) {
  for (const auto& [scene, truth] : scenes_with_truth())
    for (const std::uint32_t leaf_size : {1u, static_cast<std::uint32_t>(F)}) {
      PlayedWide<V, F, NoMemory, Kernel> played(scene, leaf_size);
      expect(played, truth);
    }
}

template <class V, int F, class Kernel = SiblingsKernel>
void expect_touching() {
  for_each_scene<V, F, Kernel>(
      [](auto& played, const Truth& truth) { played.expect_touching(truth); });
}

template <class V, int F, class Kernel = SiblingsKernel>
void expect_truth() {
  for_each_scene<V, F, Kernel>([](auto& played, const Truth& truth) {
    played.expect_touching(truth);
    played.expect_contacts(truth);
    played.expect_distances(truth);
  });
}

/// Lists whose entries rise.
inline ListMemory raised_lists() {
  return ListMemory(RebuildRule::by_last_rebuild(), ListMemory::Raise::tried);
}

/// One engine for all queries, one after the other, so that each begins with another's memory.
template <class V, int F, class Memory, class Kernel = SiblingsKernel>
void expect_truth_in_motion(const Memory& memory = Memory()) {
  for (const auto& [scene, truth] : motions_with_truth()) {
    PlayedWide<V, F, Memory, Kernel> played(scene, static_cast<std::uint32_t>(F), memory);
    played.expect_touching(truth);
    played.expect_contacts(truth);
    played.expect_touching(truth);
    played.expect_distances(truth);
  }
}

}  // namespace bvlab
