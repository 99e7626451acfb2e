// SPDX-License-Identifier: BSD-3-Clause
/// A scene divided or multiplied by a power of two, from the least numbers to the largest, has the
/// same answers: whatever volumes and margins over float make of it, every strategy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "hierarchies/builds.hpp"
#include "hierarchies/volumes.hpp"
#include "tests/types_of.hpp"
#include "traversal/bodies.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies.hpp"

namespace bvlab {
namespace {

struct Answers {
  std::vector<bool> touching;
  std::vector<std::vector<Contact>> contacts;
  std::vector<double> distances;
};

TriangleMesh scaled(TriangleMesh mesh, int exponent) {
  // On a grid, so that nothing is lost where numbers are few.
  for (auto& v : mesh.vertices)
    v = v.unaryExpr([&](double x) { return std::ldexp(std::nearbyint(64 * x), exponent); });
  return mesh;
}

template <class Strategy>
class Scales : public testing::Test {
 protected:
  template <class V>
  static Answers play(const TriangleMesh& of_usual_size, int exponent) {
    using B = Batch<typename V::scalar, 8>;
    const TriangleMesh mesh = scaled(of_usual_size, exponent);
    const Hierarchy<V> hierarchy(mesh, builds::TopDownPrincipal::topology(mesh, 2));
    Body<V> a(mesh, hierarchy), b(mesh, hierarchy);
    Workspace workspace;
    NotCounting counter;
    Strategy touching_strategy, contacts_strategy, distance_strategy;
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(-1, 1);
    Answers answers;
    Vec3<double> place(110, 35, -20);
    for (int frame = 0; frame < 100; ++frame) {
      // Nearer, into each other, out again, slowly and fast, with rests and jumps.
      const double step = frame < 50 ? 4 : 10;
      if (frame % 7 != 0) {
        // Drawn one after the other: compilers evaluate arguments in different orders.
        const double z = unit(random), y = unit(random);
        place += step * Vec3<double>(frame % 20 < 10 ? -1.5 : 1.5, y, z);
      }
      if (frame > 75 && frame % 10 == 0) place = Vec3<double>(80 * unit(random), 30, -10);
      Pose pose;  // turned by a right angle about two axes: exact, too
      pose.rotation << 0, -1, 0, 0, 0, -1, 1, 0, 0;
      pose.translation =
          place.unaryExpr([&](double x) { return std::ldexp(std::nearbyint(x), exponent); });
      a.move(Pose{}, Vec3<double>::Zero());
      b.move(pose, Vec3<double>::Zero());
      Touching touching;
      touching_strategy.run(
          BodyPair<B, V, decltype(touching), NotCounting>(a, b, touching, counter, workspace));
      answers.touching.push_back(touching.touching());
      Contacts contacts(answers.contacts.emplace_back());
      contacts_strategy.run(
          BodyPair<B, V, decltype(contacts), NotCounting>(a, b, contacts, counter, workspace));
      std::sort(answers.contacts.back().begin(), answers.contacts.back().end());
      Distance distance;
      distance_strategy.run(
          BodyPair<B, V, decltype(distance), NotCounting>(a, b, distance, counter, workspace));
      answers.distances.push_back(distance.distance());
    }
    return answers;
  }

  static void expect_scaled(const Answers& found, const Answers& usual, int exponent) {
    EXPECT_EQ(found.touching, usual.touching) << exponent;
    EXPECT_EQ(found.contacts, usual.contacts) << exponent;
    for (std::size_t frame = 0; frame < usual.distances.size(); ++frame) {
      const double expected = usual.distances[frame];
      const double distance =
          std::ldexp(std::ldexp(found.distances[frame], -exponent / 2), exponent / 2 - exponent);
      // The unit in which distances are told where numbers are few.
      const double grain = exponent < -1000 ? std::ldexp(1, -1074 - exponent) : 0;
      ASSERT_EQ(distance == 0, expected == 0) << exponent << ' ' << frame;
      ASSERT_NEAR(distance, expected, 0x1p-44 * expected + grain) << exponent << ' ' << frame;
    }
  }
};
TYPED_TEST_SUITE(Scales, TypesOf<Strategies>);

TYPED_TEST(Scales, ChangeNoAnswer) {
  // A triangle alone, too: no other pair of triangles keeps its margin from being believed.
  TriangleMesh triangle;
  triangle.vertices = {{0, 0, 0}, {1, 0, 0.5}, {0, 1, 0.25}};
  triangle.triangles = {{0, 1, 2}};
  TriangleMesh crown;  // two pyramids on three corners, dented
  crown.vertices = {
      {1, 0, 0}, {-0.5, 0.75, 0.25}, {-0.5, -0.75, -0.25}, {0, 0, 1}, {0.25, 0, 0.25}};
  crown.triangles = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}};
  for (const TriangleMesh& mesh : {crown, triangle}) {
    const Answers usual = this->template play<Sphere<float>>(mesh, 0);
    const auto hits = std::count(usual.touching.begin(), usual.touching.end(), true);
    EXPECT_GT(hits, 5);
    EXPECT_LT(hits, 90);
    for (const int exponent : {-1074, -1000, -300, -150, -70, 60, 119, 127, 300, 1010}) {
      this->expect_scaled(this->template play<Sphere<float>>(mesh, exponent), usual, exponent);
      this->expect_scaled(this->template play<Sphere<double>>(mesh, exponent), usual, exponent);
    }
  }
}

/// Scalar minima and maxima pass a number where the other one is NaN.
TEST(Spheres, HaveNoGapWhereTheirCentresAreNotFinite) {
  for (const float far :
       {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
        std::numeric_limits<float>::quiet_NaN()}) {
    Sphere<float> sphere;
    sphere.centre = Vec3<float>(far, 0, 0), sphere.radius = 1;
    EXPECT_FALSE(disjoint(sphere, sphere)) << far;
    EXPECT_EQ(gap(sphere, sphere), 0) << far;
  }
}

}  // namespace
}  // namespace bvlab
