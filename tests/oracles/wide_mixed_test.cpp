// SPDX-License-Identifier: BSD-3-Clause
/// The kernel `mixed` answers as brute force does, under every query, from the roots and with what
/// it remembers; so do oriented boxes among siblings, and their laws hold.
#include "hierarchies/wide/obb_sibling_test.hpp"
#include "tests/laws/frame_laws.hpp"
#include "tests/oracles/wide_scenes.hpp"

namespace bvlab {
namespace {

using Box = Obb<float>;

TEST(WideMixed, EveryQueryIsBruteForce) { expect_truth<Box, 4, MixedKernel>(); }

TEST(WideMixed, RememberingIsBruteForce) {
  expect_truth_in_motion<Box, 4, WideMargins, MixedKernel>();
  expect_truth_in_motion<Box, 4, NoMemory, MixedKernel>(NoMemory(NoMemory::Witness::kept));
  expect_truth_in_motion<Box, 4, ListMemory, MixedKernel>();
  expect_truth_in_motion<Box, 4, ListMemory, MixedKernel>(raised_lists());
}

TEST(WideMixed, SiblingsOfBoxesAreBruteForce) {
  expect_truth<Box, 16>();
  expect_truth_in_motion<Box, 8, WideMargins>();
}

TEST(WideMixed, LawsHold) {
  expect_frame_laws<Box, 16>();
  expect_frame_laws<Box, 4>();
}

/// No gap of triangles is more than their distance, wherever in their bounds corners are; of
/// triangles that are as far from each other as they are long most have one.
TEST(WideMixed, TriangleGapsAreBounds) {
  using S = SixteenLanes;
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::size_t far = 0, told = 0;
  for (int round = 0; round < 4000; ++round) {
    const double scale = std::exp2(std::array{0, -30, 30, 60, -80, 31}[round % 6]);
    const double thin = round % 3 ? 1 : std::exp2(-24 * (1 + unit(random)));
    // At 2^70, where products of a normal with a difference overflow.
    const double away = std::exp2(round % 12 == 5 ? 39 : 4 * unit(random) - 2);
    const float off = static_cast<float>(scale * std::exp2(-24 + 8 * unit(random)));
    std::array<std::array<Triangle, S::size()>, 2> truth;
    std::array<Corners<S>, 2> corners;
    for (std::size_t lane = 0; lane < S::size(); ++lane) {
      const Vec3<double> shift = away * Vec3<double>(unit(random), unit(random), unit(random));
      for (std::size_t side = 0; side < 2; ++side)
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t k = 0; k < 3; ++k) {
            const double x =
                (k == 2 ? thin : 1) * unit(random) + (side ? shift[static_cast<int>(k)] : 0.0);
            corners[side][i][k][lane] = static_cast<float>(scale * x);
            truth[side][lane][i][static_cast<int>(k)] =
                double(float(corners[side][i][k][lane])) + double(off) * unit(random);
          }
    }
    const S gap = triangle_gap<S>(corners[0], corners[1], S(off));
    for (std::size_t lane = 0; lane < S::size(); ++lane) {
      const auto &a = truth[0][lane], &b = truth[1][lane];
      const double distance = intersect(a, b) ? 0 : bvlab::distance(a, b).distance;
      EXPECT_LE(double(float(gap[lane])), distance * (1 + 1e-12)) << round;
      EXPECT_GE(float(gap[lane]), 0);
      far += scale > 1e-8 && distance > scale,
          told += scale > 1e-8 && distance > scale && gap[lane] > 0;
    }
  }
  EXPECT_GT(far, 1000u);
  EXPECT_GT(2 * told, far);
}

/// Every row is the children of its node, and every lane that is used holds a grandchild.
TEST(WideMixed, BlocksHoldGrandchildren) {
  for (const auto& scene : scenes(1))
    for (const auto& mesh : scene.meshes)
      for (const std::uint32_t leaf_size : {1u, 3u, 4u}) {
        const BlockHierarchy<Box> tree(mesh, builds::BottomUpLocal::topology(mesh, 1),
                                       Fit::published, leaf_size);
        std::vector<std::uint32_t> reached(tree.size(), 0);
        std::vector<std::uint32_t> triangles;
        std::vector<std::uint32_t> open{0};
        while (!open.empty()) {
          const auto& node = tree.node(open.back());
          ++reached[open.back()], open.pop_back();
          if (node.leaf) {
            for (int k = 0; k < std::popcount(node.children); ++k)
              triangles.push_back(tree.triangle(node.first + static_cast<std::uint32_t>(k)));
            continue;
          }
          const auto& row = tree.row(node.first).name;
          const auto& block = tree.block(node.first).name;
          std::uint64_t grandchildren = 0;
          for (std::size_t k = 0; k < 4; ++k)
            if (node.children >> k & 1) {
              const auto number = BlockHierarchy<Box>::number_of(row[k]);
              const auto& child = tree.node(number);
              EXPECT_EQ(row[k] != number, child.leaf != 0);
              open.push_back(number);
              for (std::size_t j = 0; j < 4; ++j) {
                EXPECT_EQ(block[4 * k + j], child.leaf ? row[k] : tree.row(child.first).name[j]);
                const unsigned held = child.leaf ? 1u : child.children;
                grandchildren |= std::uint64_t{held >> j & 1u} << (4 * k + j);
              }
            }
          EXPECT_EQ(grandchildren, node.grandchildren);
        }
        for (const auto times : reached) EXPECT_EQ(times, 1u);
        std::sort(triangles.begin(), triangles.end());
        ASSERT_EQ(triangles.size(), mesh.triangles.size());
        for (std::uint32_t t = 0; t < triangles.size(); ++t) EXPECT_EQ(triangles[t], t);
      }
}

}  // namespace
}  // namespace bvlab
