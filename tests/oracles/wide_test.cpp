// SPDX-License-Identifier: BSD-3-Clause
/// Wide trees of boxes with slabs answer as brute force does: every query, fan-out and frame of
/// comparison.
#include "hierarchies/wide/slab_box_facing.hpp"
#include "tests/oracles/wide_scenes.hpp"

namespace bvlab {
namespace {

TEST(Wide, ScenesAreNeitherAllTouchingNorAllApart) {
  for (const auto& [scene, truth] : scenes_with_truth()) {
    const auto hits = std::count(truth.touching.begin(), truth.touching.end(), 1);
    EXPECT_GT(hits, 0) << scene.name;
    EXPECT_LT(hits, static_cast<std::ptrdiff_t>(truth.touching.size())) << scene.name;
  }
}

TEST(Wide, EveryQueryIsBruteForce) {
  expect_truth<SlabBox<float>, 16, RelativeFrame>();
  expect_truth<SlabBox<float>, 8, WorldFrame>();
}

TEST(Wide, EveryFanOutIsBruteForce) {
  expect_touching<SlabBox<float>, 2, RelativeFrame>();
  expect_touching<SlabBox<float>, 4, RelativeFrame>();
  expect_touching<SlabBox<float>, 8, RelativeFrame>();
}

}  // namespace
}  // namespace bvlab
