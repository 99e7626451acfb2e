// SPDX-License-Identifier: BSD-3-Clause
/// Public scenes: small files of the same forms, and what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/public/public_scenes.hpp"
#include "experiments/scenes/public/sha256.hpp"

namespace bvlab {
namespace {

const std::string tetrahedron =
    "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
const std::string box_far_away = "OFF\n4 2 0\n-9 -9 -9\n9 -9 -9\n9 9 9\n-9 9 9\n3 0 1 2\n3 0 2 3\n";

MotionRequest frames(std::size_t count) {
  return {count, [](std::span<const TriangleMesh>) {
            return [](std::size_t, std::span<const Pose>) { return false; };
          }};
}

std::string what_is_refused(const auto& act) {
  try {
    act();
  } catch (const Unusable& fault) {
    return fault.what();
  }
  return "";
}

TEST(Public, Sha256OfThePublishedExamples) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

TEST(Public, APathOfOmplIsInterpolatedInEqualSteps) {
  const PublicFiles files({{"robot.off", tetrahedron},
                           {"world.off", box_far_away},
                           {"a.path", "0 0 0 0 0 0 1\n3 0 0 0 0 0 1\n4 0 0 0 0 1 0\n"}});
  const auto straight = PublicFiles({{"robot.off", tetrahedron},
                                     {"world.off", box_far_away},
                                     {"a.path", "0 0 0 0 0 0 1\n3 0 0 0 0 0 1\n4 0 0 0 0 0 1\n"}});
  const auto motion = ompl_path(straight, "robot.off", "world.off", "a.path", frames(5));
  ASSERT_EQ(motion.trace.shape, (std::vector<std::size_t>{5, 2, 7}));
  for (std::size_t frame = 0; frame < 5; ++frame) {
    EXPECT_NEAR(motion.trace.data[14 * frame], static_cast<double>(frame), 1e-12);
    EXPECT_EQ(motion.trace.data[14 * frame + 7], 0);  // the environment stands
    EXPECT_EQ(motion.trace.data[14 * frame + 10], 1);
  }
  // The last state: turned by half a turn about z, w last in the file and first in a trace.
  const auto turned = ompl_path(files, "robot.off", "world.off", "a.path", frames(9)).trace.data;
  EXPECT_NEAR(turned[14 * 8], 4, 1e-12);
  EXPECT_NEAR(turned[14 * 8 + 3], 0, 1e-12);
  EXPECT_NEAR(std::abs(turned[14 * 8 + 6]), 1, 1e-12);
  // The robot stands about the mean of its vertices.
  Vec3<double> sum = Vec3<double>::Zero();
  for (const auto& vertex : motion.meshes[0].mesh.vertices) sum += vertex;
  EXPECT_LT(sum.norm(), 1e-5);
}

TEST(Public, ASearchBeginsAtTheStart) {
  const PublicFiles files(
      {{"robot.off", tetrahedron},
       {"world.off", box_far_away},
       {"a.cfg",
        "[problem]\nname = a\nstart.x = 1\nstart.y = 2\nstart.z = 3\nstart.theta = 0\n"
        "start.axis.x = 1\nstart.axis.y = 0\nstart.axis.z = 0\ngoal.x = 5\ngoal.y = 2\n"
        "goal.z = 3\ngoal.theta = 1\ngoal.axis.x = 1\ngoal.axis.y = 0\ngoal.axis.z = 0\n"
        "volume.min.x = -9\nvolume.min.y = -9\nvolume.min.z = -9\nvolume.max.x = 9\n"
        "volume.max.y = 9\nvolume.max.z = 9\n"}});
  const auto motion = ompl_search(files, "robot.off", "world.off", "a.cfg", frames(40));
  ASSERT_EQ(motion.trace.data.size(), 40u * 14);
  EXPECT_LT(
      std::hypot(motion.trace.data[0] - 1, motion.trace.data[1] - 2, motion.trace.data[2] - 3),
      0.2);
  const PublicFiles none({{"robot.off", tetrahedron}, {"world.off", box_far_away}, {"a.cfg", ""}});
  EXPECT_EQ(
      what_is_refused([&] { ompl_search(none, "robot.off", "world.off", "a.cfg", frames(1)); }),
      "a.cfg: has no volume.min.x");
}

TEST(Public, PathsOfPqpAreMatrices) {
  const std::string soup = "1\n0 0 0\n1 0 0\n0 1 0\n";
  const PublicFiles files(
      {{"a.tris", soup},
       {"b.tris", soup},
       {"a.path", "2\n1 0 0\n0 1 0\n0 0 1\n0 0 0\n\n0 -1 0\n1 0 0\n0 0 1\n1 2 3\n"},
       {"b.path", "2\n1 0 0 0 1 0 0 0 1 5 0 0\n1 0 0 0 1 0 0 0 1 6 0 0\n"}});
  const auto motion = pqp_paths(files, "a", "b", frames(2));
  EXPECT_EQ(motion.meshes[0].mesh.triangles.size(), 1u);
  const double* last = motion.trace.data.data() + 14;
  EXPECT_EQ(last[1], 2);
  EXPECT_NEAR(last[3], std::sqrt(0.5), 1e-12);  // a quarter turn about z
  EXPECT_NEAR(last[6], std::sqrt(0.5), 1e-12);
  EXPECT_EQ(last[7], 6);
  EXPECT_EQ(what_is_refused([&] { pqp_paths(files, "a", "b", frames(3)); }),
            "a.path: has 2 frames, not 3");
  const PublicFiles short_file({{"a.tris", "9\n0 0 0\n"}, {"a.path", "1\n"}});
  EXPECT_NE(what_is_refused([&] { pqp_paths(short_file, "a", "a", frames(1)); }), "");
}

std::string log_of(const std::vector<std::vector<float>>& angles) {
  std::string text =
      "stepCount,...\nIfi" + std::string(13, 'f') + "I" + std::string(angles[0].size(), 'f') + "\n";
  for (const auto& frame : angles) {
    std::vector<float> numbers{0, 0, 0, 1, 2, 3, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0};
    numbers.insert(numbers.end(), frame.begin(), frame.end());
    text += "\xaa\xbb";
    text.append(reinterpret_cast<const char*>(numbers.data()), 4 * numbers.size());
  }
  return text;
}

TEST(Public, AnArmIsAChain) {
  const std::string urdf =
      "<robot><joint name=\"a\" type=\"revolute\"><origin rpy=\"0 0 0\" xyz=\"0 0 1\"/>"
      "<axis xyz=\"0 0 1\"/></joint><joint name=\"b\" type=\"revolute\">"
      "<origin rpy=\"1.5707963267948966 0 0\" xyz=\"2 0 0\"/><axis xyz=\"0 0 1\"/></joint></robot>";
  const float quarter = 1.57079637f;
  const PublicFiles files({{"arm.urdf", urdf},
                           {"log", log_of({{0, 0}, {quarter, 0}})},
                           {"0.off", tetrahedron},
                           {"1.off", tetrahedron},
                           {"2.off", tetrahedron}});
  const auto motion = arm(files, "arm.urdf", "log", {"0.off", "1.off", "2.off"}, frames(2));
  ASSERT_EQ(motion.trace.shape, (std::vector<std::size_t>{2, 3, 7}));
  const auto at = [&](std::size_t frame, std::size_t link, std::size_t k) {
    return motion.trace.data[(frame * 3 + link) * 7 + k];
  };
  for (std::size_t frame = 0; frame < 2; ++frame) {
    EXPECT_EQ(at(frame, 0, 0), 1);
    EXPECT_NEAR(at(frame, 1, 2), 4, 1e-6);
  }
  EXPECT_NEAR(at(0, 2, 0), 3, 1e-6);  // before the turn along x,
  EXPECT_NEAR(at(1, 2, 0), 1, 1e-6);  // after it along y
  EXPECT_NEAR(at(1, 2, 1), 4, 1e-6);
  EXPECT_EQ(what_is_refused([&] { arm(files, "arm.urdf", "log", {"0.off"}, frames(3)); }),
            "log: has 2 frames, not 3");
}

TEST(Public, EdgesAreSweptFromFrameToFrame) {
  const PublicFiles files({{"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
                           {"b.off", "OFF\n3 1 0\n0 0 2\n1 0 2\n0 1 2\n3 0 1 2\n"}});
  const auto boxes = swept_edges(files, "a.off", "b.off", 2);
  ASSERT_EQ(boxes.shape, (std::vector<std::size_t>{2, 3, 6}));
  // The edge from 0 to 1, in each half of the step.
  EXPECT_EQ((std::vector<float>(boxes.data.begin(), boxes.data.begin() + 6)),
            (std::vector<float>{0, 0, 0, 1, 0, 1}));
  EXPECT_EQ((std::vector<float>(boxes.data.begin() + 18, boxes.data.begin() + 24)),
            (std::vector<float>{0, 0, 1, 1, 0, 2}));
}

TEST(Public, WhatIsAbsentOrAnotherFileIsRefusedInALine) {
  const auto folder = std::filesystem::temp_directory_path() / "bvlab-public-test";
  std::filesystem::create_directories(folder / "test/fcl_resources");
  const auto refused = [&] {
    return what_is_refused([&] { public_motion("public:env-rob", folder.string(), frames(1)); });
  };
  std::filesystem::remove(folder / "test/fcl_resources/rob.obj");
  EXPECT_NE(refused().find("has no test/fcl_resources/rob.obj of github.com/"), std::string::npos);
  std::ofstream(folder / "test/fcl_resources/rob.obj") << "v 0 0 0\n";
  EXPECT_NE(refused().find("its SHA-256 is another"), std::string::npos);
  EXPECT_NE(what_is_refused([] {
              require_public_scene("public:nothing");
            }).find("no scene 'public:nothing'; available: public:alpha-1.1"),
            std::string::npos);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace bvlab
