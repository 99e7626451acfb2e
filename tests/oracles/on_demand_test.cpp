// SPDX-License-Identifier: BSD-3-Clause
/// Trees that are made on demand: their answers are those of brute force, on any number of threads;
/// a finished one is the one that is built at once, node by node; what is not opened is not made;
/// and a failed allocation leaves nothing half made.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <thread>

#include "hierarchies/wide/slab_box_sibling_test.hpp"
#include "tests/oracles/wide_scenes.hpp"
#include "tests/replaced_new.hpp"

namespace bvlab {
namespace {

using V = SlabBox<float>;
using Tree = WideHierarchy<V, 8>;

Tree on_demand(const TriangleMesh& mesh, std::uint32_t leaf_size = 8) {
  return Tree::on_demand(mesh, leaf_size);
}
/// Level by level, so that nodes have the numbers that they have in `at_once`.
void finish(const Tree& tree) {
  for (std::uint32_t i = 0; i < tree.known(); ++i) tree.require(i);
}
/// The topology of such a tree, from the same splits without a tree.
WideTopology at_once(const TriangleMesh& mesh, std::uint32_t leaf_size) {
  RangeSplits splits(mesh);
  RangeSplits::Parts parts;
  WideTopology topology;
  topology.nodes.push_back({0, 0, false, 0, splits.all().size()});
  for (std::size_t i = 0; i < topology.nodes.size(); ++i) {
    const auto [first, count, leaf, begin, end] = topology.nodes[i];
    if (end - begin <= leaf_size) {
      topology.nodes[i] = {begin, end - begin, true, begin, end};
      continue;
    }
    const std::uint32_t children = splits.split({begin, end}, 8, leaf_size, parts);
    topology.nodes[i] = {static_cast<std::uint32_t>(topology.nodes.size()), children, false, begin,
                         end};
    for (std::uint32_t k = 0; k < children; ++k)
      topology.nodes.push_back({0, 0, false, parts[k].range.begin, parts[k].range.end});
  }
  for (std::uint32_t k = 0; k < splits.all().size(); ++k)
    topology.primitives.push_back(splits.triangle(k));
  return topology;
}

template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}
/// Floats that differ by rounding alone: where triangles stand in another order, sums of their
/// normals are rounded otherwise.
template <class T>
bool alike(const T& a, const T& b) {
  std::array<float, sizeof(T) / sizeof(float)> x, y;
  std::memcpy(&x, &a, sizeof x), std::memcpy(&y, &b, sizeof y);
  return std::ranges::equal(x, y, [](float p, float q) {
    return p == q || std::abs(p - q) <= 1e-5f * (1 + std::abs(p));
  });
}
/// What is in node i of a and j of b, the volumes of its children, and its triangles.
void expect_same(const Tree& a, std::uint32_t i, const Tree& b, std::uint32_t j) {
  const auto &x = a.node(i), &y = b.node(j);
  ASSERT_TRUE(x.lanes == y.lanes && x.leaf == y.leaf) << i;
  EXPECT_TRUE(alike(a.children(i), b.children(j))) << i;
  for (std::uint32_t k = 0; !x.leaf && x.lanes >> k & 1; ++k)
    EXPECT_TRUE(alike(a.node(x.first + k).volume, b.node(y.first + k).volume) &&
                alike(a.node(x.first + k).size, b.node(y.first + k).size) &&
                alike(a.node_sphere(x.first + k), b.node_sphere(y.first + k)))
        << x.first + k;
  if (!x.leaf) return;
  EXPECT_TRUE(same_bits(a.corners(x.first), b.corners(y.first))) << i;
  EXPECT_EQ(a.leaf_of(x.first), i);
  for (std::uint32_t k = 0; k < 8; ++k)
    EXPECT_EQ(a.triangle(x.first + k), b.triangle(y.first + k)) << i;
}
/// The same for all below: numbers of nodes depend on the order in which they were made.
void expect_same_below(const Tree& a, std::uint32_t i, const Tree& b, std::uint32_t j) {
  expect_same(a, i, b, j);
  const auto &x = a.node(i), &y = b.node(j);
  for (std::uint32_t k = 0; !x.leaf && x.lanes >> k & 1; ++k)
    expect_same_below(a, x.first + k, b, y.first + k);
}

template <class Memory>
void expect_truth(const std::vector<std::pair<Scene, Truth>>& all) {
  for (const auto& [scene, truth] : all)
    for (const int threads : {1, 4}) {
      const auto played = [&, &scene = scene] {
        return PlayedWide<V, 8, Memory>(
            scene, [&](const TriangleMesh& mesh) { return on_demand(mesh, threads == 1 ? 8 : 3); },
            threads);
      };
      played().expect_touching(truth);
      played().expect_contacts(truth);
      played().expect_distances(truth);
    }
}
TEST(OnDemand, AnswersAreThoseOfBruteForce) { expect_truth<NoMemory>(scenes_with_truth()); }
TEST(OnDemand, AnswersInMotionAreThoseOfBruteForce) {
  expect_truth<WideMargins>(motions_with_truth());
}

std::vector<TriangleMesh> meshes() {
  std::vector<TriangleMesh> all{single_triangle(), degenerate_mesh(), formula_mesh("box", 12),
                                formula_mesh("knot", 9000)};
  // All near each other but one, and all in one place.
  all.push_back(formula_mesh("torus", 2000));
  all.back().vertices.push_back({1e12, 0, 0});
  all.back().triangles.push_back(
      {0, 1, static_cast<std::uint32_t>(all.back().vertices.size() - 1)});
  all.push_back({{{1, 2, 3}}, std::vector<std::array<std::uint32_t, 3>>(100)});
  return all;
}

/// A node whose parent has many triangles is bounded by its box alone, and is larger.
TEST(OnDemand, FinishedTreesAreThoseBuiltAtOnce) {
  for (const auto& mesh : meshes())
    for (const std::uint32_t leaf_size : {1u, 8u}) {
      SCOPED_TRACE(std::to_string(mesh.triangles.size()) + " triangles, leaves of " +
                   std::to_string(leaf_size));
      const LocalMesh local(mesh);
      const WideTopology topology = at_once(local.mesh(), leaf_size);
      const Tree whole(mesh, topology, Fit::published), tree = on_demand(mesh, leaf_size);
      EXPECT_EQ(tree.made(), 0u);
      finish(tree);
      ASSERT_EQ(tree.known(), whole.size());
      EXPECT_LE(tree.known(), tree.size());
      EXPECT_EQ(tree.made(), whole.made());
      EXPECT_GE(tree.reach(), whole.reach() * (1 - 1e-6));
      for (std::uint32_t i = 0; i < tree.known(); ++i) {
        const WideTopology::Node& node = topology.nodes[i];
        EXPECT_LE(reach_of(tree.node(i).volume), tree.reach());
        if (node.end - node.begin <= TriangleColumns::large) {
          EXPECT_EQ(tree.node(i).first, whole.node(i).first);
          expect_same(tree, i, whole, i);
          continue;
        }
        for (std::uint32_t k = node.begin; k < node.end; ++k)
          for (const Vec3<double>& p : local.mesh().corners(topology.primitives[k])) {
            EXPECT_TRUE(contains(tree.node(i).volume, p.cast<long double>()));
            const NodeSphere& s = tree.node_sphere(i);
            EXPECT_LE((p - Vec3<double>(s.centre[0], s.centre[1], s.centre[2])).norm(), s.radius);
          }
      }
    }
}

TEST(OnDemand, ThreadsMakeEachNodeOnce) {
  const TriangleMesh mesh = formula_mesh("knot", 9000);
  const Tree alone = on_demand(mesh), shared = on_demand(mesh);
  finish(alone);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (std::vector<std::uint32_t> open{0}; !open.empty();) {
        const std::uint32_t i = open.back();
        open.pop_back();
        shared.require(i);
        const auto& node = shared.node(i);
        for (std::uint32_t k = 0; !node.leaf && node.lanes >> k & 1; ++k)
          open.push_back(node.first + k);
      }
    });
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(shared.known(), alone.known());
  expect_same_below(shared, 0, alone, 0);
}

