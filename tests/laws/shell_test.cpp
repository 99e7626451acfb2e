// SPDX-License-Identifier: BSD-3-Clause
/// The formulas of the spherical shell, against points of random shells.
#include "hierarchies/volumes/shell.hpp"

#include <gtest/gtest.h>

#include <random>

namespace bvlab {
namespace {

class Shells : public ::testing::Test {
 protected:
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Vec3<double> direction() {
    std::normal_distribution<double> normal;
    return Vec3<double>(normal(random_), normal(random_), normal(random_)).normalized();
  }
  Shell<double> shell() {
    Shell<double> s;
    s.centre = Vec3<double>(uniform(-2, 2), uniform(-2, 2), uniform(-2, 2));
    s.axis = direction();
    s.outer = uniform(0.1, 2);
    s.inner = s.outer * uniform(0, 1);
    s.cosine = uniform(0, 1) < 0.1 ? Shell<double>::all_around : uniform(0.02, 0.999);
    return s;
  }
  /// Any point of the shell; often on its edges, where distances are attained.
  Vec3<double> point_of(const Shell<double>& s) {
    const double least = s.cosine < 0 ? -1 : s.cosine;
    const double cosine = uniform(0, 1) < 0.4 ? least : uniform(least, 1);
    const double radius = uniform(0, 1) < 0.4   ? s.inner
                          : uniform(0, 1) < 0.7 ? s.outer
                                                : uniform(s.inner, s.outer);
    const Vec3<double> across = s.axis.cross(direction()).normalized();
    return s.centre + radius * (cosine * s.axis + std::sqrt(1 - cosine * cosine) * across);
  }

  std::mt19937_64 random_{1};
};

TEST_F(Shells, TheDistanceFromAPointIsNeverMoreThanThatOfAnySampleAndCloseToTheLeast) {
  for (int round = 0; round < 3000; ++round) {
    const Shell<double> s = shell();
    Shell<double> point;
    point.centre = Vec3<double>(uniform(-4, 4), uniform(-4, 4), uniform(-4, 4));
    point.axis = direction();
    point.inner = point.outer = 0;
    point.cosine = Shell<double>::all_around;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3000; ++i) least = std::min(least, (point_of(s) - point.centre).norm());
    const double g = gap(s, point);
    ASSERT_LE(g, least) << "round " << round;
    // So many samples come this near to the nearest point of the surface; inside they are sparser.
    if (contains(s, Vec3<long double>(point.centre.cast<long double>())))
      ASSERT_EQ(g, 0) << "round " << round;
    else
      ASSERT_GE(g, least - 0.1 * s.outer) << "round " << round;
  }
}

TEST_F(Shells, TheGapIsNeverMoreThanTheDistanceOfAnySamples) {
  int apart = 0, close = 0;
  for (int round = 0; round < 20000; ++round) {
    const Shell<double> a = shell(), b = shell();
    const double g = gap(a, b);
    EXPECT_EQ(disjoint(a, b), g > 0);
    EXPECT_EQ(gap(b, a) > 0, g > 0);
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 200; ++i) least = std::min(least, (point_of(a) - point_of(b)).norm());
    ASSERT_LE(g, least) << "round " << round;
    apart += g > 0;
    close += g > 0 && least < 2 * g;
  }
  EXPECT_GT(apart, 5000);
  EXPECT_GT(close, 2000);
}

TEST_F(Shells, AHollowShellDoesNotTouchWhatIsInside) {
  Shell<double> hollow{Vec3<double>::Zero(), Vec3<double>::UnitX(), 1, 1.1,
                       Shell<double>::all_around};
  Shell<double> ball{Vec3<double>(0.3, 0, 0), Vec3<double>::UnitX(), 0, 0.5,
                     Shell<double>::all_around};
  EXPECT_TRUE(disjoint(hollow, ball));
  EXPECT_NEAR(gap(hollow, ball), 0.2, 1e-12);
  ball.outer = 0.71;
  EXPECT_FALSE(disjoint(hollow, ball));
}

/// A triangle dips below its corners: its nearest point may lie inside, on an edge or be a corner.
TEST_F(Shells, TrianglesLieWhereTheyAreFittedToBe) {
  for (int round = 0; round < 3000; ++round) {
    std::vector<Vec3<double>> corners;
    std::vector<Triangle> triangles;
    for (int i = 0; i < 1 + round % 4; ++i) {
      triangles.push_back({direction(), direction(), direction()});
      if (round % 5 == 0) triangles.back()[2] = triangles.back()[1];
      for (const auto& c : triangles.back()) corners.push_back(c);
    }
    const Shell<float> s = posed(round % 2 ? Shell<float>::tight(corners, triangles)
                                           : Shell<float>::enclosing(corners, triangles),
                                 Placement<float>());
    for (const auto& [p, q, r] : triangles)
      for (int i = 0; i < 50; ++i) {
        double u = uniform(0, 1), v = uniform(0, 1);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        const Vec3<double> x = p + u * (q - p) + v * (r - p);
        ASSERT_TRUE(contains(s, Vec3<long double>(x.cast<long double>()))) << "round " << round;
      }
  }
}

}  // namespace
}  // namespace bvlab
