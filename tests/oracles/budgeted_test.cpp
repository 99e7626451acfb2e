// SPDX-License-Identifier: BSD-3-Clause
/// Answers within a budget: never wrong, never above the budget, never a bound below the patches
/// that do touch; and with enough of a budget everything is known.
#include <gtest/gtest.h>

#include "experiments/replay/registry.hpp"
#include "experiments/replay/replay_budgeted.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "experiments/scenes/random_walk.hpp"

namespace bvlab {
namespace {

class Budget : public testing::Test {
 protected:
  Budget() {
    std::vector<Extent> extents;
    for (const char* name : {"star", "torus"}) {
      meshes_.push_back(formula_mesh(name, 200));
      extents.push_back(extent_of(meshes_.back()));
    }
    RandomWalk walk;
    walk.objects = 4, walk.frames = 60;
    walk.side = {2.5, Length::Unit::body}, walk.step = {0.3, Length::Unit::body};
    auto array = walk.generate(extents, {});
    trace_ = {array.shape[0], array.shape[1], std::move(array.data)};
    truth_ = replay(meshes_, trace_, Variant{}, {}).touching;
  }

  BudgetedResult within(std::string_view volume, std::uint64_t budget, std::uint32_t fan_out = 2,
                        Frame frame = Frame::world) const {
    Variant variant;
    variant.volume = volume, variant.fan_out = fan_out, variant.frame = name_of(frame);
    return replay_budgeted(meshes_, trace_, variant, budget, Count::on);
  }

  std::vector<TriangleMesh> meshes_;
  Trace trace_;
  std::vector<std::uint8_t> truth_;
};

TEST_F(Budget, NeverWrongAndNeverExceeded) {
  const std::size_t asked = truth_.size();
  for (const auto& [volume, description] : volumes()) {
    double before = std::numeric_limits<double>::infinity();
    std::uint64_t unknown_before = asked + 1;
    for (const std::uint64_t budget : {0, 1, 7, 50, 400, 3000, 1 << 20}) {
      const auto result = within(volume, budget);
      ASSERT_EQ(result.known.size(), asked);
      ASSERT_LE(result.n_v, budget * asked) << volume;
      ASSERT_EQ(result.touching + result.apart + result.unknown, asked);
      for (std::size_t i = 0; i < asked; ++i) {
        if (result.known[i] != 2) {
          ASSERT_EQ(result.known[i], truth_[i]) << volume << " at " << budget;
          ASSERT_EQ(result.bounds[i], 0);
        } else {
          ASSERT_GT(result.bounds[i], 0);
        }
      }
      // More tests tell more.
      EXPECT_LE(result.deepest, before) << volume << " at " << budget;
      EXPECT_LE(result.unknown, unknown_before) << volume << " at " << budget;
      before = result.deepest, unknown_before = result.unknown;
    }
    EXPECT_EQ(unknown_before, 0u) << volume;
  }
}

/// On every fan-out and in both frames no answer is wrong, and with enough tests none is missing.
TEST_F(Budget, FanOutsAndFramesAnswerTheSame) {
  for (const std::uint32_t fan_out : {2, 4, 8, 16})
    for (const Frame frame : {Frame::world, Frame::body})
      for (const auto& [volume, description] : volumes()) {
        for (const std::uint64_t budget : {13, 200}) {
          const auto some = within(volume, budget, fan_out, frame);
          EXPECT_LE(some.n_v, budget * truth_.size());
          for (std::size_t i = 0; i < truth_.size(); ++i)
            if (some.known[i] != 2) {
              ASSERT_EQ(some.known[i], truth_[i]) << volume << ' ' << fan_out;
            }
        }
        const auto whole = within(volume, 1 << 20, fan_out, frame);
        EXPECT_EQ(whole.known, truth_) << volume << ' ' << fan_out << ' ' << name_of(frame);
      }
}

/// Where surfaces do touch and it is not known yet, at least one of the two patches that meet is no
/// larger than the bound says.
TEST_F(Budget, TheBoundHoldsForWhatTouches) {
  Variant variant;
  variant.query = "contacts";
  const auto contacts = replay(meshes_, trace_, variant, {}).contacts;
  const auto size_of_triangle = [&](std::uint32_t object, std::uint32_t triangle) {
    const Triangle t = meshes_[object % 2].corners(triangle);
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, (t[k] - t[(k + 1) % 3]).norm());
    return longest;
  };
  std::size_t seen = 0;
  for (const std::uint64_t budget : {1, 7, 50, 400}) {
    const auto result = within("obb", budget);
    for (const auto& [frame, i, j, s, t] : contacts) {
      const std::size_t pair = i * 4 - i * (i + 1) / 2 + (j - i - 1);
      const std::size_t cell = frame * trace_.pairs() + pair;
      ASSERT_TRUE(truth_[cell]);
      if (result.known[cell] != 2) continue;
      ASSERT_LE(std::min(size_of_triangle(i, s), size_of_triangle(j, t)), result.bounds[cell]);
      ++seen;
    }
  }
  EXPECT_GT(seen, 100u);
}

}  // namespace
}  // namespace bvlab
