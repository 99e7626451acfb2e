// SPDX-License-Identifier: BSD-3-Clause
/// Wide trees of boxes with slabs answer as brute force does: every query, fan-out and frame of
/// comparison.
#include "hierarchies/wide/slab_box_facing.hpp"
#include "tests/laws/frame_laws.hpp"
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

TEST(Wide, LawsHoldInBothFrames) {
  expect_frame_laws<SlabBox<float>, 8, RelativeFrame>();
  expect_frame_laws<SlabBox<float>, 4, RelativeFrame>();
  expect_frame_laws<SlabBox<float>, 8, WorldFrame>();
}

TEST(Wide, RememberingIsBruteForce) {
  expect_truth_in_motion<SlabBox<float>, 16, RelativeFrame, WideMargins>();
  expect_truth_in_motion<SlabBox<float>, 8, WorldFrame, WideMargins>();
  expect_truth_in_motion<SlabBox<float>, 8, RelativeFrame, Forgetful>();
}

/// What rests, moves along together or is far from the rest is not tested again.
TEST(Wide, RestIsNotTested) {
  for (const auto& [scene, truth] : scenes_with_truth()) {
    std::vector<WideHierarchy<SlabBox<float>, 8>> hierarchies;
    for (const auto& mesh : scene.meshes)
      hierarchies.emplace_back(mesh, builds::BottomUpLocal::topology(mesh, 1));
    std::vector<WideShape<SlabBox<float>, 8>> shapes;
    for (std::size_t i = 0; i < scene.frames[0].size(); ++i) {
      const std::size_t k = i % scene.meshes.size();
      shapes.push_back({&scene.meshes[k], &hierarchies[k]});
    }
    WidePairs<SlabBox<float>, 8, RelativeFrame, WideMargins> engine(
        shapes, all_object_pairs(static_cast<std::uint32_t>(shapes.size())));
    std::vector<std::uint8_t> found(engine.pairs().size());
    for (std::size_t f = 0; f < scene.frames.size(); ++f) {
      std::uint64_t tested = 0;
      for (int again = 0; again < 3; ++again) {
        Counting counter;
        engine.frame(
            scene.frames[f], counter, [](std::size_t) { return Touching(); },
            [&](std::size_t p, const Touching& query) { found[p] = query.touching(); });
        for (std::size_t p = 0; p < found.size(); ++p)
          EXPECT_EQ(found[p], truth.touching[f * found.size() + p]) << scene.name;
        if (again == 0) tested = counter.n_v;
        EXPECT_EQ(counter.n_v, again == 0 ? tested : 0) << scene.name;
      }
      EXPECT_GT(tested, 0u) << scene.name;
    }
  }
}

}  // namespace
}  // namespace bvlab
