// SPDX-License-Identifier: BSD-3-Clause
/// Trees built by several threads are those of one, bit for bit.
#include "hierarchies/builds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <span>

#include "experiments/scenes/formula_mesh.hpp"
#include "hierarchies/hierarchy.hpp"
#include "hierarchies/volumes/obb.hpp"
#include "hierarchies/volumes/sphere.hpp"
#include "traversal/recommended.hpp"

namespace bvlab {
namespace {

std::vector<TriangleMesh> meshes() {
  std::vector<TriangleMesh> all{formula_mesh("torus", 6000), formula_mesh("icosphere", 5120),
                                formula_mesh("star", 1100), formula_mesh("box", 12)};
  // Many triangles in one place, which no plane divides.
  TriangleMesh heap = formula_mesh("box", 12);
  for (int k = 0; k < 8; ++k)
    heap.triangles.insert(heap.triangles.end(), heap.triangles.begin(), heap.triangles.end());
  all.push_back(heap);
  return all;
}

void expect_same(const Topology& one, const Topology& more) {
  EXPECT_TRUE(std::ranges::equal(one.nodes, more.nodes, [](const auto& a, const auto& b) {
    return a.first == b.first && a.count == b.count;
  }));
  EXPECT_EQ(one.primitives, more.primitives);
}

TEST(Builds, ThreadsChangeNoTopology) {
  for (const auto& mesh : meshes())
    for (const SplitAxis axis : {SplitAxis::longest, SplitAxis::principal})
      for (const SplitAt at :
           {SplitAt::median, SplitAt::mean, SplitAt::middle, SplitAt::surface_area})
        for (const std::uint32_t leaf_size : {1u, 3u, 400u}) {
          const TopDown build{axis, at, leaf_size};
          const Topology one = build(mesh);
          for (const int count : {2, 3, 7}) {
            Threads threads(count);
            expect_same(one, build(mesh, threads));
          }
        }
}

TEST(Builds, ThreadsChangeNoTopologyFromBelow) {
  for (const auto& mesh : meshes())
    for (const std::uint32_t radius : {4u, 16u}) {
      const BottomUp build{3, radius};
      const Topology one = build(mesh);
      for (const int count : {2, 3, 7}) {
        Threads threads(count);
        expect_same(one, build(mesh, threads));
      }
    }
}

/// Bits, so that not even a zero changes its sign.
template <class T>
bool same_bits(const T& a, const T& b) {
  return std::ranges::equal(std::as_bytes(std::span(&a, 1)), std::as_bytes(std::span(&b, 1)));
}

template <class V>
void expect_threads_change_no_volume(const TriangleMesh& mesh, Fit fit) {
  const Topology topology = builds::TopDownPrincipal::topology(mesh, 1);
  const Hierarchy<V> one(mesh, topology, fit);
  for (const int count : {2, 3, 7}) {
    Threads threads(count);
    const Hierarchy<V> more(mesh, topology, fit, threads);
    ASSERT_EQ(one.size(), more.size());
    for (std::uint32_t i = 0; i < one.size(); ++i) {
      EXPECT_TRUE(same_bits(one.volume(i), more.volume(i))) << V::name << ' ' << i;
      EXPECT_EQ(one.node(i).size, more.node(i).size);
      EXPECT_EQ(one.least_above(i), more.least_above(i));
    }
    EXPECT_EQ(one.extent().reach, more.extent().reach);
  }
}

TEST(Builds, ThreadsChangeNoVolume) {
  for (const char* shape : {"torus", "star"}) {
    const auto mesh = formula_mesh(shape, 1100);
    expect_threads_change_no_volume<Sphere<float>>(mesh, Fit::published);
    expect_threads_change_no_volume<Obb<float>>(mesh, Fit::published);
    expect_threads_change_no_volume<Obb<float>>(mesh, Fit::tight);
  }
}

TEST(Builds, ThreadsChangeNoWideHierarchy) {
  for (const auto& mesh : meshes()) {
    const auto one = Recommended::hierarchy(mesh);
    for (const int threads : {2, 3, 7}) {
      const auto more = Recommended::hierarchy(mesh, threads);
      ASSERT_EQ(one.size(), more.size());
      EXPECT_EQ(one.reach(), more.reach());
      for (std::uint32_t i = 0; i < one.size(); ++i) {
        const auto &a = one.node(i), &b = more.node(i);
        EXPECT_TRUE(a.first == b.first && a.lanes == b.lanes && a.leaf == b.leaf &&
                    a.size == b.size && same_bits(a.volume, b.volume));
        EXPECT_TRUE(same_bits(one.children(i), more.children(i)));
        if (!a.leaf) continue;
        EXPECT_TRUE(same_bits(one.corners(a.first), more.corners(a.first)));
        for (std::uint32_t k = 0; k < Recommended::fan_out; ++k)
          EXPECT_EQ(one.triangle(a.first + k), more.triangle(a.first + k));
        EXPECT_EQ(one.leaf_of(a.first), more.leaf_of(a.first));
      }
      const auto &a = one.supports().table(), &b = more.supports().table();
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t k = 0; k < a.size(); ++k) EXPECT_TRUE(same_bits(a[k], b[k]));
    }
  }
}

}  // namespace
}  // namespace bvlab