struct Corner {
  TriangleMesh mesh = formula_mesh("torus", 20000);
  Tree tree = on_demand(mesh);

  /// Both bodies have one tree; returns the counts of some frames.
  Counting played(double apart) const {
    const std::vector<WideShape<V, 8>> shapes(2, {&mesh, &tree});
    AllPairsOf engine(WidePairs<V, 8, WideMargins>(shapes), all_object_pairs(2));
    Counting counter;
    for (int f = 0; f < 20; ++f) {
      PosesOfFrame frame(2);
      frame[1].translation = Vec3<double>(apart + 0.001 * f, 0.01, 0.02);
      engine.frame(
          frame, counter, [](std::size_t) { return Touching(); }, [](auto&&...) {});
    }
    return counter;
  }
};

TEST(OnDemand, OnlyWhatIsOpenedIsMade) {
  Corner corner;
  double widest = 0;
  for (const auto& vertex : corner.mesh.vertices) widest = std::max(widest, vertex[0]);
  EXPECT_EQ(corner.played(4 * widest).n_v, 0u);
  EXPECT_EQ(corner.tree.made(), 0u) << "nobody came near";
  const Counting counts = corner.played(1.98 * widest);
  EXPECT_GT(counts.n_p, 0u);
  EXPECT_GT(corner.tree.made(), 0u);
  const std::size_t made = corner.tree.made();
  // What was made before makes no difference.
  finish(corner.tree);
  EXPECT_LT(10 * made, corner.tree.made());
  const Counting again = corner.played(1.98 * widest);
  EXPECT_EQ(again.n_v, counts.n_v);
  EXPECT_EQ(again.n_p, counts.n_p);
}

int successes = -1;  // allocations before one that fails; negative: none fails
[[maybe_unused]] const auto hook = before_allocation = [] {
  if (successes >= 0 && successes-- == 0) throw std::bad_alloc();
};

TEST(OnDemand, FailedAllocationsLeaveNothingHalfMade) {
  const TriangleMesh mesh = formula_mesh("knot", 3000);
  const Tree tree = on_demand(mesh), other = on_demand(mesh);
  finish(other);
  int failures = 0;
  for (std::uint32_t i = 0; i < tree.known(); ++i)
    for (int k = 0;; ++k) {
      const std::size_t made = i < 3 ? tree.made() : 0;
      successes = k;
      try {
        tree.require(i);
        successes = -1;
        break;
      } catch (const std::bad_alloc&) {
        successes = -1, ++failures;
        if (i < 3) {
          EXPECT_EQ(tree.made(), made);
        }
      }
    }
  EXPECT_GT(failures, static_cast<int>(tree.known()) / 2);
  expect_same_below(tree, 0, other, 0);
}

}  // namespace
}  // namespace bvlab
