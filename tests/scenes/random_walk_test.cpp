// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/random_walk.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <set>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "experiments/scenes/random.hpp"

namespace bvlab {
namespace {

// Neither centre is at the origin, so that turning about the wrong point shows.
const Extent meshes[] = {{{1, 2, 3}, 1, 0.1}, {{-4, 0.5, 0}, 1.25, 0.125}};
constexpr double pi = 3.141592653589793;

struct BodyState {
  Vec3<double> centre;
  Eigen::Quaterniond attitude;
};

BodyState state_of(const Array<double>& trace, std::size_t frame, std::size_t object) {
  const double* row = trace.data.data() + (frame * trace.shape[1] + object) * 7;
  const Eigen::Quaterniond q(row[3], row[4], row[5], row[6]);
  return {q * meshes[object % 2].centre + Vec3<double>(row[0], row[1], row[2]), q};
}

RandomWalk small_walk() {
  RandomWalk walk;
  walk.objects = 5;
  walk.frames = 2000;
  walk.side = {10, Length::Unit::mesh};
  walk.step = {0.25, Length::Unit::mesh};
  walk.degrees = 5;
  return walk;
}

double angle_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return a.angularDistance(b) * 180 / pi;
}

TEST(RandomWalk, DependsOnTheSeedAlone) {
  RandomWalk walk = small_walk();
  const auto first = walk.generate(meshes, {});
  EXPECT_EQ(first.shape, std::vector<std::size_t>({2000, 5, 7}));
  EXPECT_EQ(walk.generate(meshes, {}).data, first.data);
  walk.seed = 2;
  EXPECT_NE(walk.generate(meshes, {}).data, first.data);
}

// Written down once: what another machine or compiler must give.
TEST(RandomWalk, IsTheSameEverywhere) {
  Random random(1);
  EXPECT_EQ(random.bits(), 12966619160104079557u);
  EXPECT_EQ(random.bits(), 9600361134598540522u);
}

TEST(RandomWalk, StepsHaveTheSizesAskedAndStayInside) {
  const RandomWalk walk = small_walk();
  const auto trace = walk.generate(meshes, {});
  std::size_t reflected = 0;
  for (std::size_t frame = 1; frame < walk.frames; ++frame)
    for (std::size_t object = 0; object < walk.objects; ++object) {
      const auto before = state_of(trace, frame - 1, object), now = state_of(trace, frame, object);
      EXPECT_LE(now.centre.cwiseAbs().maxCoeff(), 5 + 1e-12);
      EXPECT_NEAR(now.attitude.norm(), 1, 1e-14);
      EXPECT_NEAR(angle_between(before.attitude, now.attitude), 5, 1e-9);
      const double step = (now.centre - before.centre).norm();
      EXPECT_LE(step, 0.25 + 1e-12);
      if (step < 0.25 - 1e-12) ++reflected;
    }
  EXPECT_GT(reflected, 0u);
  EXPECT_LT(reflected, walk.frames * walk.objects / 5);
}

TEST(RandomWalk, LengthsInRadii) {
  RandomWalk walk = small_walk();
  walk.objects = 1;
  walk.side = {4, Length::Unit::body};  // of the largest body
  walk.step = {2, Length::Unit::leaf};  // of the smallest leaf
  const auto trace = walk.generate(meshes, {});
  double longest = 0, farthest = 0;
  for (std::size_t frame = 1; frame < walk.frames; ++frame) {
    const auto now = state_of(trace, frame, 0);
    longest = std::max(longest, (now.centre - state_of(trace, frame - 1, 0).centre).norm());
    farthest = std::max(farthest, now.centre.cwiseAbs().maxCoeff());
  }
  EXPECT_NEAR(longest, 0.2, 1e-12);
  EXPECT_LE(farthest, 2.5);
  EXPECT_GT(farthest, 2.4);
}

TEST(RandomWalk, OneFreedomChangesOneThing) {
  RandomWalk walk = small_walk();
  walk.freedoms = "one";
  const auto trace = walk.generate(meshes, {});
  std::set<int> seen;
  for (std::size_t frame = 1; frame < walk.frames; ++frame)
    for (std::size_t object = 0; object < walk.objects; ++object) {
      const auto before = state_of(trace, frame - 1, object), now = state_of(trace, frame, object);
      const Vec3<double> shift = now.centre - before.centre;
      const Eigen::Quaterniond turn = now.attitude * before.attitude.conjugate();
      int changed = 0;
      for (int d = 0; d < 3; ++d) {
        if (std::abs(shift[d]) > 1e-9) ++changed, seen.insert(shift[d] > 0 ? d : d + 3);
        if (std::abs(turn.vec()[d]) > 1e-9) {
          ++changed, seen.insert(6 + (turn.vec()[d] * turn.w() > 0 ? d : d + 3));
          EXPECT_NEAR(angle_between(before.attitude, now.attitude), 5, 1e-9);
        }
      }
      // A step along the wall's normal that starts half a step from it ends where it began.
      EXPECT_LE(changed, 1);
    }
  EXPECT_EQ(seen.size(), 12u);
}

TEST(RandomWalk, SoManyMove) {
  RandomWalk walk = small_walk();
  walk.moving = 2;
  const auto trace = walk.generate(meshes, {});
  std::vector<std::size_t> moves(walk.objects);
  for (std::size_t frame = 1; frame < walk.frames; ++frame) {
    int moved = 0;
    for (std::size_t object = 0; object < walk.objects; ++object)
      if (!std::equal(trace.data.begin() + static_cast<long>((frame * 5 + object) * 7),
                      trace.data.begin() + static_cast<long>((frame * 5 + object + 1) * 7),
                      trace.data.begin() + static_cast<long>(((frame - 1) * 5 + object) * 7)))
        ++moved, ++moves[object];
    EXPECT_EQ(moved, 2);
  }
  for (const std::size_t n : moves) EXPECT_NEAR(static_cast<double>(n), 2000 * 2 / 5.0, 120);
}

TEST(RandomWalk, PersistenceKeepsTheDirection) {
  RandomWalk walk = small_walk();
  walk.persistence = 1;
  walk.side = {100, Length::Unit::mesh};
  const auto trace = walk.generate(meshes, {});
  std::size_t same = 0;
  for (std::size_t frame = 2; frame < walk.frames; ++frame) {
    const Vec3<double> last =
        state_of(trace, frame - 1, 0).centre - state_of(trace, frame - 2, 0).centre;
    const Vec3<double> now =
        state_of(trace, frame, 0).centre - state_of(trace, frame - 1, 0).centre;
    if ((now - last).norm() < 1e-9)
      ++same;
    else
      EXPECT_NEAR(now.norm(), last.norm(), 0.25);
  }
  EXPECT_GT(same, walk.frames - 60);  // all but what the walls turn
  EXPECT_LT(same, walk.frames - 2);
}

TEST(RandomWalk, TeleportsAreAsOftenAsAsked) {
  RandomWalk walk = small_walk();
  walk.teleport = 0.1;
  const auto trace = walk.generate(meshes, {});
  int jumps = 0;
  for (std::size_t frame = 1; frame < walk.frames; ++frame)
    for (std::size_t object = 0; object < walk.objects; ++object)
      if ((state_of(trace, frame, object).centre - state_of(trace, frame - 1, object).centre)
              .norm() > 0.6)
        ++jumps;
  EXPECT_NEAR(jumps, 200, 50);
}

/// Balls about the centres stand for the surfaces.
bool balls_touch(std::size_t object, std::span<const Pose> poses) {
  for (std::size_t other = 0; other < poses.size(); ++other)
    if (other != object &&
        (poses[object](meshes[object % 2].centre) - poses[other](meshes[other % 2].centre))
                .norm() <= 2)
      return true;
  return false;
}

TEST(RandomWalk, RejectionLeavesNothingTouching) {
  RandomWalk walk = small_walk();
  walk.contact = "reject";
  walk.side = {5, Length::Unit::mesh};
  walk.teleport = 0.05;
  std::size_t asked = 0, refused = 0;
  const auto trace = walk.generate(meshes, [&](std::size_t object, std::span<const Pose> poses) {
    ++asked;
    const bool touches = balls_touch(object, poses);
    if (touches) ++refused;
    return touches;
  });
  EXPECT_GT(asked, walk.frames * walk.objects - 10);
  EXPECT_GT(refused, 100u);
  for (std::size_t frame = 0; frame < walk.frames; ++frame)
    for (std::size_t i = 0; i < walk.objects; ++i)
      for (std::size_t j = 0; j < i; ++j)
        ASSERT_GT((state_of(trace, frame, i).centre - state_of(trace, frame, j).centre).norm(),
                  2 - 1e-12);
}

TEST(RandomWalk, NothingToDoIsLegal) {
  RandomWalk walk = small_walk();
  walk.frames = 0;
  EXPECT_TRUE(walk.generate(meshes, {}).data.empty());
  walk.frames = 3, walk.objects = 0;
  walk.teleport = 1;
  EXPECT_EQ(walk.generate(meshes, {}).shape, std::vector<std::size_t>({3, 0, 7}));
  walk.objects = 1, walk.side = {0, Length::Unit::mesh}, walk.step = {0, Length::Unit::mesh};
  EXPECT_EQ(walk.generate(meshes, {}).data.size(), 21u);
}

std::string refusal(const RandomWalk& walk) {
  try {
    walk.generate(meshes, balls_touch);
    return "";
  } catch (const Unusable& error) {
    return error.what();
  }
}

TEST(RandomWalk, FaultsAreNamed) {
  const auto with = [](auto&& change) {
    RandomWalk walk = small_walk();
    change(walk);
    return refusal(walk);
  };
  EXPECT_EQ(with([](auto&) {}), "");
  EXPECT_EQ(with([](auto& w) { w.freedoms = "two"; }), "freedoms 'two'; available: one, all");
  EXPECT_EQ(with([](auto& w) { w.contact = "x"; }), "contact 'x'; available: pass, reject");
  EXPECT_EQ(with([](auto& w) { w.moving = 6; }), "moving: 6 of 5 bodies");
  EXPECT_EQ(with([](auto& w) { w.degrees = std::nan(""); }), "degrees: must be 0 to 180");
  EXPECT_EQ(with([](auto& w) { w.persistence = 1.5; }), "persistence: must be 0 to 1");
  EXPECT_EQ(with([](auto& w) { w.teleport = -1; }), "teleport: must be 0 to 1");
  EXPECT_EQ(with([](auto& w) { w.frames = std::size_t{1} << 60; }),
            "frames, objects: more than 2^32 poses");
  EXPECT_NE(with([](auto& w) { w.step.value = 11; }).find("step: longer than"), std::string::npos);
  EXPECT_EQ(with([](auto& w) { w.contact = "reject", w.side.value = 1; }),
            "side: no room for body 1 to start without touching another, in 1000 tries");
}

TEST(Length, IsReadAsWritten) {
  EXPECT_EQ(length_from("0.25"), (Length{0.25, Length::Unit::mesh}));
  EXPECT_EQ(length_from("1leaf"), (Length{1, Length::Unit::leaf}));
  EXPECT_EQ(length_from("4.5 body"), (Length{4.5, Length::Unit::body}));
  EXPECT_EQ(text_of(length_from("4.5 body")), "4.5body");
  for (const char* text : {"", "leaf", "-1", "nan", "inf", "1e999", "1 yard", "1 leaf x"})
    EXPECT_THROW(length_from(text), Unusable) << text;
}

TEST(Extent, SmallestLeafAndMiddle) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {4, 0, 0}, {0, 3, 0}, {4, 3, 0}, {1e3, 1e3, 1e3}};  // the last unused
  mesh.triangles = {{0, 1, 2}, {1, 1, 1}};
  EXPECT_EQ(extent_of(mesh).leaf_radius, 2.5);
  EXPECT_EQ(extent_of(mesh).centre, Vec3<double>(2, 1.5, 0));
  EXPECT_EQ(extent_of(mesh).radius, 2.5);
  mesh.triangles = {{1, 1, 1}};
  EXPECT_EQ(extent_of(mesh).leaf_radius, 0);
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_NEAR(extent_of(mesh).leaf_radius, 1 / std::sqrt(3.0), 1e-15);
}

}  // namespace
}  // namespace bvlab
