// SPDX-License-Identifier: BSD-3-Clause
/// The law of far vertices: it does not matter where the origin of a mesh was.
///
///   equal     where a mesh is shifted by what its coordinates can hold, and poses are the
///             identity, N_v, N_p and contacts are those near the origin, exactly, up to 10^12
///             sizes away: for every build, kernel and frame;
///   turned    where poses turn such meshes and put them where they were, contacts are those of the
///             vertices as float64 puts them, and counts grow by what this rounding explains: not
///             by a hundredth up to 10^9 sizes, by a half at 10^12;
///   clusters  bodies 10^6 sizes apart are tested in the frame `world` as in the frame `body`.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <cmath>
#include <random>
#include <string>

#include "experiments/scenes/formula_mesh.hpp"
#include "hierarchies/builds.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies.hpp"
#include "traversal/wide/kernels.hpp"
#include "traversal/wide/wide_pairs.hpp"

namespace bvlab {

namespace far_laws {

struct Scene {
  std::vector<TriangleMesh> meshes;  // one a body
  std::vector<Pose> poses;
};

struct Found {
  std::uint64_t n_v = 0, n_p = 0;
  std::vector<std::vector<Contact>> contacts;

  friend bool operator==(const Found&, const Found&) = default;
};

/// A multiple of 8, the grid of origins of meshes whose size is 2 to 4.
inline Vec3<double> shift(int exponent) {
  return std::ldexp(1.0, exponent) * Vec3<double>(1, -0.75, 0.5);
}

/// The meshes of four bodies, on a grid: two that cross, one that nearly touches, one farther off.
inline std::vector<TriangleMesh> meshes_about(const Vec3<double>& place) {
  std::vector<TriangleMesh> meshes;
  const Vec3<double> at[] = {{0, 0, 0}, {1.25, 0.5, 0.25}, {-0.125, 0.25, 0.96875}, {-1.5, 1.5, 0}};
  for (const auto& here : at) {
    meshes.push_back(formula_mesh(meshes.size() % 2 ? "star" : "torus", 300));
    for (auto& v : meshes.back().vertices) {
      for (int k = 0; k < 3; ++k) v[k] = std::nearbyint(std::ldexp(v[k], 10)) / 1024;
      v += here + place;
    }
  }
  return meshes;
}

template <class Pairs>
Found found(AllPairsOf<Pairs>&& all, const std::vector<Pose>& poses) {
  Found found;
  found.contacts.resize(all.pairs().size());
  Counting counter;
  all.frame(
      poses, counter, [&](std::size_t p) { return Contacts(found.contacts[p]); },
      [](std::size_t, const Contacts&) {});
  for (auto& contacts : found.contacts) std::sort(contacts.begin(), contacts.end());
  found.n_v = counter.n_v, found.n_p = counter.n_p;
  return found;
}

/// How trees are built.
using TopologyOf = Topology (*)(const TriangleMesh&);

template <class Tree>
auto shapes_of(const Scene& scene, TopologyOf topology, std::vector<Tree>& trees) {
  trees.reserve(scene.meshes.size());
  for (const auto& mesh : scene.meshes) trees.emplace_back(mesh, topology(mesh));
  return shapes_over(scene.meshes, trees, scene.meshes.size());
}

template <BoundingVolume V>
Found gathered(const Scene& scene, TopologyOf topology, Frame frame) {
  using AllBodies = Bodies<NativeBatch<typename V::scalar>, V>;
  std::vector<Hierarchy<V>> trees;
  const auto shapes = shapes_of(scene, topology, trees);
  return found(AllPairsOf<StrategyPairs<AllBodies, Recursive>>(
                   {AllBodies(shapes, frame), Recursive()},
                   all_object_pairs(static_cast<std::uint32_t>(scene.meshes.size()))),
               scene.poses);
}

template <BoundingVolume V, int F, class Kernel>
Found wide(const Scene& scene, TopologyOf topology) {
  using Pairs = WidePairs<V, F, NoMemory, Kernel>;
  std::vector<typename Kernel::template Hierarchy<V, F>> trees;
  const auto shapes = shapes_of(scene, topology, trees);
  const auto pairs = all_object_pairs(static_cast<std::uint32_t>(scene.meshes.size()));
  return found(AllPairsOf<Pairs>(Pairs(shapes), pairs), scene.poses);
}

/// Calls what(name, find) for each kernel and frame; find(scene) counts.
template <BoundingVolume V>
void for_each_kernel(
    TopologyOf topology,
    const std::function<void(const char*, const std::function<Found(const Scene&)>&)>& what) {
  for (const Frame frame : {Frame::world, Frame::body})
    what(frame == Frame::world ? "world" : "body",
         [&](const Scene& scene) { return gathered<V>(scene, topology, frame); });
  what("siblings",
       [&](const Scene& scene) { return wide<V, 8, SiblingsKernel>(scene, topology); });
  what("mixed", [&](const Scene& scene) { return wide<V, 4, MixedKernel>(scene, topology); });
}

template <class... Build>
std::vector<std::pair<std::string, TopologyOf>> all_builds(TypeList<Build...>) {
  return {{std::string(Build::name),
           [](const TriangleMesh& mesh) { return Build::topology(mesh, 1); }}...};
}

inline std::vector<std::vector<Contact>> contacts_by_brute_force(const Scene& scene) {
  std::vector<std::vector<Contact>> all;
  for (const auto& [i, j] : all_object_pairs(static_cast<std::uint32_t>(scene.meshes.size()))) {
    auto& contacts = all.emplace_back();
    for (std::uint32_t a = 0; a < scene.meshes[i].triangles.size(); ++a)
      for (std::uint32_t b = 0; b < scene.meshes[j].triangles.size(); ++b)
        if (intersect(scene.poses[i](scene.meshes[i].corners(a)),
                      scene.poses[j](scene.meshes[j].corners(b))))
          contacts.push_back({a, b});
  }
  return all;
}

template <BoundingVolume V>
void expect_equal() {
  const auto scene = [](const Vec3<double>& at) {
    return Scene{meshes_about(at), std::vector<Pose>(4)};
  };
  const Scene near = scene(Vec3<double>::Zero());
  const auto truth = contacts_by_brute_force(near);
  for (const auto& [build, topology] : all_builds(Builds{}))
    for_each_kernel<V>(topology, [&, &build = build](const char* kernel, const auto& find) {
      const Found usual = find(near);
      EXPECT_EQ(usual.contacts, truth);
      EXPECT_LT(usual.n_p, 30000u);  // of 540 000 pairs of triangles
      for (const int exponent : {7, 22, 30, 41}) {
        const Found far = find(scene(shift(exponent)));
        EXPECT_EQ(far.n_v, usual.n_v) << build << ' ' << kernel << ' ' << exponent;
        EXPECT_EQ(far.n_p, usual.n_p) << build << ' ' << kernel << ' ' << exponent;
        EXPECT_EQ(far.contacts, usual.contacts) << build << ' ' << kernel;
      }
    });
}

template <BoundingVolume V>
void expect_turned() {
  const auto scene = [](const Vec3<double>& at) {
    Scene scene{meshes_about(at), {}};
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
      double numbers[7];
      for (double& x : numbers) x = unit(random);
      Pose pose = *pose_from({0.25 * numbers[0], 0.25 * numbers[1], 0.25 * numbers[2]}, numbers[3],
                             numbers[4], numbers[5], numbers[6]);
      for (int k = 0; k < 3; ++k) {  // t - R at, with twice the digits
        DoubleDouble t = pose.translation[k];
        for (int j = 0; j < 3; ++j) t = t - DoubleDouble::product(pose.rotation(k, j), at[j]);
        pose.translation[k] = t.high;
      }
      scene.poses.push_back(pose);
    }
    return scene;
  };
  const Scene near = scene(Vec3<double>::Zero());
  for (const int exponent : {7, 22, 30, 41}) {
    const Scene far = scene(shift(exponent));
    const auto truth = contacts_by_brute_force(far);
    const TopologyOf topology = [](const TriangleMesh& mesh) {
      return builds::TopDownMean::topology(mesh, 1);
    };
    for_each_kernel<V>(topology, [&](const char* kernel, const auto& find) {
      const Found usual = find(near), now = find(far);
      EXPECT_EQ(now.contacts, truth) << kernel << ' ' << exponent;
      const double growth = exponent <= 30 ? 1.01 : 1.5;
      for (const auto& [far_count, count] :
           {std::pair(now.n_v, usual.n_v), std::pair(now.n_p, usual.n_p)}) {
        const auto of_far = static_cast<double>(far_count), of_near = static_cast<double>(count);
        EXPECT_LE(of_far, growth * of_near + 8) << kernel << ' ' << exponent;
        EXPECT_GE(of_far, of_near / growth - 8) << kernel << ' ' << exponent;
      }
    });
  }
}

template <BoundingVolume V>
void expect_clusters() {
  // Two bodies a hundredth apart in each cluster, at first near each other, then far and back.
  const TriangleMesh mesh = formula_mesh("icosphere", 1280);
  const Hierarchy<V> tree(mesh, builds::TopDownMean::topology(mesh, 1));
  const std::vector<Shape<V>> shapes(4, {&mesh, &tree});
  using AllBodies = Bodies<NativeBatch<typename V::scalar>, V>;
  const auto play = [&](Frame frame, double apart, auto& counter) {
    AllBodies bodies(shapes, frame);
    Workspace workspace;
    std::vector<bool> touching;
    for (const double now : {4.0, apart, 4.0, apart}) {
      std::vector<Pose> poses(4);
      const double width = 2.015625;
      for (int i = 0; i < 4; ++i)
        poses[static_cast<std::size_t>(i)].translation =
            Vec3<double>(i % 2 * width, i / 2 * now, i / 2 * now);
      bodies.move(poses, centre_of(poses, bodies));
      for (const auto& pair : all_object_pairs(4)) {
        Touching query;
        Recursive().run(bodies.pair(pair, query, counter));
        touching.push_back(query.touching());
      }
    }
    return touching;
  };
  Counting far_world, far_body, near_world;
  const std::vector<bool> none(24);
  EXPECT_EQ(play(Frame::world, 4, near_world), none);
  EXPECT_EQ(play(Frame::world, 0x1p21, far_world), none);
  EXPECT_EQ(play(Frame::body, 0x1p21, far_body), none);
  EXPECT_EQ(far_world.n_p, far_body.n_p);
  EXPECT_EQ(far_world.n_p, near_world.n_p);
  EXPECT_LE(far_world.n_v, near_world.n_v);
  EXPECT_LE(far_world.n_u, near_world.n_u + far_world.n_v);
}

}  // namespace far_laws

}  // namespace bvlab
