// SPDX-License-Identifier: BSD-3-Clause
/// A yes-or-no query with a limit, "are the surfaces within d of each other?", under strategies that
/// keep an answer: a "no" lasts until a gap comes down to the limit, not to 0.
#include <gtest/gtest.h>

#include "hierarchies/builds.hpp"
#include "hierarchies/volumes/sphere.hpp"
#include "tests/example/within.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/strategies/adaptive.hpp"
#include "traversal/strategies/margins.hpp"
#include "traversal/strategies/recursive.hpp"

namespace bvlab {
namespace {

template <class Strategy>
std::vector<bool> answers() {
  using V = Sphere<float>;
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                          {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  const Hierarchy<V> hierarchy(mesh, builds::BottomUpLocal::topology(mesh, 1));
  AllPairs<Batch<float, 8>, V, Strategy> pairs(std::vector<Shape<V>>(2, {&mesh, &hierarchy}),
                                               all_object_pairs(2), Strategy());
  NotCounting counter;
  std::vector<bool> found;
  for (int frame = 0; frame < 200; ++frame) {  // there and back
    const double x = 12 - 0.1 * (frame < 100 ? frame : 200 - frame);
    const std::vector<Pose> poses{Pose(), *pose_from({x, 0.1, 0.1}, 1, 0, 0, 0)};
    pairs.frame(
        poses, counter, [](std::size_t) { return Within(4.0); },
        [&](std::size_t, const Within& query) { found.push_back(query.answer()); });
  }
  return found;
}

TEST(ClearanceQuery, StrategiesThatKeepAnswersAgreeWithRecursion) {
  const auto right = answers<Recursive>();
  EXPECT_FALSE(right.front());
  EXPECT_TRUE(right[100]);
  EXPECT_EQ(answers<Margins>(), right);
  EXPECT_EQ(answers<Adaptive>(), right);
}

}  // namespace
}  // namespace bvlab
